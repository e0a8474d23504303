#include "core/batch/visited_walls.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <set>
#include <utility>
#include <vector>

#include "core/association/plane_merging.h"
#include "core/batch/visit_levels.h"
#include "core/map/observation_poses.h"
#include "core/registration/revisits.h"
#include "core/util/time.h"

namespace plumbline {
namespace {

bool IsWall(const Landmark& landmark) { return TraitsOf(landmark).has_heading; }

// When each landmark was seen, in steps of kVisitTime.
std::vector<std::set<int64_t>> TimesSeen(const MapState& state) {
  std::vector<std::set<int64_t>> times(state.landmarks.size());
  for (const Observation& observation : state.observations) {
    if (observation.landmark_id < 0) continue;
    const double time_s = SecondsBetween(state.origin_time_ns, observation.start_time_ns());
    times[static_cast<size_t>(observation.landmark_id)].insert(
        static_cast<int64_t>(std::floor(time_s / kVisitTime)));
  }
  return times;
}

bool SeenTogether(const std::set<int64_t>& a, const std::set<int64_t>& b) {
  return std::any_of(a.begin(), a.end(), [&](int64_t time) {
    return b.count(time) + b.count(time - 1) + b.count(time + 1) > 0;
  });
}

}  // namespace

int SplitWallsByVisits(MapState* state) {
  std::vector<int> successors(state->landmarks.size());  // the present visit's, by id
  std::iota(successors.begin(), successors.end(), 0);
  std::vector<int64_t> last_ns(state->landmarks.size(), -1);
  const size_t num_before = state->landmarks.size();
  for (Observation& observation : state->observations) {
    if (observation.landmark_id < 0) continue;
    const auto id = static_cast<size_t>(observation.landmark_id);
    if (!IsWall(state->landmarks[id])) continue;
    const int64_t time_ns = observation.start_time_ns();
    if (last_ns[id] >= 0 && SecondsBetween(last_ns[id], time_ns) > kMinAbsence) {
      Landmark successor = state->landmarks[id];
      successor.id = successors[id] = static_cast<int>(state->landmarks.size());
      successor.heading_fixed = false;
      state->landmarks.push_back(std::move(successor));
    }
    last_ns[id] = time_ns;
    observation.landmark_id = successors[id];
  }
  return static_cast<int>(state->landmarks.size() - num_before);
}

void PlaceWalls(const Rig& rig, MapState* state) {
  struct Sums {
    double weight = 0.0;
    Eigen::Vector2d ends = Eigen::Vector2d::Zero();
    Eigen::Matrix2d products = Eigen::Matrix2d::Zero();
    Eigen::Vector2d seen_from = Eigen::Vector2d::Zero();
  };
  std::vector<Sums> sums(state->landmarks.size());
  SharedPoses poses(rig, state->trajectory);
  for (const Observation& observation : state->observations) {
    if (observation.landmark_id < 0 || observation.num_points == 0) continue;
    Sums& of_wall = sums[static_cast<size_t>(observation.landmark_id)];
    const ObservationPoses& of_segment = poses.Of(observation);
    for (const Eigen::Vector3d& end :
         {of_segment.motion.ToWorld(observation.start(), observation.start_time_ns()),
          of_segment.motion.ToWorld(observation.end(), observation.end_time_ns())}) {
      const double weight = 0.5 * observation.num_points;
      of_wall.weight += weight;
      of_wall.ends += weight * end.head<2>();
      of_wall.products += weight * end.head<2>() * end.head<2>().transpose();
      of_wall.seen_from += weight * of_segment.world_from_body.translation.head<2>();
    }
  }
  for (Landmark& wall : state->landmarks) {
    const Sums& of_wall = sums[static_cast<size_t>(wall.id)];
    if (!IsWall(wall) || of_wall.weight == 0.0) continue;
    const Eigen::Vector2d mean = of_wall.ends / of_wall.weight;
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver;
    solver.computeDirect(of_wall.products / of_wall.weight - mean * mean.transpose());
    Eigen::Vector2d normal = solver.eigenvectors().col(0);
    if (normal.dot(of_wall.seen_from / of_wall.weight - mean) < 0.0) normal = -normal;
    if (!wall.heading_fixed) wall.parameters[0] = std::atan2(normal.y(), normal.x());
    wall.parameters[1] = wall.Normal().head<2>().dot(mean);
  }
}

int MergeVisitedWalls(MapState* state) {
  std::vector<std::set<int64_t>> times = TimesSeen(*state);
  int num_merged = 0;
  for (size_t b = 0; b < state->landmarks.size(); ++b) {
    const Landmark& wall = state->landmarks[b];
    if (wall.num_segments == 0 || !IsWall(wall)) continue;
    int nearest = -1;
    double least_m = kSameSurfaceDistance;
    for (size_t a = 0; a < b; ++a) {
      const Landmark& before = state->landmarks[a];
      if (before.num_segments == 0 || !IsWall(before)) continue;
      if (before.Normal().dot(wall.Normal()) < kSameNormalCosine) continue;
      const double distance_m = std::abs(before.SignedDistance(wall.extent.Centre()));
      if (distance_m >= least_m || !before.extent.IsNear(wall.extent, kSameSurfaceGap))
        continue;
      if (SeenTogether(times[a], times[b])) continue;
      nearest = static_cast<int>(a);
      least_m = distance_m;
    }
    if (nearest < 0) continue;
    MergeInto(nearest, static_cast<int>(b), state);
    times[static_cast<size_t>(nearest)].insert(times[b].begin(), times[b].end());
    ++num_merged;
  }
  return num_merged;
}

}  // namespace plumbline
