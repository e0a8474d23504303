#include "core/mapping/checked_recording.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/geometry/angles.h"
#include "core/judging/check.h"
#include "core/util/error.h"
#include "core/util/one_line.h"

namespace plumbline {
namespace {

// Whether a map comes out wrong by what was found. A scanner that is dead, or too little in
// view for a start, the mapper finds by itself, and maps with what there is.
bool MakesMapWrong(const Finding& finding) {
  return finding.severity == Severity::kStop &&
         (finding.moves_places || finding.about == Subject::kMounting ||
          finding.about == Subject::kWheels);
}

// What the rules of plumbline_check say of a recording, the gravest first. Throws Error where
// a wrong map would come of it. What they say of how scanners are mounted is left out where
// the map estimates that, and better, from the rig file or from near where they agree.
std::vector<Finding> FindingsOf(const std::string& recording,
                                const CheckReport& report,
                                bool estimates_scanners,
                                bool force) {
  std::vector<Finding> findings;
  for (const Finding& finding : report.findings) {
    if (finding.severity == Severity::kNote || finding.about == Subject::kRecording ||
        finding.about == Subject::kView ||
        (estimates_scanners && finding.about == Subject::kMounting &&
         (finding.severity == Severity::kWarning || report.near))) {
      continue;
    }
    if (MakesMapWrong(finding) && !force) {
      throw Error(recording + ": a wrong map would come of it: " + InWords(finding) +
                  "; --force maps it all the same");
    }
    findings.push_back(finding);
  }
  return findings;
}

// The rig with scanners where they agree. What a scanner is off by says how well the rig file
// knows it, where that is worse than it states.
Rig Near(Rig rig, const MountedRig& near) {
  for (size_t i = 0; i < near.size(); ++i) {
    Scanner& scanner = rig.scanners[i];
    const Eigen::AngleAxisd turn(near[i].body_from_scanner.rotation *
                                 scanner.body_from_scanner.rotation.conjugate());
    LOG(INFO) << "scanner " << scanner.name << " starts turned by "
              << turn.angle() * kDegreesPerRadian << " deg, where it agrees with the others";
    ScannerUncertainty& uncertainty = scanner.uncertainty;
    const auto widen = [](double off, double* sigma) { *sigma = std::max(*sigma, off); };
    widen(turn.angle(), &uncertainty.rotation_rad);
    widen(
        (near[i].body_from_scanner.translation - scanner.body_from_scanner.translation).norm(),
        &uncertainty.translation_m);
    widen(std::abs(near[i].time_offset_s - scanner.time_offset_s), &uncertainty.time_s);
    widen(std::abs(near[i].range_offset_m + scanner.range_bias_m), &uncertainty.range_m);
    scanner.body_from_scanner = near[i].body_from_scanner;
    scanner.time_offset_s = near[i].time_offset_s;
    scanner.range_bias_m = -near[i].range_offset_m;
  }
  return rig;
}

// Sets the range noises that the rig file leaves to the recording to what neighbouring beams
// show.
void EstimateNoise(const std::string& recording, const RecordingSurvey& survey, Rig* rig) {
  for (Scanner& scanner : rig->scanners) {
    if (!scanner.estimates_noise) continue;
    const auto topic = std::find_if(
        survey.topics.begin(), survey.topics.end(), [&](const TopicSurvey& candidate) {
          return candidate.name == scanner.topic;
        });
    if (topic == survey.topics.end() || topic->noise_m == 0.0) {
      throw Error(recording + ": scanner " + scanner.name +
                  " shows no straight surfaces to tell its noise from: state its "
                  "range_noise_m in the rig file");
    }
    scanner.range_noise_m = topic->noise_m;
    scanner.estimates_noise = false;
    LOG(INFO) << "scanner " << scanner.name << " has a range noise of "
              << 1e3 * scanner.range_noise_m << " mm, as neighbouring beams show";
  }
}

}  // namespace

void CheckPoses(const std::string& rig_file, const Rig& rig) {
  if (!SitAtOnePose(rig)) return;
  throw Error(rig_file + ": all " + std::to_string(rig.scanners.size()) +
              " scanners sit at one pose: fill in body_from_scanner of each");
}

CheckedRecording ReadChecked(const std::string& recording,
                             Rig rig,
                             bool force,
                             Stopwatch* reading) {
  CheckedRecording checked;
  RecordingSurveyor surveyor(&rig);
  {
    const Stopwatch::Running running(reading);
    checked.reader = std::make_unique<RecordingReader>(
        recording,
        rig,
        RecordingObserver{
            [&](const RecordingTopic& topic,
                const MessageRef& where,
                const ScanLineMessage& line) { surveyor.Add(topic, where, line); },
            [&](const RecordingTopic& topic) { surveyor.AddUndecodable(topic); }});
  }
  RecordingSurvey survey = surveyor.Finish(checked.reader->topics());
  survey.wheels = checked.reader->odometry();
  survey.imu = checked.reader->imu();
  PlaceScanners(*checked.reader, &rig);
  EstimateNoise(recording, survey, &rig);
  const CheckReport report = CheckSurvey(std::move(survey), rig);
  const bool estimates_scanners = EstimatesScanners(rig);
  checked.findings = FindingsOf(recording, report, estimates_scanners, force);
  checked.stated = rig;
  checked.rig = std::move(rig);
  const bool starts_near = estimates_scanners && report.near;
  if (report.other_header) checked.rig = WithHeaders(checked.rig, *report.other_header);
  if (starts_near) checked.rig = Near(checked.rig, *report.near);
  if (report.other_header || starts_near) {
    checked.reader = std::make_unique<RecordingReader>(recording, checked.rig);
  }
  if (report.wheels_late_s) {
    LOG(INFO) << "the wheels' stamps are " << *report.wheels_late_s
              << " s late, by when they and the scanners turn";
    checked.reader->DelayOdometry(-*report.wheels_late_s);
    checked.rig.odometry_time_offset_s = -*report.wheels_late_s;
  }
  return checked;
}

std::vector<std::string> WarningsOf(const std::vector<Finding>& findings) {
  std::vector<std::string> warnings;
  for (const Finding& finding : findings) {
    if (!finding.is_told_by_reader) warnings.push_back(InWords(finding));
  }
  return warnings;
}

void AddFindings(const std::vector<Finding>& findings, Summary* summary) {
  const std::vector<std::string> warnings = WarningsOf(findings);
  summary->warnings.insert(summary->warnings.begin(), warnings.begin(), warnings.end());
  if (summary->consistency.verdict == Verdict::kConsistent) return;
  const auto cause =
      std::find_if(findings.begin(), findings.end(), [](const Finding& finding) {
        return finding.severity == Severity::kStop || finding.moves_places ||
               finding.about == Subject::kMounting ||
               (finding.about == Subject::kWheels && !finding.is_told_by_reader);
      });
  if (cause == findings.end()) return;
  summary->cause =
      Cause{cause->about == Subject::kMounting ? "a scanner is not as the rig file says"
                                               : "the recording is not as it should be",
            "",
            OnOneLine((cause->subject.empty() ? "" : cause->subject + ": ") + cause->sentence),
            OnOneLine(cause->advice)};
}

}  // namespace plumbline
