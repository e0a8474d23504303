#include "core/batch/loop_closures.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/association/line_deviation.h"
#include "core/batch/visit_levels.h"
#include "core/judging/verdict_levels.h"
#include "core/map/observation_poses.h"
#include "core/surface/landmark_view.h"
#include "core/util/quantiles.h"
#include "core/util/time.h"

namespace plumbline {
namespace {

// A visit with fewer segments does not contradict another one.
constexpr int kMinSegments = 5;

// The weighted mean of segments' deviations from their plane.
class MeanDeviation {
 public:
  void Add(double value, double variance) {
    sum_weights_ += 1.0 / variance;
    sum_values_ += value / variance;
    ++num_segments_;
  }
  void Add(const MeanDeviation& other) {
    sum_weights_ += other.sum_weights_;
    sum_values_ += other.sum_values_;
    num_segments_ += other.num_segments_;
  }
  double mean_m() const { return sum_values_ / sum_weights_; }
  double variance_m2() const { return 1.0 / sum_weights_; }
  int num_segments() const { return num_segments_; }

 private:
  double sum_weights_ = 0.0;
  double sum_values_ = 0.0;
  int num_segments_ = 0;
};

// The observations of a landmark between two absences.
struct Visit {
  int landmark_id = 0;
  int first_scan = 0;
  int last_scan = 0;
  int64_t first_time_ns = 0;
  MeanDeviation deviation;
};

// Which landmarks, by id, came back into view after an absence.
std::vector<bool> HaveReturned(int max_gap_scans, const MapState& state) {
  std::vector<bool> has_returned(state.landmarks.size(), false);
  std::vector<int> last_scans(state.landmarks.size(), -1);
  for (const Observation& observation : state.observations) {
    if (observation.landmark_id < 0 || observation.num_points == 0) continue;
    const auto id = static_cast<size_t>(observation.landmark_id);
    if (last_scans[id] >= 0 && observation.scan_index - last_scans[id] > max_gap_scans) {
      has_returned[id] = true;
    }
    last_scans[id] = observation.scan_index;
  }
  return has_returned;
}

// The visits of each landmark that came back into view, by id, in the order of time.
std::vector<std::vector<Visit>> CollectVisits(const Rig& rig,
                                              int max_gap_scans,
                                              const MapState& state) {
  std::vector<LandmarkView> planes;
  for (const Landmark& landmark : state.landmarks) planes.emplace_back(landmark);
  std::vector<std::vector<Visit>> visits(state.landmarks.size());
  const std::vector<bool> has_returned = HaveReturned(max_gap_scans, state);
  SharedPoses poses(rig, state.trajectory);
  for (const Observation& observation : state.observations) {
    if (observation.landmark_id < 0 || observation.num_points == 0) continue;
    const auto id = static_cast<size_t>(observation.landmark_id);
    if (!has_returned[id]) continue;
    std::vector<Visit>& of_landmark = visits[id];
    const LineDeviation deviation =
        DeviationFromPlane(observation, poses.Of(observation), planes[id]);
    // A segment along the plane's normal says nothing of where it lies.
    if (!deviation.value.allFinite() || !std::isfinite(deviation.covariance(0, 0))) continue;
    if (of_landmark.empty() ||
        observation.scan_index - of_landmark.back().last_scan > max_gap_scans) {
      of_landmark.push_back({observation.landmark_id,
                             observation.scan_index,
                             observation.scan_index,
                             observation.start_time_ns(),
                             {}});
    }
    Visit& visit = of_landmark.back();
    visit.last_scan = observation.scan_index;
    visit.deviation.Add(deviation.value.x(), deviation.covariance(0, 0));
  }
  return visits;
}

// The test of each closure on its own; accepted where it is not significant.
std::vector<LoopClosure> TestAlone(const std::vector<std::vector<Visit>>& visits,
                                   const AssociationOptions& options) {
  const double normal_quantile = TwoSidedNormalQuantile(options.significance);
  const double unevenness = options.surface_flatness_m * options.surface_flatness_m;
  std::vector<LoopClosure> closures;
  for (const std::vector<Visit>& of_landmark : visits) {
    MeanDeviation before;
    for (const Visit& visit : of_landmark) {
      if (before.num_segments() > 0) {
        LoopClosure closure;
        closure.surface_a = closure.surface_b = visit.landmark_id;
        closure.time_ns = visit.first_time_ns;
        closure.difference_m = visit.deviation.mean_m() - before.mean_m();
        const double variance =
            before.variance_m2() + visit.deviation.variance_m2() + 2.0 * unevenness;
        closure.statistic = closure.difference_m * closure.difference_m / variance;
        closure.threshold = normal_quantile * normal_quantile;
        // Whatever the statistic, two visits see one surface to within kSameSurface: furniture
        // moves more, and rigs are calibrated better.
        closure.accepted =
            closure.statistic <= closure.threshold ||
            std::abs(closure.difference_m) < kSameSurface ||
            std::min(before.num_segments(), visit.deviation.num_segments()) < kMinSegments;
        closures.push_back(closure);
      }
      before.Add(visit.deviation);
    }
  }
  std::stable_sort(
      closures.begin(), closures.end(), [](const LoopClosure& a, const LoopClosure& b) {
        return a.time_ns < b.time_ns;
      });
  return closures;
}

}  // namespace

std::vector<LoopClosure> TestLoopClosures(const Rig& rig,
                                          const MapperOptions& options,
                                          const MapState& state) {
  std::vector<LoopClosure> closures = TestAlone(
      CollectVisits(rig, options.loop_closure.max_gap_scans, state), options.association);
  const double normal_quantile = TwoSidedNormalQuantile(options.association.significance);
  for (size_t first = 0; first < closures.size();) {
    size_t end = first;
    double statistic = 0.0;
    while (end < closures.size() &&
           SecondsBetween(closures[first].time_ns, closures[end].time_ns) < kVisitTime) {
      statistic += closures[end++].statistic;
    }
    const double threshold = Chi2Quantile(static_cast<int>(end - first), normal_quantile);
    for (; first < end; ++first) {
      closures[first].return_statistic = statistic;
      closures[first].return_threshold = threshold;
      closures[first].accepted = closures[first].accepted || statistic <= threshold;
    }
  }
  return closures;
}

int TakeBackContradictedClosures(const Rig& rig,
                                 const MapperOptions& options,
                                 MapState* state,
                                 std::vector<LoopClosure>* rejected) {
  std::vector<int64_t> taken_back_ns(state->landmarks.size(),
                                     std::numeric_limits<int64_t>::max());
  std::vector<int> successors(state->landmarks.size(), -1);
  for (LoopClosure& closure : TestLoopClosures(rig, options, *state)) {
    const auto id = static_cast<size_t>(closure.surface_a);
    if (closure.accepted || successors[id] >= 0) continue;
    taken_back_ns[id] = closure.time_ns;
    successors[id] = static_cast<int>(state->landmarks.size());
    closure.surface_b = successors[id];
    Landmark successor = state->landmarks[id];
    successor.id = closure.surface_b;
    successor.heading_fixed = false;
    state->landmarks.push_back(std::move(successor));
    rejected->push_back(closure);
  }
  int num_changed = 0;
  for (Observation& observation : state->observations) {
    const int id = observation.landmark_id;
    if (id < 0 || static_cast<size_t>(id) >= successors.size()) continue;
    const auto at = static_cast<size_t>(id);
    if (observation.start_time_ns() < taken_back_ns[at]) continue;
    observation.landmark_id = successors[at];
    ++num_changed;
  }
  return num_changed;
}

}  // namespace plumbline
