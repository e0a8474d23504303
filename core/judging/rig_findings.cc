#include <algorithm>
#include <cmath>
#include <set>

#include "core/geometry/angles.h"
#include "core/geometry/roll_pitch_yaw.h"
#include "core/judging/findings.h"
#include "core/judging/levels.h"
#include "core/judging/words.h"
#include "core/util/quantiles.h"

namespace plumbline {
namespace {

// Errors that move a place by less than kOnePlace are not worth a word: turns at kLever,
// clocks of a rig that turns by a radian a second, ranges of walls on both sides. Larger ones
// than these bend a map by centimetres and more.
constexpr double kLargeTime = 0.1;      // s
constexpr double kMaxStartTilt = 20.0;  // deg

// The parts of a correction that are large and certain.
struct NamedParts {
  std::vector<std::string> words;
  std::vector<std::string> advice;
  bool is_large = false;
  bool is_far = false;  // large turns and shifts: they move every place
};

NamedParts NameParts(const MountingCorrection& correction) {
  NamedParts parts;
  const auto is_certain = [&](Eigen::Index first, double named, const Eigen::Vector3d& v) {
    return v.norm() > named &&
           v.norm() > kSignificantStddevs *
                          correction.stddev.segment<3>(first).dot(v.cwiseAbs()) /
                          std::max(1e-12, v.norm());
  };
  const MountedScanner& corrected = correction.corrected;
  if (is_certain(0, kOnePlace / kLever, correction.rotation_rad)) {
    const Eigen::Vector3d turn = correction.rotation_rad * kDegreesPerRadian;
    const Eigen::Vector3d rpy = RollPitchYawDegrees(corrected.body_from_scanner.rotation);
    const bool is_upright = std::abs(turn.z()) > 0.9 * turn.norm();
    parts.words.push_back("to be turned by " +
                          Decimal(is_upright ? turn.z() : turn.norm(), 1) + " deg" +
                          (is_upright ? " about the vertical" : ""));
    parts.advice.push_back("rotation_rpy_deg: [" + Decimal(rpy.x(), 1) + ", " +
                           Decimal(rpy.y(), 1) + ", " + Decimal(rpy.z(), 1) + "]");
    parts.is_far = parts.is_far || correction.rotation_rad.norm() > kAgreed / kLever;
  }
  if (is_certain(3, kOnePlace, correction.translation_m)) {
    const Eigen::Vector3d& t = corrected.body_from_scanner.translation;
    parts.words.push_back("to be shifted by " +
                          Decimal(1e3 * correction.translation_m.norm(), 0) + " mm");
    parts.advice.push_back("translation: [" + Decimal(t.x(), 3) + ", " + Decimal(t.y(), 3) +
                           ", " + Decimal(t.z(), 3) + "]");
    parts.is_far = parts.is_far || correction.translation_m.norm() > 0.5 * kAgreed;
  }
  parts.is_large = parts.is_far;
  const auto is_sure = [&](Eigen::Index index, double named, double value) {
    return std::abs(value) > named &&
           std::abs(value) > kSignificantStddevs * correction.stddev(index);
  };
  if (is_sure(6, kOnePlace / kLever, correction.time_offset_s)) {
    const double late_ms = -1e3 * correction.time_offset_s;
    parts.words.push_back("to be stamped " + Decimal(std::abs(late_ms), 0) + " ms too " +
                          (late_ms > 0.0 ? "late" : "early"));
    parts.advice.push_back("time_offset_s: " + Decimal(corrected.time_offset_s, 4));
    parts.is_large = parts.is_large || std::abs(correction.time_offset_s) > kLargeTime;
  }
  if (is_sure(7, 0.5 * kOnePlace, correction.range_offset_m)) {
    parts.words.push_back("to measure " +
                          Decimal(1e3 * std::abs(correction.range_offset_m), 0) + " mm too " +
                          (correction.range_offset_m < 0.0 ? "long" : "short"));
  }
  return parts;
}

// Tells how scanners and rig file fit.
class RigJudge {
 public:
  explicit RigJudge(CheckReport* report) : report_(report), rig_(*report->rig) {}

  void Judge() {
    JudgeTopics();
    if (!HasAllLines()) return;  // why not is told
    JudgeHeaders();
    JudgeMounting();
    JudgeNods();
    JudgeAttitudes();
    if (IsPlanar(rig_)) {
      JudgePlanarView();
    } else {
      JudgeSpatialView();
    }
  }

