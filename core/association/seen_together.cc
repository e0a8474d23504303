#include "core/association/seen_together.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>

#include "core/association/line_deviation.h"
#include "core/map/observation_poses.h"
#include "core/surface/landmark_view.h"
#include "core/util/quantiles.h"
#include "core/util/time.h"

namespace plumbline {
namespace {

// Mean of deviations, each weighed by its variance.
struct MeanDeviation {
  double sum = 0.0;     // 1/m
  double weight = 0.0;  // 1/m^2

  void Add(double deviation_m, double variance) {
    sum += deviation_m / variance;
    weight += 1.0 / variance;
  }
  double Mean() const { return sum / weight; }
  double Variance() const { return 1.0 / weight; }
};

}  // namespace

bool LieApart(const Rig& rig,
              const MapState& state,
              const Landmark& a,
              const Landmark& b,
              double flatness_m) {
  const LandmarkView view(a);
  const int first_scan = std::max(a.first_scan, b.first_scan);
  const int last_scan = std::min(a.last_scan, b.last_scan);
  std::map<int64_t, std::array<MeanDeviation, 2>> seconds;
  SharedPoses poses(rig, state.trajectory);
  auto observation = std::partition_point(
      state.observations.begin(), state.observations.end(), [&](const Observation& earlier) {
        return earlier.scan_index < first_scan;
      });
  for (; observation != state.observations.end() && observation->scan_index <= last_scan;
       ++observation) {
    if (observation->landmark_id != a.id && observation->landmark_id != b.id) continue;
    const LineDeviation deviation =
        DeviationFromPlane(*observation, poses.Of(*observation), view);
    const double variance = deviation.covariance(0, 0);
    if (!(variance > 0.0) || !std::isfinite(variance)) continue;
    const int64_t second = observation->middle_time_ns() / NanosecondsFromSeconds(1.0);
    seconds[second][observation->landmark_id == a.id ? 0 : 1].Add(deviation.value.x(),
                                                                  variance);
  }
  MeanDeviation difference;
  for (const auto& [second, of] : seconds) {
    if (of[0].weight == 0.0 || of[1].weight == 0.0) continue;
    difference.Add(of[1].Mean() - of[0].Mean(), of[0].Variance() + of[1].Variance());
  }
  if (difference.weight == 0.0) return false;
  const double arm_m = (a.extent.Centre() - b.extent.Centre()).norm();
  const double turn_variance = TraitsOf(a).has_heading ? a.covariance(0, 0) : 0.0;
  const double variance =
      difference.Variance() + 2.0 * flatness_m * flatness_m + arm_m * arm_m * turn_variance;
  return difference.Mean() * difference.Mean() >
         kSignificantStddevs * kSignificantStddevs * variance;
}

}  // namespace plumbline
