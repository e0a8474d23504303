#include <algorithm>
#include <cmath>
#include <utility>

#include "core/geometry/angles.h"
#include "core/judging/findings.h"
#include "core/judging/levels.h"
#include "core/judging/scanner_agreement.h"
#include "core/judging/verdict_levels.h"
#include "core/judging/words.h"
#include "core/util/quantiles.h"

namespace plumbline {
namespace {

constexpr double kHighNoise = 1.5;  // times the stated one
constexpr double kLowNoise = 0.25;

const Scanner* ScannerOf(const CheckReport& report, size_t topic) {
  if (!report.rig) return nullptr;
  for (size_t i = 0; i < report.topics_of_scanners.size(); ++i) {
    if (report.topics_of_scanners[i] == static_cast<int>(topic))
      return &report.rig->scanners[i];
  }
  return nullptr;
}

bool SitAlike(const Rigid3d& a, const Rigid3d& b) {
  return (a.translation - b.translation).norm() < kOnePlace &&
         a.rotation.angularDistance(b.rotation) < kOnePlace / kLever;
}

// The largest of the values that do not exceed those of half the seconds with lines.
template <typename Value>
double UsualOf(const std::vector<SurveyedSecond>& seconds, const Value& value) {
  std::vector<double> values;
  for (const SurveyedSecond& second : seconds) values.push_back(value(second));
  return Median(std::move(values));
}

double StraightShare(const SurveyedSecond& second) {
  return second.num_triples == 0 ? 0.0
                                 : static_cast<double>(second.num_straight) /
                                       static_cast<double>(second.num_triples);
}

double ReturnShare(const SurveyedSecond& second) {
  return second.num_beams == 0
             ? 0.0
             : static_cast<double>(second.num_returns) / static_cast<double>(second.num_beams);
}

// Whether the ranges of a topic turned out to be in another unit, by what the others see.
// stated: its scanner in the rig file, nullptr where it has none.
bool IsRescaled(const CheckReport& report, size_t topic, const Scanner* stated) {
  if (!report.other_mounting) return false;
  const MountedRig& rig = report.other_mounting->rig;
  const double scale = stated == nullptr ? 1.0 : stated->range_scale;
  return std::any_of(rig.begin(), rig.end(), [&](const MountedScanner& scanner) {
    return scanner.source == topic && scanner.scale != scale;
  });
}

// Tells what is wrong with the ranges of one topic.
class RangeJudge {
 public:
  RangeJudge(const TopicSurvey& topic, const Scanner* scanner, std::vector<Finding>* findings)
      : topic_(topic), scanner_(scanner), findings_(findings) {}

  void Judge() {
    if (topic_.num_ranges == 0) return;  // told with the stamps
    JudgeUnit();
    if (topic_.num_returns == 0) {
      Add(Severity::kStop,
          "the scanner is dead: not one beam has a return between " +
              Decimal(topic_.limits.min_m, 2) + " and " + Decimal(topic_.limits.max_m, 1) +
              " m (" + KindsOfNoReturn() + ")",
          "look at the scanner's window, power and driver, or leave it out of the rig file");
      return;
    }
    JudgeReturns();
    JudgeSeconds();
    JudgeBeams();
    JudgeNoise();
    if (topic_.num_other_layouts > 0) {
      // A recording begins and ends amid a revolution.
      const bool are_few =
          topic_.num_other_layouts < kHardlyAny * static_cast<double>(topic_.stamps.size());
      Add(are_few ? Severity::kNote : Severity::kWarning,
          std::to_string(topic_.num_other_layouts) +
              " scan lines have other numbers of beams or angles than most",
          "do not change the scanner's settings while recording");
    }
  }

 private:
  void Add(Severity severity,
           const std::string& sentence,
           const std::string& advice,
           bool moves_places = false) {
    findings_->push_back(
        {severity, topic_.name, sentence, advice, Subject::kRanges, moves_places});
  }

