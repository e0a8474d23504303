#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <set>

#include "core/geometry/angles.h"
#include "core/judging/findings.h"
#include "core/judging/levels.h"
#include "core/judging/words.h"
#include "core/util/quantiles.h"
#include "core/util/time.h"

namespace plumbline {
namespace {

constexpr double kMaxLag = 1.0;    // s, by which wheels may be late or early
constexpr double kLagStep = 0.01;  // s

// A move of the body, in its frame at the begin, as a level scanner sees it and as the wheels
// count it.
struct CountedMove {
  int64_t begin_ns = 0;
  int64_t end_ns = 0;
  Eigen::Vector2d seen = Eigen::Vector2d::Zero();     // m
  Eigen::Vector2d counted = Eigen::Vector2d::Zero();  // m

  double Difference(double sign) const { return (seen - sign * counted).norm(); }
  // Whether the wheels count just this way, with the wrong sign. A move that is long enough to
  // be seen agrees with one sign at most.
  bool IsBackToFront() const { return Difference(-1.0) < std::min(kAgreed, Difference(1.0)); }
};

// The move of a scanner as the body's, seen from above.
Eigen::Vector2d MoveOfBody(const StepMove& step, const Rigid3d& body_from_scanner) {
  const Rigid3d move(
      Eigen::Quaterniond(Eigen::AngleAxisd(step.turn_rad, Eigen::Vector3d::UnitZ())),
      {step.move.x(), step.move.y(), 0.0});
  return (body_from_scanner * move * body_from_scanner.Inverse()).translation.head<2>();
}

// Tells whether the wheels turn when and as the level scanners see the rig turn, and go where
// the first of these sees it go.
class WheelJudge {
 public:
  WheelJudge(CheckReport* report, const Odometry& wheels) : report_(report), wheels_(wheels) {}

  void Judge() {
    JudgeTurns();
    JudgeWays();
  }

 private:
  void JudgeTurns() {
    CollectTurns();
    if (num_covered_ == 0 && num_seen_ > 0) {
      Add(Severity::kWarning,
          "the wheels say nothing of the time of the scan lines: their stamps are of another "
          "clock",
          "let both take their stamps from one clock, or state odometry: {time_offset_s: "
          "...}");
      return;
    }
    if (turns_.size() < size_t{kMinSteps}) return;
    double all = 0.0;
    for (const StepTurn& turn : turns_) all += std::abs(turn.turn_rad);
    const double as_stated = LeftOver(0.0, 1.0);
    double best_lag_s = 0.0;
    double best = as_stated;
    double best_mirrored = as_stated;
    double best_mirrored_lag_s = 0.0;
    for (double lag_s = -kMaxLag; lag_s < kMaxLag + 0.5 * kLagStep; lag_s += kLagStep) {
      const double left = LeftOver(lag_s, 1.0);
      const double left_mirrored = LeftOver(lag_s, -1.0);
      if (left_mirrored < best_mirrored) {
        best_mirrored = left_mirrored;
        best_mirrored_lag_s = lag_s;
      }
      if (left >= best) continue;
      best = left;
      best_lag_s = lag_s;
    }
    if (best_mirrored < kMost * all && IsBetter(best_mirrored_lag_s, -1.0, best_lag_s)) {
      Add(Severity::kStop,
          "the wheels turn the other way round than the scanners see the rig turn",
          "leave them out of the rig file, or let their driver count turns to the left");
    } else if (best > kMost * all) {
      Add(Severity::kStop,
          "the wheels do not turn as the scanners see the rig turn: " + PercentOf(best / all) +
              " of the turns are left",
          "leave them out of the rig file; their pose has to be in a frame with z up");
    } else if (IsBetter(best_lag_s, 1.0, 0.0)) {
      AddLag(best_lag_s);
    }
  }

