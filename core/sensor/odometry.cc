#include "core/sensor/odometry.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/util/time.h"

namespace plumbline {
namespace {

bool IsFinite(const OdometrySample& sample) {
  return sample.position.allFinite() && std::isfinite(sample.heading);
}

}  // namespace

Odometry::Odometry(std::vector<OdometrySample> samples) : samples_(std::move(samples)) {
  samples_.erase(
      std::remove_if(samples_.begin(),
                     samples_.end(),
                     [](const OdometrySample& sample) { return !IsFinite(sample); }),
      samples_.end());
  std::stable_sort(
      samples_.begin(), samples_.end(), [](const OdometrySample& a, const OdometrySample& b) {
        return a.time_ns < b.time_ns;
      });
  samples_.erase(std::unique(samples_.begin(),
                             samples_.end(),
                             [](const OdometrySample& a, const OdometrySample& b) {
                               return a.time_ns == b.time_ns;
                             }),
                 samples_.end());
  for (size_t i = 1; i < samples_.size(); ++i) {
    OdometrySample& sample = samples_[i];
    sample.heading = samples_[i - 1].heading +
                     std::remainder(sample.heading - samples_[i - 1].heading, 2.0 * M_PI);
    if (SecondsBetween(samples_[i - 1].time_ns, sample.time_ns) > kMaxGap) {
      gap_ends_.push_back(i);
    }
  }
}

Odometry Odometry::Later(double seconds) const {
  Odometry later = *this;
  for (OdometrySample& sample : later.samples_) {
    sample.time_ns += NanosecondsFromSeconds(seconds);
  }
  return later;
}

size_t Odometry::FirstFrom(int64_t time_ns) const {
  const auto at = std::lower_bound(
      samples_.begin(), samples_.end(), time_ns, [](const OdometrySample& sample, int64_t t) {
        return sample.time_ns < t;
      });
  return static_cast<size_t>(at - samples_.begin());
}

std::optional<int64_t> Odometry::SampleFrom(int64_t time_ns) const {
  const size_t from = FirstFrom(time_ns);
  if (from == samples_.size()) return std::nullopt;
  return samples_[from].time_ns;
}

std::optional<int64_t> Odometry::SampleBefore(int64_t time_ns) const {
  const size_t from = FirstFrom(time_ns);
  if (from == 0) return std::nullopt;
  return samples_[from - 1].time_ns;
}

bool Odometry::Covers(int64_t begin_ns, int64_t end_ns) const {
  if (samples_.empty() || begin_ns < samples_.front().time_ns ||
      end_ns > samples_.back().time_ns) {
    return false;
  }
  // A gap counts where the motion reaches into it.
  const size_t last = FirstFrom(end_ns);
  const auto gap = std::find_if(gap_ends_.begin(), gap_ends_.end(), [&](size_t after) {
    return samples_[after].time_ns > begin_ns;
  });
  return gap == gap_ends_.end() || *gap > last;
}

OdometrySample Odometry::At(int64_t time_ns) const {
  const size_t after = FirstFrom(time_ns);
  if (after == 0 || samples_[after].time_ns == time_ns) return samples_[after];
  const OdometrySample& a = samples_[after - 1];
  const OdometrySample& b = samples_[after];
  const double share =
      SecondsBetween(a.time_ns, time_ns) / SecondsBetween(a.time_ns, b.time_ns);
  return {time_ns,
          a.position + share * (b.position - a.position),
          a.heading + share * (b.heading - a.heading)};
}

std::optional<PlanarMotion> Odometry::Between(int64_t begin_ns, int64_t end_ns) const {
  if (!Covers(begin_ns, end_ns)) return std::nullopt;
  const OdometrySample begin = At(begin_ns);
  const OdometrySample end = At(end_ns);
  return PlanarMotion{Eigen::Rotation2Dd(-begin.heading) * (end.position - begin.position),
                      end.heading - begin.heading};
}

}  // namespace plumbline
