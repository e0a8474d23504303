#include "core/sensor/imu.h"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "core/util/quantiles.h"
#include "core/util/time.h"

namespace plumbline {
namespace {

// A reading that comes this near to the end of its range stands for any larger one.
constexpr double kFullScale = 0.999;

bool IsEarlier(const ImuSample& a, const ImuSample& b) { return a.time_ns < b.time_ns; }

}  // namespace

ImuReadings::ImuReadings(std::vector<ImuSample> samples, const Imu& imu)
    : samples_(std::move(samples)),
      rate_range_(kFullScale * imu.gyroscope.range),
      force_range_(kFullScale * imu.accelerometer.range) {
  const auto is_not_finite = [](const ImuSample& sample) {
    return !sample.angular_rate.allFinite() || !sample.specific_force.allFinite();
  };
  const auto is_same_instant = [](const ImuSample& a, const ImuSample& b) {
    return a.time_ns == b.time_ns;
  };
  samples_.erase(std::remove_if(samples_.begin(), samples_.end(), is_not_finite),
                 samples_.end());
  std::stable_sort(samples_.begin(), samples_.end(), IsEarlier);
  samples_.erase(std::unique(samples_.begin(), samples_.end(), is_same_instant),
                 samples_.end());
  if (samples_.size() < 2) return;
  std::vector<double> periods_s;
  for (size_t i = 1; i < samples_.size(); ++i) {
    periods_s.push_back(SecondsBetween(samples_[i - 1].time_ns, samples_[i].time_ns));
  }
  period_s_ = Median(std::move(periods_s));
}

ImuMean ImuReadings::MeanOf(int64_t begin_ns, int64_t end_ns) const {
  ImuMean mean;
  double sum_s2 = 0.0;
  const auto first = std::lower_bound(
      samples_.begin(), samples_.end(), ImuSample{begin_ns, {}, {}}, IsEarlier);
  for (auto sample = first; sample != samples_.end() && sample->time_ns < end_ns; ++sample) {
    if (sample->angular_rate.cwiseAbs().maxCoeff() > rate_range_ ||
        sample->specific_force.cwiseAbs().maxCoeff() > force_range_) {
      return {};
    }
    const double time_s = SecondsBetween(begin_ns, sample->time_ns);
    mean.angular_rate += sample->angular_rate;
    mean.specific_force += sample->specific_force;
    mean.time_s += time_s;
    sum_s2 += time_s * time_s;
    ++mean.num_samples;
  }
  if (mean.num_samples == 0) return mean;
  const double count = mean.num_samples;
  mean.angular_rate /= count;
  mean.specific_force /= count;
  mean.time_s /= count;
  mean.time_stddev_s = std::sqrt(std::max(0.0, sum_s2 / count - mean.time_s * mean.time_s));
  return mean;
}

std::string ImuReadings::Fault() const {
  if (samples_.empty()) return "it has no readings";
  std::vector<double> forces;
  for (const ImuSample& sample : samples_) forces.push_back(sample.specific_force.norm());
  const double usual = Median(std::move(forces));
  // No person and no cart is accelerated by half of gravity most of the time.
  if (std::abs(usual - kStandardGravity) < 0.5 * kStandardGravity) return "";
  char text[120];
  std::snprintf(
      text,
      sizeof(text),
      "its accelerations are %.2f m/s^2 as a rule, where gravity alone is 9.81 (other "
      "units, or gravity taken off?)",
      usual);
  return text;
}

}  // namespace plumbline
