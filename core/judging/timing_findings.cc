#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/geometry/angles.h"
#include "core/judging/findings.h"
#include "core/judging/levels.h"
#include "core/judging/words.h"
#include "core/options/mapper_options.h"
#include "core/util/date.h"
#include "core/util/quantiles.h"
#include "core/util/time.h"

namespace plumbline {
namespace {

constexpr double kMinGap = 0.5;          // s, in which a walking rig leaves what it has seen
constexpr double kGapPeriods = 10.0;     // slow scanners may lose some scan lines
constexpr double kMinAbsence = 1.0;      // s, at begin and end; drivers start one by one
constexpr double kMaxClockApart = 0.25;  // s, between topics
constexpr double kSlowRate = 5.0;        // Hz
constexpr double kTurnsShare = 0.5;      // of these

// How far the recorder's clock is ahead of the stamps, the median, s.
double DelayOf(const TopicSurvey& topic) {
  std::vector<double> delays_s;
  for (const LineStamp& stamp : topic.stamps) {
    delays_s.push_back(SecondsBetween(stamp.stamp_ns, stamp.receipt_ns));
  }
  return Median(std::move(delays_s));
}

// A stretch without scan lines, in seconds since the recording's start.
struct Gap {
  double start_s = 0.0;
  double end_s = 0.0;
};

// The gaps in which no topic has anything.
std::vector<Gap> CommonGaps(const RecordingSurvey& survey) {
  std::vector<int64_t> receipts_ns;
  double period_s = 0.0;
  for (const TopicSurvey& topic : survey.topics) {
    period_s = std::max(period_s, topic.period_s);
    for (const LineStamp& stamp : topic.stamps) receipts_ns.push_back(stamp.receipt_ns);
  }
  std::sort(receipts_ns.begin(), receipts_ns.end());
  const double limit_s = std::max(kMinGap, kGapPeriods * period_s);
  std::vector<Gap> gaps;
  for (size_t i = 1; i < receipts_ns.size(); ++i) {
    const Gap gap = {SecondsBetween(survey.start_receipt_ns, receipts_ns[i - 1]),
                     SecondsBetween(survey.start_receipt_ns, receipts_ns[i])};
    if (gap.end_s - gap.start_s > limit_s) gaps.push_back(gap);
  }
  return gaps;
}

// Tells what is wrong with the stamps of one topic.
class StampJudge {
 public:
  // common_gaps: of all topics, which are told by themselves.
  StampJudge(const TopicSurvey& topic,
             int64_t start_receipt_ns,
             const std::vector<Gap>& common_gaps,
             std::vector<Finding>* findings)
      : topic_(topic),
        start_receipt_ns_(start_receipt_ns),
        common_gaps_(common_gaps),
        findings_(findings) {}

  void Judge() {
    const size_t first = findings_->size();
    JudgeUnread();
    JudgePassedOver();
    for (size_t i = first; i < findings_->size(); ++i) {
      (*findings_)[i].is_told_by_reader = true;
    }
    if (topic_.stamps.size() >= kMinSteps) {
      JudgeSharing();
      JudgeOrder();
      JudgeGaps();
      JudgeBeamTimes();
      return;
    }
    if (topic_.stamps.empty() &&
        (topic_.num_off_plane > 0 || topic_.passed_over.unusable.count > 0)) {
      return;  // told
    }
    const bool is_repeating = topic_.passed_over.repeated.count > 0;
    Add(Severity::kStop,
        is_repeating ? "the header stamps do not count up: most repeat the one before"
                     : "only " + std::to_string(topic_.stamps.size()) + " scan lines",
        is_repeating ? "let the driver stamp each scan line with the instant of its first beam"
                     : "check that the scanner runs and that its topic is recorded",
        Subject::kClock,
        is_repeating);
  }

 private:
  // Scanners that share a topic, which no order of their lines can part.
  void JudgeSharing() {
    const bool takes_turns = topic_.num_compared >= kMinPlaces &&
                             topic_.num_alternating > kTurnsShare * topic_.num_compared;
    if (topic_.frames.size() < 2 && !takes_turns) return;
    Add(Severity::kStop,
        topic_.frames.size() > 1
            ? "the scan lines are of " + std::to_string(topic_.frames.size()) +
                  " scanners, by the frames in their headers: " + Enumerate(topic_.frames)
            : "the scan lines are of two scanners that take turns: " +
                  PercentOf(static_cast<double>(topic_.num_alternating) /
                            topic_.num_compared) +
                  " are unlike the one before, but like the one before that",
        "give each scanner a topic of its own",
        Subject::kHeader,
        true);
  }