  void JudgeWays() {
    const std::vector<CountedMove> moves = CollectMoves();
    if (moves.size() < size_t{kMinSteps}) return;
    std::vector<double> seen;
    std::vector<double> left;
    std::vector<double> left_mirrored;
    for (const CountedMove& move : moves) {
      seen.push_back(move.seen.norm());
      left.push_back(move.Difference(1.0));
      left_mirrored.push_back(move.Difference(-1.0));
    }
    const auto share = [&](const std::vector<double>& part) {
      return Median(part) / Median(seen);
    };
    const std::string spans = SpansInWords(SecondsBackToFront(moves), 1);
    const std::string leave_out = ", or leave them out of the rig file";
    if (share(left_mirrored) < kMost) {
      Add(Severity::kStop,
          "the wheels count the way ahead as a way back: scanners see the rig go the other "
          "way",
          "let their driver count the way ahead as positive, turn body_from_scanner by 180 "
          "degrees if the scanner looks back" +
              leave_out);
    } else if (!spans.empty()) {
      Add(Severity::kStop,
          spans +
              " the wheels count the way with the wrong sign: scanners see the rig go the "
              "other way",
          "let their driver count the way with its sign" + leave_out);
    } else if (share(left) > kMost) {
      Add(Severity::kStop,
          "the wheels do not go where the scanners see the rig go: " + PercentOf(share(left)) +
              " of the way is left",
          "look at the yaw of body_from_scanner and the unit of the wheels' way" + leave_out);
    }
  }

  void Add(Severity severity, const std::string& sentence, const std::string& advice) {
    report_->findings.push_back(
        {severity, report_->rig->odometry_topic, sentence, advice, Subject::kWheels});
  }

  void AddLag(double lag_s) {
    const std::string sentence =
        "the wheels are stamped about " + Decimal(std::abs(lag_s), 2) + " s too " +
        (lag_s > 0.0 ? "late" : "early") + ", by when they and the scanners turn";
    const std::optional<double>& stated_s = report_->rig->odometry_time_offset_s;
    if (!stated_s) {
      report_->wheels_late_s = lag_s;
      Add(Severity::kNote, sentence + "; that is taken into account", "");
    } else {
      Add(Severity::kWarning,
          sentence,
          "in the rig file: odometry: {time_offset_s: " + Decimal(*stated_s - lag_s, 2) +
              "}, or leave it out to have it found");
    }
  }

  // Whether the turns agree better with wheels that are late, or late and mirrored, than with
  // those that are late by another time, and not by chance.
  bool IsBetter(double lag_s, double sign, double other_lag_s) const {
    double sum = 0.0;
    double sum_squares = 0.0;
    for (const StepTurn& turn : turns_) {
      const double gain = std::abs(Difference(turn, other_lag_s, 1.0)) -
                          std::abs(Difference(turn, lag_s, sign));
      sum += gain;
      sum_squares += gain * gain;
    }
    return sum > kSignificantStddevs * std::sqrt(sum_squares);
  }

  // The turns of level scanners, as turns of the rig, while the wheels say something.
  void CollectTurns() {
    for (size_t i = 0; i < report_->rig->scanners.size(); ++i) {
      const Scanner& scanner = report_->rig->scanners[i];
      const double up = (scanner.body_from_scanner.rotation * Eigen::Vector3d::UnitZ()).z();
      if (report_->heights[i].is_tilted || report_->topics_of_scanners[i] < 0) continue;
      const auto topic = static_cast<size_t>(report_->topics_of_scanners[i]);
      const int64_t margin_ns = NanosecondsFromSeconds(kMaxLag);
      for (StepTurn turn : report_->turns[topic]) {
        ++num_seen_;
        if (wheels_.Covers(turn.begin_ns, turn.end_ns)) ++num_covered_;
        // Standing surfaces turn the other way in the scanner's frame.
        turn.turn_rad *= up > 0.0 ? -1.0 : 1.0;
        if (std::abs(turn.turn_rad) <
                kMinTurnRate * SecondsBetween(turn.begin_ns, turn.end_ns) ||
            !wheels_.Covers(turn.begin_ns - margin_ns, turn.end_ns + margin_ns)) {
          continue;
        }
        turns_.push_back(turn);
      }
    }
  }