 private:
  void Add(Severity severity,
           const std::string& subject,
           const std::string& sentence,
           const std::string& advice,
           Subject about = Subject::kMounting) {
    report_->findings.push_back({severity, subject, sentence, advice, about});
  }
  // What scanners that sit elsewhere mean for a map, which begins where they agree if it can.
  void AddMounting(const std::string& subject,
                   const std::string& sentence,
                   const std::string& advice) {
    if (report_->near) {
      Add(Severity::kWarning,
          subject,
          sentence,
          "plumbline_map begins where the scanners agree and estimates the rest; or: " +
              advice);
    } else {
      Add(Severity::kStop, subject, sentence, advice);
    }
  }
  bool HasLines(size_t scanner) const {
    const int topic = report_->topics_of_scanners[scanner];
    return topic >= 0 && !report_->survey.sample[static_cast<size_t>(topic)].empty();
  }
  bool HasAllLines() const {
    for (size_t i = 0; i < rig_.scanners.size(); ++i) {
      if (!HasLines(i)) return false;
    }
    return true;
  }
  const std::string& NameOf(size_t scanner) const { return rig_.scanners[scanner].name; }
  const std::string& TopicOf(size_t scanner) const { return rig_.scanners[scanner].topic; }

  // Places that the scanner and another see.
  int NumCompared(size_t scanner) const {
    int num = 0;
    for (const PairAgreement& pair : report_->agreements) {
      if (pair.a == scanner || pair.b == scanner) num += pair.num_compared;
    }
    return num;
  }

  void JudgeTopics() {
    std::vector<std::string> found;
    std::set<std::string> used;
    for (const TopicSurvey& topic : report_->survey.topics) found.push_back(topic.name);
    for (size_t i = 0; i < rig_.scanners.size(); ++i) {
      used.insert(TopicOf(i));
      if (report_->topics_of_scanners[i] >= 0) continue;
      Add(Severity::kStop,
          TopicOf(i),
          "the recording has no such topic, which the rig file names for scanner " + NameOf(i),
          found.empty() ? "record the topics of the scanners"
                        : "name one of " + Enumerate(found) + " in the rig file",
          Subject::kRecording);
    }
    for (const std::string& name : found) {
      if (used.count(name) > 0) continue;
      Add(Severity::kNote, name, "has scan lines, but the rig file does not name it", "");
    }
  }

  // States the headers under which the scanners agree.
  void JudgeHeaders() {
    if (!report_->other_header) return;
    const OtherHeader& other = *report_->other_header;
    report_->findings.push_back({Severity::kWarning,
                                 "",
                                 other.words + ": so, " + PercentOf(other.share_so) +
                                     " of the places that two scanners see agree to 1.5 cm, "
                                     "as it is " +
                                     PercentOf(other.share_as_stated) +
                                     "; plumbline_map takes it so",
                                 other.advice,
                                 Subject::kHeader,
                                 true});
  }

  void JudgeMounting() {
    if (SitAtOnePose(rig_)) {
      Add(Severity::kStop,
          "",
          "all " + std::to_string(rig_.scanners.size()) + " scanners sit at one pose",
          "fill in body_from_scanner of each in the rig file");
      return;
    }
    if (report_->other_mounting) {
      const OtherMounting& other = *report_->other_mounting;
      AddMounting("",
                  other.words + ". As the rig file stands, " +
                      PercentOf(other.share_as_stated) +
                      " of the places that two scanners see agree to a decimetre; so, " +
                      PercentOf(other.share_so) + " do",
                  other.advice);
      return;
    }
    std::vector<std::string> apart;
    for (const PairAgreement& pair : report_->agreements) {
      if (!pair.IsApart()) continue;
      apart.push_back(NameOf(pair.a) + " and " + NameOf(pair.b) + " (half of the places lie " +
                      Decimal(pair.median_m, 2) + " m apart or more)");
    }
    if (!JudgeCorrections(!apart.empty()) && !apart.empty()) {
      AddMounting("",
                  "the scanners do not see the same places where the rig file says that they "
                  "should: " +
                      Enumerate(apart),
                  "check body_from_scanner of each: axes x forward, y left, z up; R = Rz(yaw) "
                  "Ry(pitch) "
                  "Rx(roll)");
    }
    JudgeUncompared();
  }