  void JudgeUnread() {
    if (topic_.num_off_plane > 0) {
      Add(topic_.stamps.empty() ? Severity::kStop : Severity::kWarning,
          Count(topic_.num_off_plane, "message is", "messages are") +
              " passed over: the points do not lie in one scan plane, z = 0 in their frame " +
              (topic_.frames.empty() ? "" : topic_.frames.front()),
          "record the points in the scanner's own frame, before anything transforms them",
          Subject::kHeader);
    }
    if (topic_.passed_over.unusable.count > 0) {
      Add(topic_.stamps.empty() ? Severity::kStop : Severity::kWarning,
          Count(topic_.passed_over.unusable.count, "scan line is", "scan lines are") +
              " passed over: " + topic_.unusable_reason,
          "look at angle_min, angle_increment and time_increment of the driver; the rig file "
          "may replace them (angle_min_deg, angle_increment_deg, time_increment_s)",
          Subject::kHeader);
    }
    if (topic_.num_undecodable > 0) {
      Add(Severity::kWarning,
          std::to_string(topic_.num_undecodable) + " messages can not be decoded",
          "record again, or accept the loss");
    }
  }

  void Add(Severity severity,
           const std::string& sentence,
           const std::string& advice,
           Subject about = Subject::kClock,
           bool moves_places = false) {
    findings_->push_back({severity, topic_.name, sentence, advice, about, moves_places});
  }
  static std::string Count(int count, const std::string& one, const std::string& many) {
    return std::to_string(count) + " " + (count == 1 ? one : many);
  }
  std::string At(const LineStamp& stamp) const {
    return "at " + Decimal(SecondsBetween(start_receipt_ns_, stamp.receipt_ns), 1) + " s";
  }

  // The lines that the mapper passes over or sorts, each for its reason.
  void JudgePassedOver() {
    const PassedOverLines& lines = topic_.passed_over;
    if (lines.repeated.count > 0) {
      Add(Severity::kWarning,
          Count(lines.repeated.count, "scan line has", "scan lines have") +
              " the stamp of the one before; passed over",
          "look for a driver that sends twice, or for a coarse clock");
    }
    if (lines.jumped.count > 0) {
      Add(Severity::kWarning,
          Count(lines.jumped.count,
                "scan line has a stamp that jumps",
                "scan lines have stamps that jump") +
              " against the others; passed over",
          "set the scanner's clock before recording, not while; no time server that steps");
    }
    if (lines.apart.count > 0) {
      Add(Severity::kWarning,
          Count(lines.apart.count, "scan line has a stamp", "scan lines have stamps") +
              " apart from all others, such as " + FormatDate(lines.apart.first_ns) +
              "; passed over: the clock was not set when they were taken",
          "start recording once the scanner's clock is set");
    }
    if (topic_.num_receipts_off > 0) {
      Add(Severity::kWarning,
          Count(topic_.num_receipts_off, "scan line was", "scan lines were") +
              " received, by the recorder's clock, more than an hour away from their stamps",
          "set the recorder's clock before recording");
    }
    if (topic_.num_out_of_turn > 0) {
      Add(Severity::kNote,
          Count(topic_.num_out_of_turn, "scan line came", "scan lines came") +
              " after one with a later stamp; they are sorted by their stamps",
          "");
    }
  }

  void JudgeOrder() {
    int num_steps = 0;
    const LineStamp* first_step = nullptr;
    double largest_step_s = 0.0;
    for (size_t i = 1; i < topic_.stamps.size(); ++i) {
      const LineStamp& before = topic_.stamps[i - 1];
      const LineStamp& now = topic_.stamps[i];
      const double step_s = SecondsBetween(before.stamp_ns, now.stamp_ns) -
                            SecondsBetween(before.receipt_ns, now.receipt_ns);
      if (std::abs(step_s) < std::max(kMaxClockApart, 3.0 * topic_.period_s)) continue;
      if (num_steps++ == 0) first_step = &now;
      if (std::abs(step_s) > std::abs(largest_step_s)) largest_step_s = step_s;
    }
    if (num_steps > 0) {
      Add(Severity::kWarning,
          "the clock of the stamps jumps against the recorder's " + std::to_string(num_steps) +
              (num_steps == 1 ? " time, by " : " times, by up to ") +
              Decimal(largest_step_s, 2) + " s, " + At(*first_step),
          "set the clock before recording; look for messages that were held up",
          Subject::kClock,
          num_steps > 0);
    }
  }