  std::string KindsOfNoReturn() const {
    std::vector<std::string> kinds;
    const auto add = [&](int64_t count, const std::string& name) {
      const double share = static_cast<double>(count) / static_cast<double>(topic_.num_ranges);
      if (share > 0.0005) kinds.push_back(PercentOf(share) + " " + name);
    };
    add(topic_.num_nan, "NaN");
    add(topic_.num_infinite, "infinite");
    add(topic_.num_zero, "zero or negative");
    add(topic_.num_too_near, "nearer than " + Decimal(topic_.limits.min_m, 2) + " m");
    add(topic_.num_too_far, "farther than " + Decimal(topic_.limits.max_m, 1) + " m");
    add(topic_.num_at_limit, "exactly " + Decimal(topic_.largest_range_m, 3) + " m");
    return Enumerate(kinds);
  }

  void JudgeUnit() {
    if (topic_.metres_per_unit == 1.0) return;
    const bool is_mm = topic_.metres_per_unit == 1e-3;
    const std::string unit = is_mm ? "millimetres" : "centimetres";
    Add(Severity::kStop,
        "the ranges are given in " + unit + ": half of them exceed " +
            Decimal(topic_.RangeQuantile(0.5), 0) + " where metres belong",
        "let the driver divide by " + std::string(is_mm ? "1000" : "100") +
            "; sensor_msgs/LaserScan holds metres",
        true);
  }

  void JudgeReturns() {
    const double share =
        static_cast<double>(topic_.num_returns) / static_cast<double>(topic_.num_ranges);
    const std::string kinds = KindsOfNoReturn();
    if (share < 1.0 - kMost) {
      Add(Severity::kWarning,
          "only " + PercentOf(share) + " of the beams have a return (" + kinds + ")",
          "look at the scanner's window and at min_range_m and max_range_m");
    } else if (!kinds.empty()) {
      Add(Severity::kNote,
          PercentOf(1.0 - share) + " of the beams have no return: " + kinds,
          "");
    }
  }

  void JudgeSeconds() {
    const double usual_returns = UsualOf(topic_.seconds, ReturnShare);
    const double usual_straight = UsualOf(topic_.seconds, StraightShare);
    std::vector<int64_t> silent, frozen, random;
    for (const SurveyedSecond& second : topic_.seconds) {
      if (second.num_repeated > 1 && 2 * second.num_repeated > second.num_lines) {
        frozen.push_back(second.second);
      }
      if (ReturnShare(second) < kHardlyAnyShare * usual_returns) {
        silent.push_back(second.second);
      } else if (StraightShare(second) < kSome * usual_straight) {
        random.push_back(second.second);
      }
    }
    const std::string when_silent = SpansInWords(silent, size_t{kMinSilent});
    if (!when_silent.empty()) {
      Add(Severity::kWarning,
          "returns next to nothing " + when_silent,
          "look at the scanner's window and cable; the others have to bear it");
    }
    const std::string when_frozen = SpansInWords(frozen, 1);
    if (!when_frozen.empty()) {
      Add(Severity::kWarning,
          "is frozen: it repeats the very same ranges " + when_frozen,
          "restart the driver; cut these seconds out, or map without this scanner");
    }
    const std::string when_random = SpansInWords(random, size_t{kMinSilent});
    if (!when_random.empty()) {
      Add(Severity::kWarning,
          "measures nothing that continues from beam to beam " + when_random +
              ", as of a scanner that returns noise",
          "look for sunlight, another scanner that blinds it, or a broken one");
    }
    if (usual_straight < 1.0 - kMost) {
      Add(Severity::kStop,
          "hardly any beams continue a straight line (" + PercentOf(usual_straight) + ")",
          "the ranges are noise, or the beams are not in the order of their angles");
    }
  }

  std::string Degrees(size_t first, size_t last) const {
    const auto angle = [&](size_t beam) {
      return Decimal((topic_.angle_min + static_cast<double>(beam) * topic_.angle_increment) *
                         kDegreesPerRadian,
                     0);
    };
    return first == last ? "at " + angle(first) + " deg"
                         : "from " + angle(first) + " to " + angle(last) + " deg";
  }

