#include "core/judging/header_search.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "core/geometry/angles.h"
#include "core/judging/levels.h"
#include "core/judging/words.h"
#include "core/util/quantiles.h"

namespace plumbline {
namespace {

using Sample = std::vector<std::vector<SampledLine>>;

// A header is accepted if the share of places that agree grows by kHardlyAny, and by
// kSignificantStddevs of its standard deviations: neighbouring lines share their errors.
// time_increment is another where it differs by this much from that of a scanner which turns
// once per scan line.
constexpr double kOtherTime = 0.2;

struct Places {
  size_t num = 0;
  double near_share = 0.0;
};

Places CompareAll(const Sample& sample, const MountedRig& rig) {
  std::vector<ViewComparison> all;
  for (size_t a = 0; a < rig.size(); ++a) {
    for (size_t b = a + 1; b < rig.size(); ++b) {
      const auto some = CompareViews(sample, rig, a, b, kComparedLines, kOnePlace);
      all.insert(all.end(), some.begin(), some.end());
    }
  }
  return {all.size(), ShareWithin(all, kOnePlace)};
}

// The angles between beams, `ratio` times as large.
SampledLine Stretched(SampledLine line, double ratio) {
  const auto stretch = [&](Eigen::Vector2d* p) {
    const double turn = 2.0 * M_PI;
    double angle = std::atan2(p->y(), p->x()) - line.angle_min;
    if (line.angle_increment < 0.0) angle = -angle;
    angle -= turn * std::floor(angle / turn);
    const double more = (ratio - 1.0) * (line.angle_increment < 0.0 ? -angle : angle);
    *p = Eigen::Rotation2Dd(more) * *p;
  };
  for (SampledSegment& segment : line.segments) {
    stretch(&segment.start);
    stretch(&segment.end);
  }
  line.angle_increment *= ratio;
  return line;
}

// An other header of a topic: what becomes of a line and of the rig file, and in words.
struct Alternative {
  std::function<SampledLine(const SampledLine&)> change;
  std::function<void(Scanner*)> state;
  std::string words;   // after "of left and right"
  std::string advice;  // after "in the rig file: "
};

std::vector<Alternative> AlternativesOf(const TopicSurvey& topic) {
  std::vector<Alternative> alternatives;
  const double num_beams = topic.num_beams;
  if (num_beams < 3) return alternatives;
  for (const double ratio : {(num_beams - 1.0) / num_beams, num_beams / (num_beams - 1.0)}) {
    const double increment = ratio * topic.angle_increment;
    alternatives.push_back(
        {[ratio](const SampledLine& line) { return Stretched(line, ratio); },
         [increment](Scanner* scanner) { scanner->angle_increment_rad = increment; },
         std::string("angle_increment is too ") + (ratio < 1.0 ? "large" : "small") +
             " by one beam's share",
         "angle_increment_deg: " + Decimal(increment * kDegreesPerRadian, 6)});
  }
  const double stated_s = topic.time_increment_s;
  const double turning_s = topic.period_s * std::abs(topic.angle_increment) / (2.0 * M_PI);
  if (turning_s > 0.0 && std::abs(stated_s / turning_s - 1.0) > kOtherTime) {
    alternatives.push_back(
        {[turning_s](const SampledLine& line) {
           SampledLine other = line;
           other.time_increment_s = turning_s;
           return other;
         },
         [turning_s](Scanner* scanner) { scanner->time_increment_s = turning_s; },
         std::string("time_increment is ") + (stated_s == 0.0 ? "0" : "wrong") +
             ": the scanner turns once per scan line",
         "time_increment_s: " + Decimal(turning_s, 9)});
  }
  if (stated_s > 0.0) {
    const double last_s = (num_beams - 1.0) * stated_s;
    alternatives.push_back({[last_s](const SampledLine& line) {
                              SampledLine other = line;
                              other.stamp_ns += NanosecondsFromSeconds(last_s);
                              other.time_increment_s = -line.time_increment_s;
                              return other;
                            },
                            [stated_s, last_s](Scanner* scanner) {
                              scanner->time_increment_s = -stated_s;
                              scanner->time_offset_s += last_s;
                            },
                            "beams are given the other way round than they are measured",
                            "time_increment_s: " + Decimal(-stated_s, 9) +
                                ", time_offset_s: " + Decimal(last_s, 6)});
    alternatives.push_back(
        {[last_s](const SampledLine& line) {
           SampledLine other = line;
           other.stamp_ns -= NanosecondsFromSeconds(last_s);
           return other;
         },
         [last_s](Scanner* scanner) { scanner->time_offset_s -= last_s; },
         "stamps are those of the last beam, " + Decimal(1e3 * last_s, 0) + " ms too late",
         "time_offset_s: " + Decimal(-last_s, 6)});
  }
  return alternatives;
}

}  // namespace

Rig WithHeaders(Rig rig, const OtherHeader& headers) {
  for (const Scanner& stated : headers.scanners) {
    for (Scanner& scanner : rig.scanners) {
      if (scanner.name == stated.name) scanner = stated;
    }
  }
  return rig;
}

size_t NumPlaces(const Sample& sample, const MountedRig& rig) {
  return CompareAll(sample, rig).num;
}

double NearShareOfAll(const Sample& sample, const MountedRig& rig) {
  return CompareAll(sample, rig).near_share;
}

double SignificantDifference(double share_a, double share_b, size_t num_places) {
  const double variance = share_a * (1.0 - share_a) + share_b * (1.0 - share_b);
  return kSignificantStddevs * std::sqrt(variance / static_cast<double>(num_places));
}

std::optional<OtherHeader> FindOtherHeader(const Sample& sample,
                                           const std::vector<TopicSurvey>& topics,
                                           const MountedRig& rig,
                                           const std::vector<Scanner>& scanners) {
  const Places stated = CompareAll(sample, rig);
  if (stated.num == 0) return std::nullopt;
  const double variance =  // of the share
      stated.near_share * (1.0 - stated.near_share) / static_cast<double>(stated.num);
  const double min_gain = std::max(kHardlyAny, kSignificantStddevs * std::sqrt(variance));
  std::optional<OtherHeader> best;
  std::vector<std::vector<size_t>> groups(1);  // all at once, and each
  for (size_t i = 0; i < rig.size(); ++i) {
    groups.front().push_back(i);
    groups.push_back({i});
  }
  for (const std::vector<size_t>& group : groups) {
    const std::vector<Alternative> of_first = AlternativesOf(topics[rig[group[0]].source]);
    for (size_t k = 0; k < of_first.size(); ++k) {
      OtherHeader other;
      other.sample = sample;
      std::vector<std::string> who;
      std::vector<std::string> advice;
      for (const size_t scanner : group) {
        const size_t source = rig[scanner].source;
        const std::vector<Alternative> own = AlternativesOf(topics[source]);
        if (k >= own.size() || own[k].words != of_first[k].words) continue;
        std::transform(sample[source].begin(),
                       sample[source].end(),
                       other.sample[source].begin(),
                       own[k].change);
        other.scanners.push_back(scanners[scanner]);
        own[k].state(&other.scanners.back());
        who.push_back(scanners[scanner].name);
        advice.push_back(own[k].advice);
      }
      const Places so = CompareAll(other.sample, rig);
      other.share_as_stated = stated.near_share;
      other.share_so = so.near_share;
      if (so.num < stated.num / 2 || so.near_share - stated.near_share < min_gain) continue;
      if (best && so.near_share <= best->share_so + kHardlyAny) continue;
      const bool is_same = std::all_of(
          advice.begin(), advice.end(), [&](const auto& one) { return one == advice[0]; });
      other.words = of_first[k].words + ", of " + Enumerate(who);
      other.advice = "in the rig file, for " + Enumerate(who) + ": " +
                     (is_same ? advice[0] : Enumerate(advice));
      best = std::move(other);
    }
  }
  return best;
}

}  // namespace plumbline