  bool IsCommon(const LineStamp& before, const LineStamp& after) const {
    const double start_s = SecondsBetween(start_receipt_ns_, before.receipt_ns);
    const double end_s = SecondsBetween(start_receipt_ns_, after.receipt_ns);
    return std::any_of(common_gaps_.begin(), common_gaps_.end(), [&](const Gap& gap) {
      return std::min(end_s, gap.end_s) - std::max(start_s, gap.start_s) >
             0.8 * (end_s - start_s);
    });
  }

  void JudgeGaps() {
    const double limit_s = std::max(kMinGap, kGapPeriods * topic_.period_s);
    int num_gaps = 0;
    double longest_s = 0.0;
    std::string first_gap;
    int num_lost = 0;
    for (size_t i = 1; i < topic_.stamps.size(); ++i) {
      const double apart_s =
          SecondsBetween(topic_.stamps[i - 1].stamp_ns, topic_.stamps[i].stamp_ns);
      if (apart_s > limit_s) {
        if (IsCommon(topic_.stamps[i - 1], topic_.stamps[i])) continue;
        if (num_gaps++ == 0) first_gap = At(topic_.stamps[i - 1]).substr(3) + " on";
        longest_s = std::max(longest_s, apart_s);
      } else if (apart_s > 1.5 * topic_.period_s) {
        num_lost += static_cast<int>(std::lround(apart_s / topic_.period_s)) - 1;
      }
    }
    if (num_gaps > 0) {
      Add(Severity::kWarning,
          num_gaps == 1
              ? "sends nothing for " + Decimal(longest_s, 1) + " s, from " + first_gap
              : "has " + std::to_string(num_gaps) + " gaps of up to " + Decimal(longest_s, 1) +
                    " s, the first from " + first_gap,
          "look for a loose cable or a network or disk that can not keep up");
    }
    const double lost_share =
        num_lost / (static_cast<double>(topic_.stamps.size()) + static_cast<double>(num_lost));
    if (lost_share > kHardlyAny) {
      Add(Severity::kWarning,
          "about " + PercentOf(lost_share) +
              " of the scan lines are missing, one or a few at a time: the usual time between "
              "two is " +
              Decimal(1e3 * topic_.period_s, 0) + " ms",
          "look for a network or disk that can not keep up");
    }
    if (topic_.period_s > 1.0 / kSlowRate) {
      Add(Severity::kWarning,
          "only " + Decimal(1.0 / topic_.period_s, 1) + " scan lines a second",
          "move slowly, or let the scanner turn faster");
    }
  }

  void JudgeBeamTimes() {
    const double line_s = topic_.time_increment_s * topic_.num_beams;
    const double turn = 2.0 * M_PI;
    if (topic_.time_increment_s == 0.0) {
      const double whole_s =
          topic_.period_s * std::min(1.0, topic_.field_of_view_rad() / turn);
      Add(Severity::kWarning,
          "time_increment is 0: all beams of a scan line count as measured at once, while the "
          "scanner takes up to " +
              Decimal(1e3 * whole_s, 0) + " ms for them",
          "let the driver fill in time_increment: " +
              Decimal(1e6 * whole_s / std::max(1, topic_.num_beams), 1) +
              " microseconds if the scanner turns once per scan line",
          Subject::kHeader,
          true);
      findings_->back().is_told_by_reader = true;
    } else if (line_s > 1.05 * topic_.period_s) {
      Add(Severity::kWarning,
          "the beams of a scan line would take " + Decimal(1e3 * line_s, 1) +
              " ms, but the next line begins after " + Decimal(1e3 * topic_.period_s, 1) +
              " ms",
          "time_increment is too large, or every second line is missing from angle_increment: "
          "look at the driver",
          Subject::kHeader,
          true);
    } else if (line_s < 0.5 * topic_.period_s * topic_.field_of_view_rad() / turn) {
      Add(Severity::kNote,
          "the beams of a scan line take " + Decimal(1e3 * line_s, 1) +
              " ms; a scanner that "
              "turns once in " +
              Decimal(1e3 * topic_.period_s, 1) + " ms would take " +
              Decimal(1e3 * topic_.period_s * topic_.field_of_view_rad() / turn, 1) + " ms",
          "right where lines were thinned out; else look at time_increment");
    }
  }

