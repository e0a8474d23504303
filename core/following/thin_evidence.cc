#include "core/following/thin_evidence.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <set>

#include "core/following/scan_on_planes.h"
#include "core/util/time.h"

namespace plumbline {
namespace {

// Cosine of the angle up to which a plane's normal speaks for a direction.
constexpr double kAlong = 0.5;
// More than this share of the points that lie on planes is no thin evidence.
constexpr double kManyPoints = 0.05;
// A plane stands still if it is seen for this time, with pauses no longer than kMaxPause,
// where the predicted motion has it to within this distance: people have walked on by much
// more.
constexpr double kStandStillTime = 0.25;      // s
constexpr double kStandStillDistance = 0.03;  // m
constexpr double kMaxPause = 0.1;             // s

}  // namespace

bool ThinEvidence::HasStoodStill() const {
  const Sighting& first = sightings_.front();
  if (SecondsBetween(first.time_ns, sightings_.back().time_ns) < kStandStillTime) return false;
  const auto [low, high] = std::minmax_element(
      sightings_.begin(), sightings_.end(), [](const Sighting& a, const Sighting& b) {
        return a.shift_m < b.shift_m;
      });
  return high->shift_m - low->shift_m < kStandStillDistance;
}

std::vector<int> ThinEvidence::Withhold(const MapState& state,
                                        int first_observation,
                                        int last_observation,
                                        const Eigen::Vector3d& predicted,
                                        const Eigen::Matrix3d& covariance,
                                        const Eigen::Vector3d& estimated) {
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(covariance);
  if (solver.eigenvalues()[2] < kOpenStddev * kOpenStddev) return {};
  const Eigen::Vector3d open = solver.eigenvectors().col(2);
  std::vector<int> along;
  std::set<int> landmarks;
  int num_points = 0;
  int num_along = 0;
  for (int index = first_observation; index <= last_observation; ++index) {
    const Observation& observation = state.observations[static_cast<size_t>(index)];
    if (observation.landmark_id < 0) continue;
    num_points += observation.num_points;
    const Landmark& landmark = state.landmarks[static_cast<size_t>(observation.landmark_id)];
    if (std::abs(landmark.Normal().dot(open)) < kAlong) continue;
    num_along += observation.num_points;
    along.push_back(index);
    landmarks.insert(observation.landmark_id);
  }
  if (landmarks.size() != 1 || num_along > kManyPoints * num_points) return {};
  const Sighting now = {state.observations[static_cast<size_t>(along.front())].end_time_ns(),
                        *landmarks.begin(),
                        (estimated - predicted).dot(open)};
  if (!sightings_.empty() &&
      (sightings_.back().landmark_id != now.landmark_id ||
       SecondsBetween(sightings_.back().time_ns, now.time_ns) > kMaxPause)) {
    sightings_.clear();
  }
  sightings_.push_back(now);
  while (sightings_.size() > 2 &&
         SecondsBetween(sightings_[1].time_ns, now.time_ns) >= kStandStillTime) {
    sightings_.pop_front();
  }
  if (HasStoodStill()) {
    sightings_.clear();
    return {};
  }
  return along;
}

}  // namespace plumbline
