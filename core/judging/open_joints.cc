#include "core/judging/open_joints.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <deque>
#include <numeric>
#include <vector>

#include "core/geometry/matrix_types.h"
#include "core/geometry/unknown_pose.h"
#include "core/judging/degeneracy.h"
#include "core/judging/sightings.h"
#include "core/judging/verdict_levels.h"
#include "core/surface/landmark_view.h"
#include "core/util/time.h"

namespace plumbline {
namespace {

// Standard deviation of the heading by these observations on wide surfaces alone, rad.
double HeadingStddev(const MapState& state,
                     const std::vector<LandmarkView>& views,
                     size_t first,
                     size_t last,
                     SharedPoses* poses) {
  Matrix6d information = Matrix6d::Zero();
  information.diagonal() << Eigen::Vector3d::Constant(1.0 / (kUnknownTurn * kUnknownTurn)),
      Eigen::Vector3d::Constant(1.0 / (kUnknownPosition * kUnknownPosition));
  for (size_t i = first; i < last; ++i) {
    const Observation& observation = state.observations[i];
    if (observation.landmark_id < 0) continue;
    const auto id = static_cast<size_t>(observation.landmark_id);
    if (!IsWide(state.landmarks[id])) continue;
    AddInformation(observation, poses->Of(observation), views[id], &information);
  }
  const Matrix6d covariance = information.ldlt().solve(Matrix6d::Identity());
  return std::sqrt(std::max(0.0, covariance(2, 2)));
}

// In which the heading is open.
struct Stretch {
  int64_t first_ns;
  int64_t last_ns;
};

std::vector<Stretch> OpenStretches(const Rig& rig, const MapState& state) {
  const std::deque<Observation>& observations = state.observations;
  std::vector<LandmarkView> views;
  for (const Landmark& landmark : state.landmarks) views.emplace_back(landmark);
  SharedPoses poses(rig, state.trajectory);
  std::vector<Stretch> open;
  bool goes_on = false;
  for (size_t first = 0; first < observations.size();) {
    const int64_t first_ns = observations[first].middle_time_ns();
    const int64_t last_ns = first_ns + NanosecondsFromSeconds(kSlipTime);
    size_t last = first;
    while (last < observations.size() && observations[last].middle_time_ns() < last_ns) ++last;
    // Across the narrowest wall the heading then moves what it sees to another surface.
    const bool is_open =
        kMaxNarrow * HeadingStddev(state, views, first, last, &poses) > kSameSurface;
    if (is_open && !goes_on) open.push_back({first_ns, last_ns});
    if (is_open) open.back().last_ns = last_ns;
    goes_on = is_open;
    first = last;
  }
  return open;
}

// Points on wide walls, by landmark, in the parts before, between and after the stretches.
std::vector<std::vector<double>> PointsOfParts(const std::vector<Stretch>& stretches,
                                               const MapState& state) {
  std::vector<std::vector<double>> points(stretches.size() + 1,
                                          std::vector<double>(state.landmarks.size(), 0.0));
  size_t part = 0;  // the observations are in the order of time
  for (const Observation& observation : state.observations) {
    const int64_t time_ns = observation.middle_time_ns();
    while (part < stretches.size() && time_ns >= stretches[part].last_ns) ++part;
    if (observation.landmark_id < 0) continue;
    if (part < stretches.size() && time_ns >= stretches[part].first_ns) continue;
    const auto id = static_cast<size_t>(observation.landmark_id);
    const Landmark& landmark = state.landmarks[id];
    if (TraitsOf(landmark).has_doorways && IsWide(landmark)) {
      points[part][id] += observation.num_points;
    }
  }
  return points;
}

double Sum(const std::vector<double>& points) {
  return std::accumulate(points.begin(), points.end(), 0.0);
}

// Whether more than an exception of the points on walls, of the part that has fewer, is on
// walls that both have seen. A false heading puts a few of them on one, too.
bool AreTied(const std::vector<double>& a, const std::vector<double>& b) {
  double on_both = 0.0;
  for (size_t id = 0; id < a.size(); ++id) on_both += std::min(a[id], b[id]);
  return on_both >= kExceptionShare * std::min(Sum(a), Sum(b));
}

// The parts that are tied to the largest one, through others if need be.
std::vector<bool> TiedParts(const std::vector<std::vector<double>>& parts) {
  std::vector<double> sums;
  for (const std::vector<double>& part : parts) sums.push_back(Sum(part));
  const auto largest =
      static_cast<size_t>(std::max_element(sums.begin(), sums.end()) - sums.begin());
  std::vector<double> together = parts[largest];
  std::vector<bool> is_tied(parts.size(), false);
  is_tied[largest] = true;
  for (bool grows = true; grows;) {
    grows = false;
    for (size_t part = 0; part < parts.size(); ++part) {
      if (is_tied[part] || !AreTied(together, parts[part])) continue;
      for (size_t id = 0; id < together.size(); ++id) together[id] += parts[part][id];
      is_tied[part] = true;
      grows = true;
    }
  }
  return is_tied;
}

}  // namespace

std::vector<bool> FindOpenJoints(const Rig& rig, const MapState& state, int64_t start_ns) {
  const std::vector<Stretch> stretches = OpenStretches(rig, state);
  if (stretches.empty()) return {};
  const std::vector<bool> is_tied = TiedParts(PointsOfParts(stretches, state));
  std::vector<bool> is_joint;
  for (size_t i = 0; i < stretches.size(); ++i) {
    if (is_tied[i] && is_tied[i + 1]) continue;
    const auto second = static_cast<size_t>(SecondOf(start_ns, stretches[i].first_ns));
    if (second >= is_joint.size()) is_joint.resize(second + 1, false);
    is_joint[second] = true;
  }
  return is_joint;
}

}  // namespace plumbline