  const TopicSurvey& topic_;
  int64_t start_receipt_ns_;
  const std::vector<Gap>& common_gaps_;
  std::vector<Finding>* findings_;
};

// Topics that begin late or end early.
void FindAbsences(CheckReport* report) {
  const RecordingSurvey& survey = report->survey;
  for (const TopicSurvey& topic : survey.topics) {
    if (topic.stamps.size() < kMinSteps) continue;
    const double limit_s = std::max(kMinAbsence, kGapPeriods * topic.period_s);
    const double late_s =
        SecondsBetween(survey.start_receipt_ns, topic.stamps.front().receipt_ns);
    const double early_s =
        SecondsBetween(topic.stamps.back().receipt_ns, survey.end_receipt_ns);
    if (late_s > limit_s) {
      report->findings.push_back({Severity::kWarning,
                                  topic.name,
                                  "begins " + Decimal(late_s, 1) + " s after the others",
                                  "start recording when all scanners run"});
    }
    if (early_s > limit_s) {
      report->findings.push_back({Severity::kWarning,
                                  topic.name,
                                  "ends " + Decimal(early_s, 1) + " s before the others",
                                  "look for what stopped the scanner"});
    }
  }
}

// Clocks of the topics against each other, by way of the recorder's.
void FindClocksApart(CheckReport* report) {
  const TopicSurvey* least = nullptr;
  const TopicSurvey* most = nullptr;
  for (const TopicSurvey& topic : report->survey.topics) {
    if (topic.stamps.size() < kMinSteps) continue;
    if (least == nullptr || DelayOf(topic) < DelayOf(*least)) least = &topic;
    if (most == nullptr || DelayOf(topic) > DelayOf(*most)) most = &topic;
  }
  if (least == nullptr || least == most) return;
  const double apart_s = DelayOf(*most) - DelayOf(*least);
  if (apart_s < kMaxClockApart) return;
  report->findings.push_back({apart_s > 1.0 ? Severity::kStop : Severity::kWarning,
                              most->name,
                              "its stamps lie " + Decimal(apart_s, 2) + " s behind those of " +
                                  least->name +
                                  ", measured by when the recorder received them",
                              "let all scanners take their stamps from one clock, or state a "
                              "time_offset_s in the rig "
                              "file",
                              Subject::kClock,
                              true});
}

void TellCommonGaps(const std::vector<Gap>& gaps, CheckReport* report) {
  if (gaps.empty()) return;
  std::vector<std::string> words;
  const bool is_long = std::any_of(gaps.begin(), gaps.end(), [](const Gap& gap) {
    return gap.end_s - gap.start_s > MapperOptions().max_gap_s;
  });
  for (const Gap& gap : gaps) {
    if (words.size() == kMaxNamed) break;
    words.push_back("from " + Decimal(gap.start_s, 1) + " to " + Decimal(gap.end_s, 1) + " s");
  }
  const std::string more =
      gaps.size() > words.size()
          ? " and " + std::to_string(gaps.size() - words.size()) + " times more"
          : "";
  report->findings.push_back(
      {Severity::kWarning,
       "",
       "no scanner sends anything " + Enumerate(words) + more +
           (is_long
                ? ": the map will fall into parts, which are joined where the motion allows it"
                : ": the motion has to bridge that"),
       "record again without the gap, or stand still during it"});
}

}  // namespace

void FindTimingFaults(CheckReport* report) {
  const size_t first = report->findings.size();
  const std::vector<Gap> common_gaps = CommonGaps(report->survey);
  for (const TopicSurvey& topic : report->survey.topics) {
    StampJudge(topic, report->survey.start_receipt_ns, common_gaps, &report->findings).Judge();
  }
  FindClocksApart(report);
  const size_t first_told = report->findings.size();
  FindAbsences(report);
  TellCommonGaps(common_gaps, report);
  for (size_t i = first_told; i < report->findings.size(); ++i) {
    report->findings[i].is_told_by_reader = true;
  }
  for (size_t i = first; i < report->findings.size(); ++i) {
    Finding& finding = report->findings[i];
    if (finding.about == Subject::kRecording) finding.about = Subject::kClock;
  }
}

}  // namespace plumbline
