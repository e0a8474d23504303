#include "core/judging/nodding.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "core/judging/levels.h"
#include "core/util/quantiles.h"
#include "core/util/time.h"

namespace plumbline {
namespace {

// A range by sector of a turn.
using Sectors = std::array<float, 48>;

// The middle one of the ranges of each sector; NaN where none has an echo.
Sectors SectorsOf(const ScanLine& line) {
  std::array<std::vector<float>, std::tuple_size_v<Sectors>> ranges;
  for (int beam = 0; beam < line.num_beams(); ++beam) {
    const float range = line.ranges[static_cast<size_t>(beam)];
    if (!std::isfinite(range)) continue;
    const double turns = line.BeamAngle(beam) / (2.0 * M_PI);
    const auto sector =
        static_cast<size_t>((turns - std::floor(turns)) * static_cast<double>(ranges.size()));
    ranges[std::min(sector, ranges.size() - 1)].push_back(range);
  }
  Sectors sectors;
  for (size_t i = 0; i < sectors.size(); ++i) {
    sectors[i] = std::numeric_limits<float>::quiet_NaN();
    if (ranges[i].empty()) continue;
    const auto middle = ranges[i].begin() + static_cast<std::ptrdiff_t>(ranges[i].size() / 2);
    std::nth_element(ranges[i].begin(), middle, ranges[i].end());
    sectors[i] = *middle;
  }
  return sectors;
}

// By how much a range has changed, as a share of it; a half where it is another surface's, or
// an echo comes or goes.
double Change(float before, float after) {
  const double other = 0.5;
  if (std::isnan(before) || std::isnan(after)) {
    return std::isnan(before) == std::isnan(after) ? 0.0 : other;
  }
  return std::min(other, std::abs(std::log(static_cast<double>(after / before))));
}

// The mean change over the directions with an echo in either line; NaN where there are hardly
// any.
double MeanChange(const Sectors& before, const Sectors& after) {
  int count = 0;
  double sum = 0.0;
  for (size_t i = 0; i < before.size(); ++i) {
    if (std::isnan(before[i]) && std::isnan(after[i])) continue;
    ++count;
    sum += Change(before[i], after[i]);
  }
  return 4 * count < static_cast<int>(before.size()) ? std::nan("") : sum / count;
}

class NodSearch {
 public:
  explicit NodSearch(const std::vector<ScanLine>& lines) {
    std::vector<double> periods_s;
    for (const ScanLine& line : lines) {
      if (!stamps_.empty()) periods_s.push_back(SecondsBetween(stamps_.back(), line.stamp_ns));
      stamps_.push_back(line.stamp_ns);
      sectors_.push_back(SectorsOf(line));
    }
    if (!periods_s.empty()) line_period_s_ = Median(std::move(periods_s));
  }

  std::optional<Nod> Find() const {
    if (line_period_s_ <= 0.0) return std::nullopt;
    std::vector<Candidate> candidates;
    double best = 0.0;
    const int most = static_cast<int>(8.0 / line_period_s_);
    for (int half = 2; 2 * half <= most; ++half) {
      const Candidate candidate = Judge(half);
      if (!candidate.is_significant) continue;
      candidates.push_back(candidate);
      best = std::max(best, candidate.changed - candidate.returned);
    }
    // Ranges come back after three periods as well.
    const auto first =
        std::find_if(candidates.begin(), candidates.end(), [best](const Candidate& candidate) {
          return candidate.changed - candidate.returned > 0.8 * best;
        });
    if (first == candidates.end()) return std::nullopt;
    auto peak = first;
    for (auto next = first; next != candidates.end() && next->half <= first->half * 5 / 4;
         ++next) {
      if (next->changed - next->returned > peak->changed - peak->returned) peak = next;
    }
    return Nod{PeriodAt(candidates, *peak), AxisAt(peak->half), peak->changed, peak->returned};
  }

 private:
  // A half period, in line periods.
  struct Candidate {
    int half = 0;
    double changed = 0.0;
    double returned = 0.0;
    bool is_significant = false;
  };

  // The line that many line periods after another; -1: there is none.
  int LineAfter(size_t line, int num_periods) const {
    const int64_t at_ns = stamps_[line] + NanosecondsFromSeconds(num_periods * line_period_s_);
    const auto next = std::lower_bound(
        stamps_.begin(), stamps_.end(), at_ns - NanosecondsFromSeconds(0.5 * line_period_s_));
    if (next == stamps_.end() ||
        *next > at_ns + NanosecondsFromSeconds(0.5 * line_period_s_)) {
      return -1;
    }
    return static_cast<int>(next - stamps_.begin());
  }

