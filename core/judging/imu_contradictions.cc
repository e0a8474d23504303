#include "core/judging/imu_contradictions.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/estimation/imu_terms.h"
#include "core/util/quantiles.h"
#include "core/util/time.h"

namespace plumbline {
namespace {

// A sensor's part of a difference, and its square in variances.
struct OfSensor {
  OfSensor(const ImuDifference& difference, bool by_accelerometer)
      : world(by_accelerometer ? difference.velocity_world : difference.turn_world),
        square(world.squaredNorm() /
               (by_accelerometer ? difference.velocity_variance : difference.turn_variance)) {}

  Eigen::Vector3d world;
  double square;
};

// The difference over the whole knot intervals of a second; none where not all of it is
// mapped, or readings are missing.
std::optional<ImuDifference> DifferenceIn(const MapState& state, int64_t begin_ns) {
  const Trajectory& trajectory = state.trajectory;
  const int64_t end_ns = begin_ns + NanosecondsFromSeconds(1.0);
  if (begin_ns < trajectory.start_ns() || end_ns >= trajectory.end_ns()) return std::nullopt;
  for (const MapGap& gap : state.gaps) {
    if (gap.start_ns < end_ns && begin_ns < gap.end_ns) return std::nullopt;
  }
  const int first = trajectory.Locate(begin_ns).first;
  const int end = trajectory.Locate(end_ns).first;
  return DifferenceFromImu(state, first, end);
}

// The sum over a second and its two neighbours, so that no bound between two seconds halves
// what lasts for less than one.
std::optional<ImuDifference> SumAbout(
    const std::vector<std::optional<ImuDifference>>& by_second, int second) {
  std::optional<ImuDifference> sum;
  const int last = std::min(second + 1, static_cast<int>(by_second.size()) - 1);
  for (int at = std::max(0, second - 1); at <= last; ++at) {
    const std::optional<ImuDifference>& part = by_second[static_cast<size_t>(at)];
    if (!part) continue;
    if (!sum) sum.emplace();
    *sum += *part;
  }
  return sum;
}

}  // namespace

std::vector<ImuContradiction> FindImuContradictions(const MapState& state,
                                                    int num_seconds,
                                                    int64_t start_ns) {
  std::vector<ImuContradiction> contradictions;
  if (state.imu == nullptr || !state.calibration.imu || state.calibration.imu->planar) {
    return contradictions;
  }
  std::vector<std::optional<ImuDifference>> by_second;
  for (int second = 0; second < num_seconds; ++second) {
    by_second.push_back(DifferenceIn(state, start_ns + NanosecondsFromSeconds(second)));
  }
  // One of all that are asked, by two sensors.
  const double chance = std::erfc(kSignificantStddevs * std::sqrt(0.5)) / (2 * num_seconds);
  for (const bool by_accelerometer : {false, true}) {
    std::vector<double> squares;
    for (const std::optional<ImuDifference>& one : by_second) {
      if (one) squares.push_back(OfSensor(*one, by_accelerometer).square);
    }
    const double variance = std::max(1.0, Median(squares) / Chi2Quantile(3, 0.0));
    const double limit = variance * Chi2Quantile(3, TwoSidedNormalQuantile(2.0 * chance));
    for (int second = 0; second < num_seconds; ++second) {
      const std::optional<ImuDifference> sum = SumAbout(by_second, second);
      if (!sum) continue;
      const OfSensor difference(*sum, by_accelerometer);
      VLOG(1) << "second " << second << (by_accelerometer ? " accelerometer " : " gyroscope ")
              << difference.world.transpose() << ", " << std::sqrt(difference.square)
              << " deviations";
      if (difference.square > limit)
        contradictions.push_back({second, by_accelerometer, difference.world});
    }
  }
  return contradictions;
}

}  // namespace plumbline