  // Names the one scanner whose correction brings most of the places together. Where those of
  // two bring as many, as where these compare with each other alone, the simpler one is right.
  // are_apart: whether scanners see other places than the rig file says, which a correction
  // that mends little does not explain. Where most places agree as it is, a correction that
  // moves them far does so in a direction that the scans hardly show.
  bool JudgeCorrections(bool are_apart) {
    const std::vector<MountingCorrection>& corrections = report_->corrections;
    const auto gain = [&](size_t i) {
      return corrections[i].num_compared *
             (corrections[i].moved_share - corrections[i].near_share);
    };
    const auto num_parts = [&](size_t i) { return NameParts(corrections[i]).words.size(); };
    std::optional<size_t> found;
    for (size_t i = 0; i < corrections.size(); ++i) {
      const double least = kHardlyAny * corrections[i].num_compared;
      if (gain(i) < least || num_parts(i) == 0) continue;
      if (NameParts(corrections[i]).is_far && 2.0 * corrections[i].near_share > 1.0) continue;
      const double more = found ? gain(i) - gain(*found) : gain(i);
      const bool is_alike = found && std::abs(more) < least;
      if (is_alike ? num_parts(i) < num_parts(*found) : more > 0.0) found = i;
    }
    if (!found) return false;
    const size_t worst = *found;
    const NamedParts parts = NameParts(corrections[worst]);
    const std::string who =
        "scanner " + NameOf(worst) + " seems " + Enumerate(parts.words) +
        ", by the places that it " +
        (rig_.scanners.size() > 2 ? "and others see" : "and the other see");
    const MountingCorrection& correction = corrections[worst];
    const bool mends_most = 2.0 * (correction.moved_share - correction.near_share) >
                            1.0 - correction.near_share;  // of what does not agree
    if (are_apart && !mends_most) return false;
    const std::string sentence =
        who + "; with that mended, " + PercentOf(corrections[worst].moved_share) +
        " of them agree to 1.5 cm, as it is " + PercentOf(corrections[worst].near_share);
    const std::string advice = parts.advice.empty()
                                   ? "calibrate its ranges"
                                   : "in the rig file: " + Enumerate(parts.advice);
    if (parts.is_large && mends_most) {
      AddMounting(TopicOf(worst), sentence, advice);
    } else {
      Add(Severity::kWarning, TopicOf(worst), sentence, advice);
    }
    return true;
  }

  void JudgeUncompared() {
    if (rig_.scanners.size() < 2) return;
    for (size_t i = 0; i < rig_.scanners.size(); ++i) {
      if (!HasLines(i)) continue;
      if (NumCompared(i) >= kMinPlaces || rig_.scanners[i].mount) continue;
      Add(Severity::kNote,
          TopicOf(i),
          "scanner " + NameOf(i) +
              " sees hardly any place that another sees as well: whether it "
              "sits as the rig file says could not be judged",
          "");
    }
  }

  void JudgeNods() {
    for (size_t i = 0; i < rig_.scanners.size(); ++i) {
      if (!HasLines(i) || rig_.scanners[i].mount) continue;
      const auto nod = report_->NodOf(static_cast<size_t>(report_->topics_of_scanners[i]));
      if (!nod || nod->is_of_rig) continue;
      AddMounting(TopicOf(i),
                  "scanner " + NameOf(i) + " moves against the rig with a period of " +
                      Decimal(nod->period_s, 2) + " s, about an axis at " +
                      Decimal(nod->axis_rad * kDegreesPerRadian, 0) +
                      " deg of its angles, and the rig file has no mount for it",
                  "add its mount to the rig file");
    }
  }

  // Only where no other scanner vouches for this one: a rig that swings deceives this test.
  void JudgeAttitudes() {
    for (size_t i = 0; i < rig_.scanners.size(); ++i) {
      if (!HasLines(i) || NumCompared(i) >= kMinPlaces || rig_.scanners[i].mount) continue;
      const OwnAttitude& own =
          report_->attitudes[static_cast<size_t>(report_->topics_of_scanners[i])];
      const bool is_tilted = report_->heights[i].is_tilted;
      if (own.attitude == Attitude::kTilted && !is_tilted) {
        Add(Severity::kWarning,
            TopicOf(i),
            "scanner " + NameOf(i) + " is level in the rig file, but " +
                PercentOf(own.still_share) +
                " of what it sees stays when the rig turns, as "
                "floor and ceiling do",
            "check its rotation_rpy_deg");
      } else if (own.attitude == Attitude::kLevel && is_tilted) {
        Add(Severity::kWarning,
            TopicOf(i),
            "scanner " + NameOf(i) +
                " is tilted in the rig file, but all that it sees turns "
                "when the rig does: it may be level, or see neither floor nor ceiling",
            "check its rotation_rpy_deg");
      }
    }
  }

