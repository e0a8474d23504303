#include "core/sensor/mount.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/sensor/joint_samples.h"
#include "core/util/quantiles.h"
#include "core/util/time.h"

namespace plumbline {
namespace {

bool IsEarlier(const JointSample& a, const JointSample& b) { return a.time_ns < b.time_ns; }

}  // namespace

JointAngles::JointAngles(std::vector<JointSample> samples) : samples_(std::move(samples)) {
  SortAndUnwrap(&samples_);
  std::vector<double> steps_s;
  for (size_t i = 1; i < samples_.size(); ++i) {
    steps_s.push_back(SecondsBetween(samples_[i - 1].time_ns, samples_[i].time_ns));
  }
  rates_rad_s_.assign(samples_.size(), 0.0);
  if (steps_s.empty()) return;
  const auto slope = [&](size_t i) {
    return (samples_[i + 1].angle_rad - samples_[i].angle_rad) / steps_s[i];
  };
  rates_rad_s_.front() = slope(0);
  rates_rad_s_.back() = slope(steps_s.size() - 1);
  for (size_t i = 1; i < steps_s.size(); ++i) {
    const double before_s = steps_s[i - 1];
    const double after_s = steps_s[i];
    rates_rad_s_[i] = (after_s * slope(i - 1) + before_s * slope(i)) / (before_s + after_s);
  }
  longest_gap_s_ = *std::max_element(steps_s.begin(), steps_s.end());
  // One reading may be lost, and stamps shake; of what happens in a longer gap nothing is
  // known.
  max_step_s_ = 3.0 * Median(std::move(steps_s));
}

MountAngle JointAngles::At(int64_t time_ns) const {
  if (samples_.empty()) return {};
  const auto next =
      std::upper_bound(samples_.begin(), samples_.end(), JointSample{time_ns, 0.0}, IsEarlier);
  if (next == samples_.begin() || next == samples_.end()) {
    const size_t end = next == samples_.begin() ? 0 : samples_.size() - 1;
    return {samples_[end].angle_rad +
                rates_rad_s_[end] * SecondsBetween(samples_[end].time_ns, time_ns),
            rates_rad_s_[end],
            0.0};
  }
  const auto i = static_cast<size_t>(next - samples_.begin()) - 1;
  const double span_s = SecondsBetween(samples_[i].time_ns, samples_[i + 1].time_ns);
  const double t = SecondsBetween(samples_[i].time_ns, time_ns) / span_s;
  const double rise = samples_[i + 1].angle_rad - samples_[i].angle_rad;
  const double from = span_s * rates_rad_s_[i];
  const double to = span_s * rates_rad_s_[i + 1];
  const double quadratic = 3.0 * rise - 2.0 * from - to;
  const double cubic = from + to - 2.0 * rise;
  return {samples_[i].angle_rad + t * (from + t * (quadratic + t * cubic)),
          (from + t * (2.0 * quadratic + 3.0 * t * cubic)) / span_s,
          (2.0 * quadratic + 6.0 * t * cubic) / (span_s * span_s)};
}

bool JointAngles::Covers(int64_t time_ns) const {
  const auto next =
      std::upper_bound(samples_.begin(), samples_.end(), JointSample{time_ns, 0.0}, IsEarlier);
  if (next == samples_.begin() || next == samples_.end()) {
    // The last reading, or one that is not older than the next one would be.
    if (samples_.empty()) return false;
    const JointSample& end = next == samples_.begin() ? samples_.front() : samples_.back();
    return std::abs(SecondsBetween(end.time_ns, time_ns)) <= max_step_s_;
  }
  return SecondsBetween((next - 1)->time_ns, next->time_ns) <= max_step_s_;
}

std::string JointAngles::Fault() const {
  if (samples_.empty()) return "it has no readings";
  const auto [least, most] = std::minmax_element(
      samples_.begin(), samples_.end(), [](const JointSample& a, const JointSample& b) {
        return a.angle_rad < b.angle_rad;
      });
  if (least->angle_rad == most->angle_rad) return "its angle never changes";
  return "";
}

double Mount::SinceStart(int64_t time_ns) const { return SecondsBetween(start_ns, time_ns); }

MountAngle Mount::StatedAt(int64_t time_ns, double later_s) const {
  if (IsRead()) {
    return angles == nullptr ? MountAngle()
                             : angles->At(time_ns + NanosecondsFromSeconds(later_s));
  }
  const double time_s = SinceStart(time_ns) + later_s - time_offset_s;
  if (!swing) return {rate_rad_s * time_s, rate_rad_s, 0.0};
  const double frequency = 2.0 * M_PI / swing->period_s;
  const double phase = frequency * time_s + swing->phase_rad;
  return {swing->amplitude_rad * std::sin(phase),
          swing->amplitude_rad * frequency * std::cos(phase),
          -swing->amplitude_rad * frequency * frequency * std::sin(phase)};
}

double Mount::AngleAt(int64_t time_ns, double later_s) const {
  return zero_rad + StatedAt(time_ns, later_s + Earlier(time_ns)).angle_rad;
}

Rigid3d Mount::TurnBy(double angle_rad) const {
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(angle_rad, axis));
  return {turn, point - turn * point};
}

Rigid3d Mount::TurnAt(int64_t time_ns, double later_s) const {
  return TurnBy(AngleAt(time_ns, later_s));
}

}  // namespace plumbline
