#include "core/following/scan_on_planes.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/map/observation_poses.h"

namespace plumbline {
namespace {

// The height is open from less on: treads are 0.18 m apart, and a few beams at the edge of one
// give a wrong speed, by which the next one is taken for another.
constexpr double kOpenHeightStddev = 0.006;  // m

// What an observation tells of the distance from its surface, 1/m^2.
double InformationOf(const Observation& observation, double flatness_m) {
  return 1.0 /
         (observation.sigma_offset_m * observation.sigma_offset_m + flatness_m * flatness_m);
}

// Calls visit(index, observation, landmark) for the observations first .. last that have a
// landmark.
template <typename Visit>
void ForEachOnPlane(const MapState& state,
                    int first_observation,
                    int last_observation,
                    Visit visit) {
  for (int index = first_observation; index <= last_observation; ++index) {
    const Observation& observation = state.observations[static_cast<size_t>(index)];
    if (observation.landmark_id < 0) continue;
    visit(index, observation, state.landmarks[static_cast<size_t>(observation.landmark_id)]);
  }
}

}  // namespace

double ShareOnNoPlane(const MapState& state,
                      int first_observation,
                      int last_observation,
                      int num_points) {
  int num_on_planes = 0;
  ForEachOnPlane(state,
                 first_observation,
                 last_observation,
                 [&](int, const Observation& observation, const Landmark&) {
                   num_on_planes += observation.num_points;
                 });
  return 1.0 - static_cast<double>(num_on_planes) / std::max(1, num_points);
}

BeamMask BeamsOnNoPlane(const MapState& state,
                        int first_observation,
                        int last_observation,
                        const ScanMatcher& scan_matcher) {
  BeamMask mask = scan_matcher.AllBeams();
  ForEachOnPlane(
      state,
      first_observation,
      last_observation,
      [&](int, const Observation& observation, const Landmark&) {
        scan_matcher.Exclude(
            observation.scan_line_index, observation.first_beam, observation.last_beam, &mask);
      });
  return mask;
}

bool WallsLeaveOpen(const MapState& state,
                    int first_observation,
                    int last_observation,
                    double min_width_m,
                    double flatness_m) {
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();
  const auto add = [&](int, const Observation& observation, const Landmark& landmark) {
    if (landmark.Width() < min_width_m) return;
    // An arc's normals point into many directions: the one in its middle is as good as any.
    const Eigen::Vector2d normal = landmark.NormalNear(landmark.extent.Centre()).head<2>();
    information += normal * normal.transpose() * InformationOf(observation, flatness_m);
  };
  ForEachOnPlane(state, first_observation, last_observation, add);
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver;
  solver.computeDirect(information, Eigen::EigenvaluesOnly);
  return solver.eigenvalues()[0] * kOpenStddev * kOpenStddev < 1.0;
}

bool WallsLeavePoseOpen(const Rig& rig,
                        const MapState& state,
                        int first_observation,
                        int last_observation,
                        double min_width_m,
                        double flatness_m) {
  // Of position and heading; a turn counts by what it moves at the distance of the walls.
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  double sum_distances2 = 0.0;
  int num_ends = 0;
  SharedPoses shared(rig, state.trajectory);
  const auto add = [&](int, const Observation& observation, const Landmark& landmark) {
    if (landmark.Width() < min_width_m) return;
    const ObservationPoses& poses = shared.Of(observation);
    const Eigen::Vector3d ends[] = {
        poses.motion.ToWorld(observation.start(), observation.start_time_ns()),
        poses.motion.ToWorld(observation.end(), observation.end_time_ns())};
    for (const Eigen::Vector3d& end : ends) {
      const Eigen::Vector3d lever = end - poses.world_from_body.translation;
      const Eigen::Vector3d normal = landmark.NormalNear(end);
      const Eigen::Vector3d row(normal.x(), normal.y(), lever.cross(normal).z());
      information += 0.5 * row * row.transpose() * InformationOf(observation, flatness_m);
      sum_distances2 += lever.head<2>().squaredNorm();
      ++num_ends;
    }
  };
  ForEachOnPlane(state, first_observation, last_observation, add);
  if (num_ends == 0) return true;
  const double distance = std::sqrt(sum_distances2 / num_ends);
  const Eigen::Vector3d scale(1.0, 1.0, 1.0 / distance);
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(scale.asDiagonal() * information * scale.asDiagonal(),
                       Eigen::EigenvaluesOnly);
  return solver.eigenvalues()[0] * kOpenStddev * kOpenStddev < 1.0;
}

bool HeightIsOpen(const MapState& state,
                  int first_observation,
                  int last_observation,
                  double flatness_m) {
  double information = 0.0;
  const auto add = [&](int, const Observation& observation, const Landmark& landmark) {
    const double up = landmark.Normal().z();  // zero on walls
    information += up * up * InformationOf(observation, flatness_m);
  };
  ForEachOnPlane(state, first_observation, last_observation, add);
  return information * kOpenHeightStddev * kOpenHeightStddev < 1.0;
}

bool IsNarrowWall(const Landmark& landmark, double min_width_m) {
  return landmark.model != PlaneModel::kHorizontal && landmark.Width() < min_width_m;
}

std::vector<int> OnNarrowPlanes(const MapState& state,
                                int first_observation,
                                int last_observation,
                                double min_width_m) {
  std::vector<int> on_narrow;
  ForEachOnPlane(state,
                 first_observation,
                 last_observation,
                 [&](int index, const Observation&, const Landmark& landmark) {
                   if (IsNarrowWall(landmark, min_width_m)) on_narrow.push_back(index);
                 });
  return on_narrow;
}

}  // namespace plumbline
