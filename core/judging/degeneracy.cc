#include "core/judging/degeneracy.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include "core/association/surface_levels.h"
#include "core/geometry/matrix_types.h"
#include "core/geometry/unknown_pose.h"
#include "core/judging/sightings.h"
#include "core/judging/verdict_levels.h"
#include "core/surface/landmark_view.h"

namespace plumbline {
namespace {

// A second that determines a direction worse than this leaves it to the motion prior and to
// what is before and after it: far above what a scan of walls all around gives.
constexpr double kDegenerate = 0.02;  // m
constexpr double kSteep = 0.7;        // |z| of a direction that counts as vertical

// The length of the plane's normal in the scan plane. Along a plane that hardly cuts the scan
// plane the segment's own line says little.
double Cut(const ScanPlacement& placement, const LandmarkView& plane) {
  const Eigen::Vector2d in_plane = placement.leftCols<2>().transpose() * plane.normal;
  return std::max(in_plane.norm(), kMinCuttingSine);
}

PositionStrength WeakestOf(const Matrix6d& information, bool planar) {
  const Matrix6d covariance = information.ldlt().solve(Matrix6d::Identity());
  PositionStrength strength;
  const auto take = [&strength](const auto& solver, Eigen::Index last) {
    strength.stddev_m = std::sqrt(std::max(0.0, solver.eigenvalues()(last)));
    strength.direction_world.head(last + 1) = solver.eigenvectors().col(last);
  };
  if (planar) {
    const Eigen::Matrix2d position = covariance.block<2, 2>(3, 3);
    take(Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(position), 1);
  } else {
    const Eigen::Matrix3d position = covariance.block<3, 3>(3, 3);
    take(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(position), 2);
  }
  return strength;
}

}  // namespace

double DistanceStddev(const Observation& observation,
                      const ObservationPoses& poses,
                      const LandmarkView& plane) {
  return Cut(poses.motion.At(observation.middle_time_ns()), plane) *
         observation.sigma_offset_m;
}

bool IsWide(const Landmark& landmark) { return landmark.Width() > kMaxNarrow; }

void AddInformation(const Observation& observation,
                    const ObservationPoses& poses,
                    const LandmarkView& surface,
                    Matrix6d* information) {
  const ScanPlacement placement = poses.motion.At(observation.middle_time_ns());
  const Eigen::Vector3d centre = placement * observation.centroid().homogeneous();
  std::optional<LandmarkView> near;
  const LandmarkView& plane = surface.Near(centre, &near);
  const double cut = Cut(placement, plane);
  const Eigen::Vector3d along = placement.leftCols<2>() * observation.tangent();
  const Eigen::Vector3d lever = centre - poses.world_from_body.translation;
  Eigen::Matrix<double, 6, 1> row;
  row << lever.cross(plane.normal), plane.normal;
  const double sigma_offset = cut * observation.sigma_offset_m;
  if (sigma_offset > 0.0)
    *information += row * row.transpose() / (sigma_offset * sigma_offset);
  // Moved along an arc, the segment meets another normal.
  Eigen::Vector3d bend = surface.curvature * along;
  bend.z() = 0.0;
  row << along.cross(plane.normal) + lever.cross(bend), bend;
  const double sigma_direction = cut * observation.sigma_direction_rad;
  if (sigma_direction > 0.0) {
    *information += row * row.transpose() / (sigma_direction * sigma_direction);
  }
}

std::vector<PositionStrength> StrengthOverTime(const Rig& rig,
                                               bool planar,
                                               const MapState& state,
                                               int64_t start_ns) {
  std::vector<LandmarkView> planes;
  for (const Landmark& landmark : state.landmarks) planes.emplace_back(landmark);
  SharedPoses poses(rig, state.trajectory);
  std::vector<PositionStrength> strengths;
  for (const auto& [first, last] : ObservationsBySecond(start_ns, state)) {
    Matrix6d information = Matrix6d::Zero();
    information.diagonal() << Eigen::Vector3d::Constant(1.0 / (kUnknownTurn * kUnknownTurn)),
        Eigen::Vector3d::Constant(1.0 / (kUnknownPosition * kUnknownPosition));
    int num_segments = 0;
    for (size_t i = first; i < last; ++i) {
      const Observation& observation = state.observations[i];
      if (observation.landmark_id < 0) continue;
      AddInformation(observation,
                     poses.Of(observation),
                     planes[static_cast<size_t>(observation.landmark_id)],
                     &information);
      ++num_segments;
    }
    if (planar) {
      // Height, roll and pitch are held.
      for (const Eigen::Index held : {0, 1, 5}) {
        information.row(held).setZero();
        information.col(held).setZero();
        information(held, held) = 1.0;
      }
    }
    strengths.push_back(WeakestOf(information, planar));
    strengths.back().num_segments = num_segments;
  }
  return strengths;
}

std::string DirectionInWords(const Eigen::Vector3d& direction_world) {
  if (std::abs(direction_world.z()) > kSteep) return "vertical";
  double azimuth_deg = std::atan2(direction_world.y(), direction_world.x()) * 180.0 / M_PI;
  azimuth_deg = std::fmod(azimuth_deg + 360.0, 180.0);
  char text[80];
  std::snprintf(text, sizeof(text), "horizontal, %.0f deg from the x axis", azimuth_deg);
  return text;
}

std::vector<DegenerateInterval> DegenerateIntervals(
    const std::vector<PositionStrength>& strengths) {
  std::vector<DegenerateInterval> intervals;
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();  // of the last interval's worst second
  for (size_t second = 0; second < strengths.size(); ++second) {
    const PositionStrength& strength = strengths[second];
    // A second without any segment at the map's ends is no part of the map.
    if (strength.stddev_m < kDegenerate || strength.num_segments == 0) continue;
    const auto start_s = static_cast<double>(second);
    const bool continues = !intervals.empty() && start_s - intervals.back().end_s < kMaxGap &&
                           std::abs(direction.dot(strength.direction_world)) > kSameDirection;
    if (!continues) intervals.push_back({start_s, start_s, "", 0.0});
    DegenerateInterval& interval = intervals.back();
    interval.end_s = start_s + 1.0;
    if (strength.stddev_m > interval.stddev_m) {
      interval.stddev_m = strength.stddev_m;
      interval.direction = DirectionInWords(strength.direction_world);
      direction = strength.direction_world;
    }
  }
  return intervals;
}

}  // namespace plumbline