  // Calls report(first, last) for each run of beams that satisfy a condition.
  template <typename Is, typename Report>
  void ForEachRun(const Is& is, const Report& report) const {
    for (size_t first = 0; first < topic_.beams.size(); ++first) {
      if (!is(topic_.beams[first])) continue;
      size_t last = first;
      while (last + 1 < topic_.beams.size() && is(topic_.beams[last + 1])) ++last;
      report(first, last);
      first = last;
    }
  }

  void JudgeBeams() {
    std::vector<std::string> sectors;
    ForEachRun(
        [](const BeamCounts& beam) {
          return beam.num_lines > 0 && beam.num_near > kMost * beam.num_lines;
        },
        [&](size_t first, size_t last) { sectors.push_back(Degrees(first, last)); });
    if (sectors.size() > kMaxNamed) sectors.resize(kMaxNamed);
    if (!sectors.empty()) {
      Add(Severity::kNote,
          "sees something nearer than 0.5 m in nearly every line " + Enumerate(sectors) +
              ": the rig itself, or who carries it",
          "set min_range_m beyond it");
    }
    std::vector<std::string> blind;
    ForEachRun([](const BeamCounts& beam) { return beam.num_returns == 0; },
               [&](size_t first, size_t last) {
                 const double width = static_cast<double>(last - first + 1) *
                                      std::abs(topic_.angle_increment) * kDegreesPerRadian;
                 if (width > kParallelAngle * kDegreesPerRadian)
                   blind.push_back(Degrees(first, last));
               });
    if (blind.size() > kMaxNamed) blind.resize(kMaxNamed);
    if (!blind.empty()) {
      Add(Severity::kNote,
          "never has a return " + Enumerate(blind),
          "something covers the window there, or nothing is within reach");
    }
  }

  void JudgeNoise() {
    if (scanner_ == nullptr || scanner_->estimates_noise || topic_.noise_m == 0.0) return;
    if (scanner_->range_noise_per_m2 > 0.0) return;  // it has no single figure
    const double ratio = topic_.noise_m / scanner_->range_noise_m;
    const std::string figures = "neighbouring beams show a noise of " +
                                Decimal(1e3 * topic_.noise_m, 0) + " mm, the rig file says " +
                                Decimal(1e3 * scanner_->range_noise_m, 0) + " mm";
    if (ratio > kHighNoise) {
      Add(Severity::kWarning,
          figures,
          "set range_noise_m to " + Decimal(topic_.noise_m, 3) +
              ": as it is, the map states itself more precise than it is");
    } else if (ratio < kLowNoise) {
      Add(Severity::kNote,
          figures,
          "right where it stands for uneven walls and mounting as well; else the map states "
          "itself less precise than it is");
    }
  }

  const TopicSurvey& topic_;
  const Scanner* scanner_;
  std::vector<Finding>* findings_;
};

}  // namespace

void FindRangeFaults(CheckReport* report) {
  for (const Doubling& doubling : report->doublings) {
    const Scanner* original = ScannerOf(*report, doubling.original);
    const Scanner* copy = ScannerOf(*report, doubling.copy);
    if (report->rig && (original == nullptr || copy == nullptr)) continue;
    const bool sit_alike = original == nullptr ||
                           (SitAlike(original->body_from_scanner, copy->body_from_scanner));
    report->findings.push_back(
        {sit_alike ? Severity::kWarning : Severity::kStop,
         report->survey.topics[doubling.copy].name,
         "repeats what " + report->survey.topics[doubling.original].name +
             " holds: " + PercentOf(doubling.share) +
             " of the ranges are the very same; with both, a map states itself more precise "
             "than it is",
         "leave one of them out of the rig file",
         Subject::kHeader,
         !sit_alike});
  }
  for (size_t i = 0; i < report->survey.topics.size(); ++i) {
    // The stated noise can not be held against ranges of another unit.
    const Scanner* stated = ScannerOf(*report, i);
    const Scanner* scanner = IsRescaled(*report, i, stated) ? nullptr : stated;
    RangeJudge(report->survey.topics[i], scanner, &report->findings).Judge();
  }
}

}  // namespace plumbline
