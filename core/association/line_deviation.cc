#include "core/association/line_deviation.h"

#include <Eigen/LU>
#include <optional>

#include "core/surface/landmark_view.h"
#include "factors/segment/segment_measurement.h"

namespace plumbline {

namespace {

// An observation placed beside a surface.
struct PlacedLine {
  Eigen::Vector3d centroid_world;
  Eigen::Vector3d tangent_world;
  double level2;  // the share of the tangent that is level, squared

  PlacedLine(const Observation& observation, const ObservationPoses& poses) {
    const ScanPlacement& placement = poses.motion.nodes()[1];
    centroid_world = placement * observation.centroid().homogeneous();
    tangent_world = placement.leftCols<2>() * observation.tangent();
    level2 = tangent_world.head<2>().squaredNorm();
  }
};

// Calls visit(design, residual) for the observation's whitened residuals from a surface, which
// is this plane near the observation. design: the derivatives of the residual by an offset, a
// slope and a curvature (1/m, along the segment) that the line deviates by, the first two at
// the centroid: these add the same to g at every node. The last residual is the bow's rest.
template <typename Visit>
void VisitResiduals(const Observation& observation,
                    const ObservationPoses& poses,
                    const LandmarkView& plane,
                    const SegmentWeights& weights,
                    double bow,
                    const Visit& visit) {
  const auto rows = observation.measurement.rows();
  const Eigen::Matrix3d to_segment = observation.measurement.frame().Matrix().transpose();
  Eigen::Matrix<double, 9, 1> g;
  for (int k = 0; k < 3; ++k) {
    Eigen::Vector3d at_node =
        poses.motion.nodes()[static_cast<size_t>(k)].transpose() * plane.normal;
    at_node.z() -= plane.distance;
    g.segment<3>(3 * k) = to_segment * at_node;
  }
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    const Eigen::Matrix<double, 1, SegmentMeasurement::kColumns> row =
        rows.row(i).cast<double>();
    const Eigen::Vector3d design =
        weights.scale *
        Eigen::Vector3d(row[2] + row[5] + row[8], row[0] + row[3] + row[6], row[10]);
    visit(design,
          weights.scale * row.head<9>().dot(g) + bow * design.z() +
              weights.offset * (row[9] - poses.range_excess_m * row[11]));
  }
  const double rest = weights.scale * observation.measurement.bend_rest();
  visit(Eigen::Vector3d(0.0, 0.0, rest),
        bow * rest + weights.offset * observation.measurement.bend_offset());
}

}  // namespace

LineDeviation DeviationFromPlane(const Observation& observation,
                                 const ObservationPoses& poses,
                                 const LandmarkView& surface) {
  const PlacedLine line(observation, poses);
  std::optional<LandmarkView> near;
  const LandmarkView& plane = surface.Near(line.centroid_world, &near);
  const SegmentWeights weights =
      WeightsOn(observation, poses.world_from_scanner.rotation, plane.normal);
  // What of the constant is the bow's rest, for a surface that does not bend.
  const double rest_offset = weights.offset * observation.measurement.bend_offset();
  LineDeviation deviation;
  deviation.chi2 = weights.offset * weights.offset * observation.measurement.constant() -
                   rest_offset * rest_offset;
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right_side = Eigen::Vector2d::Zero();
  VisitResiduals(observation,
                 poses,
                 plane,
                 weights,
                 surface.curvature * line.level2,
                 [&](const Eigen::Vector3d& design, double residual) {
                   information += design.head<2>() * design.head<2>().transpose();
                   right_side += residual * design.head<2>();
                   deviation.chi2 += residual * residual;
                 });
  deviation.covariance = information.inverse();
  deviation.value = deviation.covariance * right_side;

  const Eigen::Vector3d arm = line.centroid_world - poses.world_from_body.translation;
  const Eigen::Vector3d& normal = plane.normal;
  deviation.by_pose.row(0) << arm.cross(normal).transpose(), normal.transpose();
  deviation.by_pose.row(1) << line.tangent_world.cross(normal).transpose(), 0.0, 0.0, 0.0;
  // Moved along an arc, the line meets another normal.
  Eigen::Vector3d turn = surface.curvature * line.tangent_world;
  turn.z() = 0.0;
  deviation.by_pose.row(1) +=
      (Eigen::Matrix<double, 6, 1>() << arm.cross(turn), turn).finished().transpose();
  deviation.by_plane = plane.DeviationJacobian(line.centroid_world, line.tangent_world);
  return deviation;
}

BowedDeviation BowedDeviationFrom(const Observation& observation,
                                  const ObservationPoses& poses,
                                  const LandmarkView& surface) {
  const PlacedLine line(observation, poses);
  std::optional<LandmarkView> near;
  const LandmarkView& plane = surface.Near(line.centroid_world, &near);
  BowedDeviation deviation;
  VisitResiduals(observation,
                 poses,
                 plane,
                 WeightsOn(observation, poses.world_from_scanner.rotation, plane.normal),
                 surface.curvature * line.level2,
                 [&](const Eigen::Vector3d& design, double residual) {
                   deviation.information += design * design.transpose();
                   deviation.right_side += residual * design;
                 });
  deviation.by_surface.topRows<2>() =
      plane.DeviationJacobian(line.centroid_world, line.tangent_world);
  deviation.by_surface.row(2) << 0.0, line.level2, 0.0;
  return deviation;
}

}  // namespace plumbline