  void JudgePlanarView() {
    if (report_->starts.num_scans > 0 && report_->starts.num_starts == 0) {
      Add(Severity::kStop,
          "",
          "no scan shows a straight wall that is long enough to start from",
          "record where there are walls within reach",
          Subject::kView);
    }
  }

  void JudgeSpatialView() {
    const bool has_imu = report_->survey.imu != nullptr;
    bool is_crossed = false;
    std::vector<std::string> seeing;
    std::vector<double> floors;
    for (size_t i = 0; i < rig_.scanners.size(); ++i) {
      if (!HasLines(i)) continue;
      const HeightView& view = report_->heights[i];
      if (view.floor.is_seen || view.ceiling.is_seen || NodsWithRig(i)) {
        seeing.push_back(NameOf(i));
      }
      if (view.floor.is_seen) floors.push_back(view.floor.height_m);
      is_crossed = is_crossed || ((rig_.scanners[i].mount || has_imu) && view.is_tilted) ||
                   NodsWithRig(i);
      for (size_t j = 0; j < i; ++j) {
        if (!HasLines(j)) continue;
        const auto normal = [&](size_t k) {
          return rig_.scanners[k].body_from_scanner.rotation * Eigen::Vector3d::UnitZ();
        };
        is_crossed =
            is_crossed || normal(i).cross(normal(j)).norm() > std::sin(kParallelAngle);
      }
    }
    if (!is_crossed) {
      Add(Severity::kStop,
          "",
          "3D needs two scanners whose scan planes are not parallel; this recording has none",
          "tilt scanners against each other, or say motion: planar where all are level",
          Subject::kView);
    } else if (seeing.empty()) {
      Add(Severity::kStop,
          "",
          "no scanner sees level traces above or below: neither floor nor ceiling is in view "
          "where the rig file says",
          "tilt two scanners so that they see floor, ceiling and walls, and check their "
          "rotation_rpy_deg",
          Subject::kView);
    }
    if (floors.size() > 1 && !report_->other_mounting) {
      const auto [low, high] = std::minmax_element(floors.begin(), floors.end());
      if (*high - *low > kAgreed) {
        Add(Severity::kWarning,
            "",
            "the scanners see the floor at different heights below the body: " +
                Decimal(-*low, 2) + " m and " + Decimal(-*high, 2) + " m",
            "check translation and rotation_rpy_deg of the tilted scanners");
      }
    }
    JudgeStarts();
  }

  // Whether the rig itself nods, so that the scan planes of one scanner cross.
  bool NodsWithRig(size_t scanner) const {
    const auto nod = report_->NodOf(static_cast<size_t>(report_->topics_of_scanners[scanner]));
    return nod && nod->is_of_rig;
  }

  void JudgeStarts() {
    const StartSearch& starts = report_->starts;
    if (starts.num_scans == 0) return;
    // With an IMU, a map starts by gravity where no scan shows the frame.
    if (starts.num_starts == 0 && report_->survey.imu == nullptr) {
      Add(Severity::kStop,
          "",
          "none of " + std::to_string(starts.num_scans) +
              " scans looked at shows floor or ceiling and walls clearly enough to start from",
          "start in view of floor, ceiling and a wall; check the rig file's rotations",
          Subject::kView);
    } else if (starts.tilt_deg > kMaxStartTilt) {
      Add(Severity::kWarning,
          "",
          "the body's z axis leans by " + Decimal(starts.tilt_deg, 0) +
              " deg against the vertical that the scans show",
          "turn the body frame in the rig file so that z points up; beyond 35 deg no map "
          "starts");
    }
  }

  CheckReport* report_;
  const Rig& rig_;
};

}  // namespace

void FindRigFaults(CheckReport* report) {
  if (report->rig) RigJudge(report).Judge();
}

bool IsLarge(const MountingCorrection& correction) { return NameParts(correction).is_large; }

}  // namespace plumbline
