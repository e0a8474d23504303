#include "core/judging/wheel_slips.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/geometry/rigid3.h"
#include "core/util/quantiles.h"
#include "core/util/time.h"

namespace plumbline {
namespace {

// A sum over the knot intervals of a stretch, along a direction.
struct Sum {
  double residual_m = 0.0;  // wheels minus map
  double length_m = 0.0;    // that the wheels count
  double variance = 0.0;    // m2, of the intervals' noise
};

// The sum of the wheels' residuals; none where the wheels do not cover the stretch, or the map
// has a gap in it.
std::optional<Sum> SumOver(const MapState& state,
                           const Eigen::Vector3d& direction_world,
                           int64_t begin_ns,
                           int64_t end_ns) {
  Sum sum;
  const int64_t step_ns = state.trajectory.knot_interval_ns();
  for (int64_t time_ns = begin_ns; time_ns < end_ns; time_ns += step_ns) {
    const int64_t next_ns = std::min(time_ns + step_ns, end_ns);
    const std::optional<PlanarMotion> stated = state.odometry->Between(time_ns, next_ns);
    if (!stated || !state.IsMapped(time_ns) || !state.IsMapped(next_ns)) return std::nullopt;
    const OdometryMeasurement measured = state.odometry_calibration.Measure(*stated);
    const Rigid3d begin = state.trajectory.WorldFromBody(time_ns);
    const Rigid3d end = state.trajectory.WorldFromBody(next_ns);
    const Eigen::Vector2d along_body =
        (begin.rotation.conjugate() * direction_world).head<2>();
    const Eigen::Vector2d mapped =
        (begin.rotation.conjugate() * (end.translation - begin.translation)).head<2>();
    sum.residual_m += along_body.dot(measured.translation - mapped);
    sum.length_m += along_body.dot(measured.translation);
    sum.variance +=
        along_body.squaredNorm() * measured.translation_stddev * measured.translation_stddev;
  }
  return sum;
}

double Square(double value) { return value * value; }

}  // namespace

std::vector<WheelSlip> FindWheelSlips(const MapState& state,
                                      const std::vector<PositionStrength>& strengths,
                                      const std::vector<DegenerateInterval>& open,
                                      int64_t start_ns) {
  std::vector<WheelSlip> slips;
  if (state.odometry == nullptr) return slips;
  for (const DegenerateInterval& interval : open) {
    const auto first = static_cast<size_t>(interval.start_s);
    const auto after = static_cast<size_t>(interval.end_s);
    // At the map's ends the way is the wheels' own.
    if (first == 0 || after >= strengths.size()) continue;
    const auto worst =
        std::max_element(strengths.begin() + static_cast<std::ptrdiff_t>(first),
                         strengths.begin() + static_cast<std::ptrdiff_t>(after),
                         [](const auto& a, const auto& b) { return a.stddev_m < b.stddev_m; });
    const std::optional<Sum> sum = SumOver(state,
                                           worst->direction_world,
                                           start_ns + NanosecondsFromSeconds(interval.start_s),
                                           start_ns + NanosecondsFromSeconds(interval.end_s));
    if (!sum) continue;
    const double variance =
        sum->variance +
        Square(sum->length_m * state.odometry_calibration.length_scale_stddev()) +
        Square(strengths[first - 1].stddev_m) + Square(strengths[after].stddev_m);
    if (Square(sum->residual_m) > Square(kSignificantStddevs) * variance)
      slips.push_back({interval.start_s, interval.end_s, std::abs(sum->residual_m)});
  }
  return slips;
}

}  // namespace plumbline
