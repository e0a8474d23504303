#include "core/judging/topic_survey.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

#include "core/geometry/angles.h"
#include "core/judging/levels.h"
#include "core/judging/scanner_agreement.h"
#include "core/recording/messages.h"
#include "core/util/quantiles.h"
#include "core/util/time.h"

namespace plumbline {
namespace {

constexpr double kNear = 0.5;  // m, of returns that may be from the rig itself
constexpr size_t kMaxDeviations = 100'000;
constexpr size_t kComparedStride = 8;  // of the beams, between lines
// A scanner that moves differs more from the line before last than from the last.
constexpr float kUnlike = 3.0F;
constexpr double kMaxReceiptError = 3600.0;  // s, of a recorder whose clock was set
// Angle between beams beyond which scanners that smooth their ranges leave errors nearly
// independent.
constexpr double kTripleSpacing = 0.7 * kRadiansPerDegree;
// Bins of the histogram in a decade, from 1 mm to 1000 km.
constexpr int kBinsPerDecade = 50;
constexpr int kDecades = 9;
constexpr double kFirstBin = 1e-3;
// No scanner in a building has half of its returns beyond 40 m; in centimetres half of them
// are beyond 40 even in a closet, in millimetres beyond 400.
constexpr double kFarMedian = 40.0;
// Share of the beams with the very same largest range from which it stands for no return.
constexpr double kAtLimitShare = 0.005;

size_t HistogramBin(double range) {
  const double bin = kBinsPerDecade * std::log10(range / kFirstBin);
  return static_cast<size_t>(
      std::clamp(bin, 0.0, static_cast<double>(kBinsPerDecade * kDecades - 1)));
}

bool HaveOneLayout(const ScanLine& a, const ScanLine& b) {
  return a.num_beams() == b.num_beams() && std::abs(a.angle_min - b.angle_min) <= 1e-6 &&
         std::abs(a.angle_increment - b.angle_increment) <= 1e-9;
}

// The first message of those whose layout most share. A recording may begin amid a revolution.
const ScanMessage& MostCommonLayout(const std::vector<ScanMessage>& messages) {
  const auto num_alike = [&](const ScanMessage& one) {
    return std::count_if(messages.begin(), messages.end(), [&](const ScanMessage& other) {
      return HaveOneLayout(one.line, other.line);
    });
  };
  return *std::max_element(
      messages.begin(), messages.end(), [&](const ScanMessage& a, const ScanMessage& b) {
        return num_alike(a) < num_alike(b);
      });
}

}  // namespace

double TopicSurvey::duration_s() const {
  if (stamps.empty()) return 0.0;
  return SecondsBetween(stamps.front().stamp_ns, stamps.back().stamp_ns);
}

double TopicSurvey::field_of_view_rad() const {
  return std::max(0, num_beams - 1) * std::abs(angle_increment);
}

double TopicSurvey::RangeQuantile(double share) const {
  int64_t sum = 0;
  for (const int64_t count : histogram) sum += count;
  const double wanted = share * static_cast<double>(sum);
  int64_t below = 0;
  for (size_t bin = 0; bin < histogram.size(); ++bin) {
    below += histogram[bin];
    if (below > 0 && static_cast<double>(below) >= wanted) {
      return kFirstBin * std::pow(10.0, (static_cast<double>(bin) + 0.5) / kBinsPerDecade);
    }
  }
  return 0.0;
}

TopicSurveyor::TopicSurveyor(const RangeLimits* limits) : has_limits_(limits != nullptr) {
  if (has_limits_) survey_.limits = *limits;
  survey_.histogram.assign(kBinsPerDecade * kDecades, 0);
}

void TopicSurveyor::Add(const ScanMessage& message) {
  std::vector<std::string>& frames = survey_.frames;
  if (frames.size() < size_t{kMaxNamed} &&
      std::find(frames.begin(), frames.end(), message.frame_id) == frames.end()) {
    frames.push_back(message.frame_id);
  }
  if (!message.is_planar) {
    ++survey_.num_off_plane;
    return;
  }
  if (!message.usable) {
    if (unusable_.empty()) survey_.unusable_reason = message.unusable_reason;
    unusable_.push_back({message.line.stamp_ns, 0, false, message.receipt_ns});
    return;
  }
  lines_.push_back({{message.line.stamp_ns, message.receipt_ns}, {}});
  if (is_started_) {
    Take(message);
    return;
  }
  first_.push_back(message);
  if (first_.size() >= size_t{kMinPlaces}) DecideUnit();
}

// Decides the unit and what counts as a return, from the first lines, and takes these.
void TopicSurveyor::DecideUnit() {
  is_started_ = true;
  if (first_.empty()) return;
  std::vector<float> ranges;
  for (const ScanMessage& message : first_) {
    for (const float range : message.line.ranges) {
      if (std::isfinite(range) && range > 0.0F) ranges.push_back(range);
    }
  }
  const double median = Median(std::move(ranges));
  if (median > kFarMedian) survey_.metres_per_unit = median > 10.0 * kFarMedian ? 1e-3 : 1e-2;
  const ScanMessage& first = MostCommonLayout(first_);
  layout_ = first.line;
  survey_.num_beams = first.line.num_beams();
  survey_.angle_min = first.line.angle_min;
  survey_.angle_increment = first.line.angle_increment;
  survey_.time_increment_s = first.line.time_increment_s;
  survey_.stated_min_range_m = first.stated_min_range_m;
  survey_.stated_max_range_m = first.stated_max_range_m;
  if (!has_limits_ && first.stated_max_range_m > first.stated_min_range_m) {
    survey_.limits.min_m =
        std::max(survey_.limits.min_m, survey_.metres_per_unit * first.stated_min_range_m);
    // Many drivers give the stated limit itself where there is no return.
    survey_.limits.max_m = 0.999 * survey_.metres_per_unit * first.stated_max_range_m;
  }
  survey_.beams.resize(static_cast<size_t>(survey_.num_beams));
  for (const ScanMessage& message : first_) Take(message);
  first_.clear();
}

void TopicSurveyor::Take(const ScanMessage& message) {
  const ScanLine& line = message.line;
  SurveyedSecond* figures = &lines_[num_taken_++].figures;
  figures->num_lines = 1;
  const uint64_t fingerprint = FingerprintOf(line.ranges);
  if (fingerprint != 0 && fingerprint == last_fingerprint_) ++figures->num_repeated;
  last_fingerprint_ = fingerprint;
  if (!HaveOneLayout(line, layout_)) {
    ++survey_.num_other_layouts;
  }
  CompareWithBefore(line);
  TakeRanges(message, figures);
}

// Two scanners on one topic take turns.
void TopicSurveyor::CompareWithBefore(const ScanLine& line) {
  const std::vector<float>& now = line.ranges;
  if (now.size() == before_.size() && now.size() == two_before_.size()) {
    std::vector<float> to_before, to_two_before;
    for (size_t beam = 0; beam < now.size(); beam += kComparedStride) {
      const float one = std::abs(now[beam] - before_[beam]);
      const float two = std::abs(now[beam] - two_before_[beam]);
      if (!std::isfinite(one) || !std::isfinite(two)) continue;
      to_before.push_back(one);
      to_two_before.push_back(two);
    }
    if (to_before.size() >= size_t{kMinPlaces}) {
      ++survey_.num_compared;
      const float one = Median(std::move(to_before));
      const float two = Median(std::move(to_two_before));
      if (one > kUnlike * two) ++survey_.num_alternating;
    }
  }
  two_before_.swap(before_);
  before_ = now;
}

void TopicSurveyor::TakeRanges(const ScanMessage& message, SurveyedSecond* figures) {
  const ScanLine& line = message.line;
  const auto is_at_stated_limit = [&message](size_t beam) {
    return beam < message.is_at_stated_limit.size() && message.is_at_stated_limit[beam];
  };
  const auto spacing = std::max(
      1, static_cast<int>(std::lround(kTripleSpacing / std::abs(line.angle_increment))));
  const double twice_cosine = 2.0 * std::cos(spacing * line.angle_increment);
  const double unit = survey_.metres_per_unit;
  const RangeLimits limits = survey_.limits;
  const auto is_return = [&](double range) {
    return std::isfinite(range) && range > 0.0 && range >= limits.min_m &&
           range <= limits.max_m;
  };
  for (int beam = 0; beam < line.num_beams(); ++beam) {
    const auto at = static_cast<size_t>(beam);
    const double range = unit * static_cast<double>(line.ranges[at]);
    ++survey_.num_ranges;
    ++figures->num_beams;
    BeamCounts* counts = at < survey_.beams.size() ? &survey_.beams[at] : nullptr;
    if (counts != nullptr) ++counts->num_lines;
    if (std::isfinite(range) && range > 0.0) ++survey_.histogram[HistogramBin(range)];
    if (std::isfinite(range) && range >= survey_.largest_range_m) {
      if (range > survey_.largest_range_m) {
        survey_.num_largest = 0;
        for (BeamCounts& one : survey_.beams) one.num_largest = 0;
      }
      survey_.largest_range_m = range;
      ++survey_.num_largest;
      if (counts != nullptr) ++counts->num_largest;
    }
    if (is_return(range) && is_at_stated_limit(at)) {
      ++survey_.num_at_limit;
      continue;
    }
    if (!is_return(range)) {
      ++(std::isnan(range)       ? survey_.num_nan
         : !std::isfinite(range) ? survey_.num_infinite
         : range <= 0.0          ? survey_.num_zero
         : range < limits.min_m  ? survey_.num_too_near
                                 : survey_.num_too_far);
      continue;
    }
    ++survey_.num_returns;
    ++figures->num_returns;
    if (counts != nullptr) {
      ++counts->num_returns;
      if (range < kNear) {
        ++counts->num_near;
        counts->farthest_near_m = std::max(counts->farthest_near_m, static_cast<float>(range));
      }
    }
    if (beam < spacing || beam + spacing >= line.num_beams()) continue;
    const double before =
        unit * static_cast<double>(line.ranges[at - static_cast<size_t>(spacing)]);
    const double after =
        unit * static_cast<double>(line.ranges[at + static_cast<size_t>(spacing)]);
    if (!is_return(before) || !is_return(after)) continue;
    if (is_at_stated_limit(at - static_cast<size_t>(spacing)) ||
        is_at_stated_limit(at + static_cast<size_t>(spacing))) {
      continue;
    }
    // Along a straight line, 1 / range is a sinusoid of the angle.
    const double deviation = range - twice_cosine / (1.0 / before + 1.0 / after);
    ++figures->num_triples;
    if (std::abs(deviation) < 0.1 + 0.02 * range) ++figures->num_straight;
    if (num_triples_++ % int{kComparedStride} == 0 && deviations_m_.size() < kMaxDeviations) {
      deviations_m_.push_back(std::abs(deviation));
    }
  }
}

int64_t TopicSurveyor::Order() {
  if (!is_started_) DecideUnit();
  std::vector<ScanStamp> stamps = unusable_;
  std::vector<size_t> by_receipt(lines_.size());
  std::iota(by_receipt.begin(), by_receipt.end(), size_t{0});
  std::stable_sort(by_receipt.begin(), by_receipt.end(), [this](size_t a, size_t b) {
    return lines_[a].stamp.receipt_ns < lines_[b].stamp.receipt_ns;
  });
  for (const size_t index : by_receipt) {
    const LineStamp& stamp = lines_[index].stamp;
    stamps.push_back({stamp.stamp_ns, 0, true, stamp.receipt_ns});
  }
  Rig one;
  one.scanners.resize(1);
  const ScanOrder order = OrderScanLines(one, stamps, {survey_.unusable_reason});
  survey_.passed_over = order.passed_over.front();
  survey_.period_s = order.scan_period_s;
  size_t last = 0;
  for (const size_t position : order.positions) {
    if (position < last) ++survey_.num_out_of_turn;
    last = std::max(last, position);
    used_.push_back(by_receipt[position - unusable_.size()]);
  }
  CorrectReceipts();
  int64_t start_ns = std::numeric_limits<int64_t>::max();
  for (const size_t index : used_) {
    start_ns = std::min(start_ns, lines_[index].stamp.receipt_ns);
  }
  return start_ns;
}

void TopicSurveyor::CorrectReceipts() {
  std::vector<int64_t> delays_ns;
  for (const size_t index : used_) {
    delays_ns.push_back(lines_[index].stamp.receipt_ns - lines_[index].stamp.stamp_ns);
  }
  const int64_t usual_ns = Median(std::move(delays_ns));
  for (const size_t index : used_) {
    LineStamp& stamp = lines_[index].stamp;
    const int64_t expected_ns = stamp.stamp_ns + usual_ns;
    if (std::abs(SecondsBetween(expected_ns, stamp.receipt_ns)) < kMaxReceiptError) continue;
    stamp.receipt_ns = expected_ns;
    ++survey_.num_receipts_off;
  }
}

void TopicSurveyor::CountSeconds(int64_t start_receipt_ns) {
  std::map<int64_t, SurveyedSecond> seconds;  // a gap of years holds none
  for (const size_t index : used_) {
    const Line& line = lines_[index];
    const auto second =
        static_cast<int64_t>(SecondsBetween(start_receipt_ns, line.stamp.receipt_ns));
    SurveyedSecond& sum = seconds[second];
    sum.second = second;
    sum.num_lines += line.figures.num_lines;
    sum.num_repeated += line.figures.num_repeated;
    sum.num_beams += line.figures.num_beams;
    sum.num_returns += line.figures.num_returns;
    sum.num_triples += line.figures.num_triples;
    sum.num_straight += line.figures.num_straight;
  }
  for (const auto& [second, sum] : seconds) survey_.seconds.push_back(sum);
}

TopicSurvey TopicSurveyor::Finish(const RecordedTopic& topic, int64_t start_receipt_ns) {
  survey_.name = topic.name;
  survey_.type = topic.type;
  survey_.num_undecodable = topic.num_undecodable;
  for (const size_t index : used_) survey_.stamps.push_back(lines_[index].stamp);
  CountSeconds(start_receipt_ns);
  const auto largest = static_cast<double>(survey_.num_largest);
  if (survey_.num_at_limit == 0 && survey_.largest_range_m > 0.0 &&
      survey_.largest_range_m >= survey_.limits.min_m &&
      survey_.largest_range_m <= survey_.limits.max_m &&
      largest > kAtLimitShare * static_cast<double>(survey_.num_ranges) && largest > 20.0) {
    survey_.num_at_limit = survey_.num_largest;
    survey_.num_returns -= survey_.num_at_limit;
    for (BeamCounts& beam : survey_.beams) beam.num_returns -= beam.num_largest;
    survey_.limits.max_m = std::nextafter(survey_.largest_range_m, 0.0);
  }
  // Three tenths of the deviations, which edges and clutter leave alone, lie below 0.385
  // standard deviations; that of a deviation is sqrt(1.5) times a range's.
  survey_.noise_m = SampleQuantile(std::move(deviations_m_), 0.3) / (0.3853 * std::sqrt(1.5));
  return std::move(survey_);
}

}  // namespace plumbline
