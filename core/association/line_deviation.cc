#include "core/association/line_deviation.h"

#include <Eigen/LU>

#include "core/map/landmark_view.h"
#include "factors/segment/segment_measurement.h"

namespace plumbline {

LineDeviation DeviationFromPlane(const Observation& observation,
                                 const ObservationPoses& poses,
                                 const LandmarkView& plane) {
  const auto rows = observation.measurement.rows();
  const Eigen::Matrix3d to_segment = observation.measurement.frame().Matrix().transpose();
  Eigen::Matrix<double, 9, 1> g;
  for (int k = 0; k < 3; ++k) {
    Eigen::Vector3d at_node =
        poses.motion.nodes()[static_cast<size_t>(k)].transpose() * plane.normal;
    at_node.z() -= plane.distance;
    g.segment<3>(3 * k) = to_segment * at_node;
  }
  const SegmentWeights weights =
      WeightsOn(observation, poses.world_from_scanner.rotation, plane.normal);
  LineDeviation deviation;
  deviation.chi2 = weights.offset * weights.offset * observation.measurement.constant();
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right_side = Eigen::Vector2d::Zero();
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    const Eigen::Matrix<double, 1, 10> row = rows.row(i).cast<double>();
    const double residual = weights.scale * row.head<9>().dot(g) + weights.offset * row[9];
    // A line that deviates by an offset and a slope, both at the centroid, adds them to g, the
    // same at every node.
    const Eigen::Vector2d design(weights.scale * (row[2] + row[5] + row[8]),
                                 weights.scale * (row[0] + row[3] + row[6]));
    information += design * design.transpose();
    right_side += residual * design;
    deviation.chi2 += residual * residual;
  }
  deviation.covariance = information.inverse();
  deviation.value = deviation.covariance * right_side;

  const ScanPlacement& placement = poses.motion.nodes()[1];
  const Eigen::Vector3d centroid_world = placement * observation.centroid().homogeneous();
  const Eigen::Vector3d tangent_world = placement.leftCols<2>() * observation.tangent();
  const Eigen::Vector3d arm = centroid_world - poses.world_from_body.translation;
  const Eigen::Vector3d& normal = plane.normal;
  deviation.by_pose.row(0) << arm.cross(normal).transpose(), normal.transpose();
  deviation.by_pose.row(1) << tangent_world.cross(normal).transpose(), 0.0, 0.0, 0.0;
  deviation.by_plane = plane.DeviationJacobian(centroid_world, tangent_world);
  return deviation;
}

}  // namespace plumbline
