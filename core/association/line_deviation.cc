#include "core/association/line_deviation.h"

#include <Eigen/LU>
#include <optional>

#include "core/map/landmark_view.h"
#include "factors/segment/segment_measurement.h"

namespace plumbline {

LineDeviation DeviationFromPlane(const Observation& observation,
                                 const ObservationPoses& poses,
                                 const LandmarkView& surface) {
  const ScanPlacement& placement = poses.motion.nodes()[1];
  const Eigen::Vector3d centroid_world = placement * observation.centroid().homogeneous();
  const Eigen::Vector3d tangent_world = placement.leftCols<2>() * observation.tangent();
  std::optional<LandmarkView> near;
  const LandmarkView& plane =
      surface.is_curved ? near.emplace(surface.Near(centroid_world)) : surface;
  const double bow = surface.curvature * tangent_world.head<2>().squaredNorm();
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
    const Eigen::Matrix<double, 1, SegmentMeasurement::kColumns> row =
        rows.row(i).cast<double>();
    const double residual =
        weights.scale * (row.head<9>().dot(g) + bow * row[10]) + weights.offset * row[9];
    // A line that deviates by an offset and a slope, both at the centroid, adds them to g, the
    // same at every node.
    const Eigen::Vector2d design(weights.scale * (row[2] + row[5] + row[8]),
                                 weights.scale * (row[0] + row[3] + row[6]));
    information += design * design.transpose();
    right_side += residual * design;
    deviation.chi2 += residual * residual;
  }
  const double of_rest = weights.scale * bow * observation.measurement.bend_rest();
  const double offset_of_rest = weights.offset * observation.measurement.bend_offset();
  deviation.chi2 += of_rest * (of_rest + 2.0 * offset_of_rest);
  deviation.covariance = information.inverse();
  deviation.value = deviation.covariance * right_side;

  const Eigen::Vector3d arm = centroid_world - poses.world_from_body.translation;
  const Eigen::Vector3d& normal = plane.normal;
  deviation.by_pose.row(0) << arm.cross(normal).transpose(), normal.transpose();
  deviation.by_pose.row(1) << tangent_world.cross(normal).transpose(), 0.0, 0.0, 0.0;
  if (surface.is_curved) {
    // Moved along the arc, the line meets another normal.
    Eigen::Vector3d turn = surface.curvature * tangent_world;
    turn.z() = 0.0;
    deviation.by_pose.row(1) +=
        (Eigen::Matrix<double, 6, 1>() << arm.cross(turn), turn).finished().transpose();
  }
  deviation.by_plane = plane.DeviationJacobian(centroid_world, tangent_world);
  return deviation;
}

BowedDeviation BowedDeviationFrom(const Observation& observation,
                                  const ObservationPoses& poses,
                                  const LandmarkView& surface) {
  const ScanPlacement& placement = poses.motion.nodes()[1];
  const Eigen::Vector3d centroid_world = placement * observation.centroid().homogeneous();
  const Eigen::Vector3d tangent_world = placement.leftCols<2>() * observation.tangent();
  std::optional<LandmarkView> near;
  const LandmarkView& plane =
      surface.is_curved ? near.emplace(surface.Near(centroid_world)) : surface;
  const double level2 = tangent_world.head<2>().squaredNorm();
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
  BowedDeviation deviation;
  const auto add = [&](const Eigen::Vector3d& design, double residual) {
    deviation.information += design * design.transpose();
    deviation.right_side += residual * design;
  };
  const double bow = surface.curvature * level2;
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    const Eigen::Matrix<double, 1, SegmentMeasurement::kColumns> row =
        rows.row(i).cast<double>();
    add(weights.scale *
            Eigen::Vector3d(row[2] + row[5] + row[8], row[0] + row[3] + row[6], row[10]),
        weights.scale * (row.head<9>().dot(g) + bow * row[10]) + weights.offset * row[9]);
  }
  const double rest = weights.scale * observation.measurement.bend_rest();
  add({0.0, 0.0, rest}, bow * rest + weights.offset * observation.measurement.bend_offset());
  deviation.by_surface.topRows<2>() = plane.DeviationJacobian(centroid_world, tangent_world);
  deviation.by_surface.row(2) << 0.0, level2, 0.0;
  return deviation;
}

}  // namespace plumbline