  Candidate Judge(int half) const {
    Candidate candidate;
    candidate.half = half;
    double sum = 0.0;
    double squares = 0.0;
    int count = 0;
    for (size_t i = 0; i < stamps_.size(); ++i) {
      const int middle = LineAfter(i, half);
      const int end = LineAfter(i, 2 * half);
      if (middle < 0 || end < 0) continue;
      const double changed = MeanChange(sectors_[i], sectors_[static_cast<size_t>(middle)]);
      const double returned = MeanChange(sectors_[i], sectors_[static_cast<size_t>(end)]);
      if (std::isnan(changed) || std::isnan(returned)) continue;
      candidate.changed += changed;
      candidate.returned += returned;
      sum += changed - returned;
      squares += (changed - returned) * (changed - returned);
      ++count;
    }
    // What is seen in one period says one thing.
    const double num_periods = static_cast<double>(count) / (2.0 * half);
    if (num_periods < 3.0) return candidate;
    candidate.changed /= count;
    candidate.returned /= count;
    const double mean = sum / count;
    const double stddev = std::sqrt(std::max(0.0, squares / count - mean * mean));
    // A rig that sways by a few degrees changes ranges by a few per cent.
    candidate.is_significant = candidate.changed > 0.1 &&
                               mean > 3.0 * stddev / std::sqrt(num_periods) &&
                               candidate.returned < 0.7 * candidate.changed;
    return candidate;
  }

  // The top of the parabola through the gains about the best half period.
  double PeriodAt(const std::vector<Candidate>& candidates, const Candidate& peak) const {
    const auto gain_at = [&](int half) {
      for (const Candidate& candidate : candidates) {
        if (candidate.half == half) return candidate.changed - candidate.returned;
      }
      return std::nan("");
    };
    const double before = gain_at(peak.half - 1);
    const double at = gain_at(peak.half);
    const double after = gain_at(peak.half + 1);
    const double bend = before + after - 2.0 * at;
    const double off = bend < 0.0 ? 0.5 * (before - after) / bend : 0.0;
    return 2.0 * (peak.half + off) * line_period_s_;
  }

  // The axis lies across the directions in which ranges change most: theirs is the second
  // harmonic of how often they do.
  double AxisAt(int half) const {
    std::array<double, std::tuple_size_v<Sectors>> changed = {};
    std::array<double, std::tuple_size_v<Sectors>> counts = {};
    for (size_t i = 0; i < stamps_.size(); ++i) {
      const int middle = LineAfter(i, half);
      if (middle < 0) continue;
      const Sectors& after = sectors_[static_cast<size_t>(middle)];
      for (size_t k = 0; k < counts.size(); ++k) {
        if (std::isnan(sectors_[i][k]) && std::isnan(after[k])) continue;
        counts[k] += 1.0;
        changed[k] += Change(sectors_[i][k], after[k]);
      }
    }
    // Least squares of a constant and the second harmonic, over the sectors that see anything.
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (size_t k = 0; k < counts.size(); ++k) {
      if (counts[k] == 0.0) continue;
      const double angle =
          2.0 * M_PI * (static_cast<double>(k) + 0.5) / static_cast<double>(counts.size());
      const Eigen::Vector3d row(1.0, std::cos(2.0 * angle), std::sin(2.0 * angle));
      normal += row * row.transpose();
      right += row * (changed[k] / counts[k]);
    }
    const Eigen::Vector3d harmonic = normal.ldlt().solve(right);
    return 0.5 * std::remainder(std::atan2(harmonic[2], harmonic[1]) + M_PI, 2.0 * M_PI);
  }

  std::vector<int64_t> stamps_;
  std::vector<Sectors> sectors_;
  double line_period_s_ = 0.0;
};

}  // namespace

std::optional<Nod> FindNod(const std::vector<ScanLine>& lines) {
  return NodSearch(lines).Find();
}

bool IsOfRig(const Nod& nod,
             const std::vector<ScanLine>& lines,
             const Scanner& scanner,
             const Imu& imu,
             const ImuReadings& readings) {
  const Eigen::Vector3d axis_imu =
      imu.body_from_imu.rotation.conjugate() *
      (scanner.body_from_scanner.rotation *
       Eigen::Vector3d(std::cos(nod.axis_rad), std::sin(nod.axis_rad), 0.0));
  const double half_s = 0.5 * nod.period_s;
  std::vector<double> turns_rad;
  for (const ScanLine& line : lines) {
    const ImuMean mean =
        readings.MeanOf(line.stamp_ns, line.stamp_ns + NanosecondsFromSeconds(half_s));
    if (mean.num_samples == 0) continue;
    turns_rad.push_back(half_s * std::abs(axis_imu.dot(mean.angular_rate)));
  }
  return !turns_rad.empty() && Median(std::move(turns_rad)) > kParallelAngle;
}

}  // namespace plumbline