  // The moves of the first level scanner that sees any, as those of the rig, while the wheels
  // say something. Where others sit is told by what they see together.
  std::vector<CountedMove> CollectMoves() const {
    std::vector<CountedMove> moves;
    const int64_t lag_ns = NanosecondsFromSeconds(report_->wheels_late_s.value_or(0.0));
    for (size_t i = 0; i < report_->rig->scanners.size() && moves.empty(); ++i) {
      if (report_->heights[i].is_tilted || report_->topics_of_scanners[i] < 0) continue;
      const auto topic = static_cast<size_t>(report_->topics_of_scanners[i]);
      for (const StepMove& step : report_->moves[topic]) {
        const auto counted = wheels_.Between(step.begin_ns + lag_ns, step.end_ns + lag_ns);
        if (!counted) continue;
        moves.push_back({step.begin_ns,
                         step.end_ns,
                         MoveOfBody(step, report_->rig->scanners[i].body_from_scanner),
                         counted->translation});
      }
    }
    return moves;
  }

  // The seconds of the recording in which a scanner sees several moves after one another of
  // which the wheels have the wrong sign: walls that are taken for one another show single
  // ones.
  std::vector<int64_t> SecondsBackToFront(const std::vector<CountedMove>& moves) const {
    std::set<int64_t> seconds;
    for (size_t first = 0, after = 0; first < moves.size(); first = after + 1) {
      after = first;
      while (after < moves.size() && moves[after].IsBackToFront()) ++after;
      if (after < first + kMinSteps) continue;
      const auto time_s = [&](int64_t time_ns) {
        return SecondsBetween(report_->survey.start_receipt_ns, time_ns);
      };
      const double end_s = time_s(moves[after - 1].end_ns);
      for (auto second = static_cast<int64_t>(time_s(moves[first].begin_ns));
           static_cast<double>(second) < end_s;
           ++second) {
        seconds.insert(second);
      }
    }
    return {seconds.begin(), seconds.end()};
  }

  // Returns the part of a turn that the wheels do not explain if they are later by lag_s, rad.
  double Difference(const StepTurn& turn, double lag_s, double sign) const {
    const int64_t lag_ns = NanosecondsFromSeconds(lag_s);
    const auto motion = wheels_.Between(turn.begin_ns + lag_ns, turn.end_ns + lag_ns);
    return turn.turn_rad - (motion ? sign * motion->turn : 0.0);
  }

  double LeftOver(double lag_s, double sign) const {
    double left = 0.0;
    for (const StepTurn& turn : turns_) left += std::abs(Difference(turn, lag_s, sign));
    return left;
  }

  CheckReport* report_;
  const Odometry& wheels_;
  std::vector<StepTurn> turns_;
  size_t num_seen_ = 0;
  size_t num_covered_ = 0;
};

}  // namespace

void FindWheelFaults(CheckReport* report) {
  if (!report->rig || report->rig->odometry_topic.empty()) return;
  const RecordingSurvey& survey = report->survey;
  if (!survey.wheels_fault.empty()) {
    report->findings.push_back({Severity::kWarning,
                                report->rig->odometry_topic,
                                "the wheels are left out: " + survey.wheels_fault,
                                "look at the driver, or leave them out of the rig file",
                                Subject::kWheels,
                                false,
                                true});
    return;
  }
  for (const std::string& mended : survey.wheels_mended) {
    report->findings.push_back({Severity::kWarning,
                                report->rig->odometry_topic,
                                "of the wheels " + mended,
                                "",
                                Subject::kWheels,
                                false,
                                true});
  }
  if (survey.wheels != nullptr) WheelJudge(report, *survey.wheels).Judge();
}

}  // namespace plumbline
