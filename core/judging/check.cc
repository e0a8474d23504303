#include "core/judging/check.h"

#include <algorithm>
#include <utility>

#include "core/judging/findings.h"
#include "core/judging/levels.h"
#include "core/judging/words.h"
#include "core/sensor/recording.h"
#include "core/util/error.h"
#include "core/util/one_line.h"

namespace plumbline {
namespace {

// Whether one scanner's correction makes most of its places agree that did not.
bool IsMended(const std::vector<MountingCorrection>& corrections) {
  return std::any_of(corrections.begin(), corrections.end(), [](const auto& one) {
    return one.moved_share > 0.5 && one.moved_share > one.near_share + 1.0 - kMost;
  });
}

// The scanner that is held while the others are moved to where they agree: one that is known
// exactly, else the first one. Held by the body's, a steep one, corrections in turns ended
// elsewhere in 5 of 50 corridors (docs/decisions/098).
size_t HeldScanner(const Rig& stated) { return ExactlyPlacedScanner(stated).value_or(0); }

// Returns the same rig with the body's scanner at its stated pose and clock.
MountedRig WithBodyAsStated(MountedRig rig, const MountedRig& stated, size_t body) {
  const Rigid3d move = stated[body].body_from_scanner * rig[body].body_from_scanner.Inverse();
  const double later_s = stated[body].time_offset_s - rig[body].time_offset_s;
  for (MountedScanner& scanner : rig) {
    scanner.body_from_scanner = move * scanner.body_from_scanner;
    scanner.time_offset_s += later_s;
  }
  return rig;
}

// Whether another mounting, or the correction of one scanner, explains what an other header
// would, and more.
bool IsExplainedByMounting(const OtherHeader& header,
                           const std::vector<std::vector<SampledLine>>& sample,
                           const Rig& stated,
                           const MountedRig& rig,
                           const std::vector<std::string>& names) {
  const std::optional<OtherMounting> other = FindOtherMounting(sample, rig, names);
  if (other && NearShareOfAll(sample, other->rig) > header.share_so + kHardlyAny) return true;
  if (EstimatesScanners(stated)) {
    // Scanners that are not known exactly are off, headers hardly ever, and then those of all
    // scanners of a kind. So the header of one scanner has to explain more than scanners that
    // move, as far as the number of places tells; of all, not less.
    const bool is_of_all = header.scanners.size() == rig.size();
    const auto explain = [&](bool planar) {
      const MountedRig fitted = FitInTurns(sample, rig, HeldScanner(stated), planar);
      const double share = NearShareOfAll(sample, fitted);
      const double significant =
          SignificantDifference(share, header.share_so, NumPlaces(sample, rig));
      return share - header.share_so > (is_of_all ? significant : -significant);
    };
    // Scanners of a planar rig are moved with their tilts or without.
    if (explain(false) || (IsPlanar(stated) && explain(true))) return true;
  }
  const std::vector<MountingCorrection> corrections = FitMountings(sample, rig);
  for (size_t i = 0; i < rig.size(); ++i) {
    if (corrections[i].num_compared == 0) continue;
    MountedRig corrected = rig;
    corrected[i] = corrections[i].corrected;
    if (NearShareOfAll(sample, corrected) > header.share_so + kHardlyAny) return true;
  }
  return false;
}

// Whether any scanners see other places than the rig file says.
bool AreApart(const std::vector<PairAgreement>& agreements) {
  return std::any_of(agreements.begin(), agreements.end(), [](const PairAgreement& pair) {
    return pair.IsApart();
  });
}

// Where scanners agree that sit some degrees and centimetres off, or are turned by any angle:
// nothing where they do not, or another mounting makes more of them agree.
std::optional<MountedRig> BringNear(const std::vector<std::vector<SampledLine>>& sample,
                                    const MountedRig& rig,
                                    const std::optional<OtherMounting>& other,
                                    const std::optional<OtherMounting>& turned,
                                    const Rig& stated) {
  const MountedRig fitted =
      FitInTurns(sample, turned ? turned->rig : rig, HeldScanner(stated), IsPlanar(stated));
  if (AreApart(AgreementsOf(sample, fitted))) return std::nullopt;
  if (other && NearShareOfAll(sample, other->rig) > NearShareOfAll(sample, fitted)) {
    return std::nullopt;
  }
  return WithBodyAsStated(fitted, rig, BodyScanner(stated));
}

// Compares the scanners that have lines, with the rig file and with each other.
void LookAtRig(const std::vector<std::vector<SampledLine>>& as_sent, CheckReport* report) {
  const Rig& rig = *report->rig;
  Rig present = rig;
  present.scanners.clear();
  std::vector<size_t> sources;
  std::vector<size_t> indices;  // in the rig, of those present
  std::vector<std::string> names;
  Rig starting = present;  // with those on mounts
  std::vector<const std::vector<ScanLine>*> starting_lines;
  for (size_t i = 0; i < rig.scanners.size(); ++i) {
    const Scanner& scanner = rig.scanners[i];
    int topic = -1;
    for (size_t k = 0; k < report->survey.topics.size(); ++k) {
      if (report->survey.topics[k].name == scanner.topic) topic = static_cast<int>(k);
    }
    report->topics_of_scanners.push_back(topic);
    const auto at = static_cast<size_t>(std::max(0, topic));
    report->heights.push_back(
        FindHeights(topic < 0 ? std::vector<SampledLine>() : as_sent[at], scanner));
    if (topic < 0 || as_sent[at].empty()) continue;
    starting.scanners.push_back(scanner);
    starting_lines.push_back(&report->survey.sample[at]);
    if (scanner.mount) continue;  // it sees other places at every angle
    present.scanners.push_back(scanner);
    sources.push_back(at);
    indices.push_back(i);
    names.push_back(scanner.name);
  }
  const MountedRig mounted = AsRigFileSays(present, sources);
  report->agreements = AgreementsOf(as_sent, mounted);
  for (PairAgreement& pair : report->agreements) {
    pair.a = indices[pair.a];
    pair.b = indices[pair.b];
  }
  report->other_header =
      FindOtherHeader(as_sent, report->survey.topics, mounted, present.scanners);
  if (report->other_header &&
      IsExplainedByMounting(*report->other_header, as_sent, present, mounted, names)) {
    report->other_header.reset();
  }
  const std::vector<std::vector<SampledLine>>& sample =
      report->other_header ? report->other_header->sample : as_sent;
  report->other_mounting = FindOtherMounting(sample, mounted, names);
  report->corrections.resize(rig.scanners.size());
  const std::vector<MountingCorrection> corrections = FitMountings(sample, mounted);
  for (size_t i = 0; i < corrections.size(); ++i)
    report->corrections[indices[i]] = corrections[i];
  std::optional<OtherMounting> turned;
  if (!report->other_mounting && !IsMended(corrections)) {
    turned = FindTurn(sample, mounted, names);
  }
  const bool are_off = report->other_mounting || turned || AreApart(report->agreements) ||
                       std::any_of(corrections.begin(), corrections.end(), IsLarge);
  if (are_off && EstimatesScanners(rig) && present.scanners.size() == rig.scanners.size()) {
    report->near = BringNear(sample, mounted, report->other_mounting, turned, rig);
  }
  if (report->near) report->other_mounting.reset();
  if (turned) report->other_mounting = turned;
  report->starts = FindStarts(starting, starting_lines);
}

// Finds which scanners nod as the whole rig does.
void FindNodsOfRig(CheckReport* report) {
  if (report->survey.imu == nullptr) return;
  for (size_t i = 0; i < report->topics_of_scanners.size(); ++i) {
    const int topic = report->topics_of_scanners[i];
    if (topic < 0) continue;
    const auto at = static_cast<size_t>(topic);
    std::optional<Nod>& nod = report->nods[at];
    if (!nod) continue;
    nod->is_of_rig = IsOfRig(*nod,
                             report->survey.sample[at],
                             report->rig->scanners[i],
                             *report->rig->imu,
                             *report->survey.imu);
  }
}

bool HasStop(const CheckReport& report) {
  return std::any_of(report.findings.begin(), report.findings.end(), [](const Finding& one) {
    return one.severity == Severity::kStop;
  });
}

void JudgeWithRig(CheckReport* report) {
  if (IsPlanar(*report->rig)) {
    report->mappable = Mappable::kInThePlane;
    report->verdict =
        "can be mapped in the plane: all scanners are level, so that neither "
        "heights nor tilts are seen";
  } else {
    report->mappable = Mappable::kInSpace;
    report->verdict = "can be mapped in 3D";
  }
}

void JudgeWithoutRig(CheckReport* report) {
  int num_tilted = 0;
  int num_level = 0;
  int num_nodding = 0;
  for (const OwnAttitude& own : report->attitudes) {
    if (own.attitude == Attitude::kTilted || own.attitude == Attitude::kNodding) ++num_tilted;
    if (own.attitude == Attitude::kNodding) ++num_nodding;
    if (own.attitude == Attitude::kLevel) ++num_level;
  }
  const auto num_topics = static_cast<int>(report->survey.topics.size());
  report->mappable = Mappable::kInThePlane;
  if (num_nodding > 0) {
    report->mappable = Mappable::kInSpace;
    report->verdict =
        "can be mapped in 3D once the rig file is filled in, with the mount of "
        "each scanner that nods";
  } else if (num_tilted > 0 && num_topics > 1) {
    report->mappable = Mappable::kInSpace;
    report->verdict =
        "can be mapped in 3D once the rig file is filled in: " + std::to_string(num_tilted) +
        " of " + std::to_string(num_topics) + " scanners see floor or ceiling";
  } else if (num_level == num_topics) {
    report->verdict =
        "can be mapped in the plane once the rig file is filled in: all scanners "
        "are level";
  } else if (num_topics == 1) {
    report->verdict =
        "can be mapped in the plane if the scanner is level; 3D needs a second "
        "one that is tilted against it";
  } else {
    report->verdict =
        "can be mapped once the rig file is filled in; whether in 3D or in the "
        "plane the scans do not show by themselves";
  }
}

// Where clocks, headers or ranges make scanners seem to sit otherwise, where they sit is not
// to be blamed.
void BlameInOrder(std::vector<Finding>* findings) {
  const auto cause = std::find_if(findings->begin(), findings->end(), [](const Finding& one) {
    return one.moves_places && one.severity > Severity::kNote;
  });
  if (cause == findings->end()) return;
  const std::string first = "first mend what is said above: ";
  const std::string subject = cause->subject.empty() ? "" : cause->subject + ": ";
  const std::string advice = first + subject + cause->sentence;
  for (Finding& finding : *findings) {
    if (finding.about != Subject::kMounting || finding.severity == Severity::kNote) continue;
    finding.severity = Severity::kWarning;
    finding.advice = advice;
  }
}

void Judge(CheckReport* report) {
  BlameInOrder(&report->findings);
  std::stable_sort(
      report->findings.begin(), report->findings.end(), [](const auto& a, const auto& b) {
        return std::make_pair(b.severity, a.about) < std::make_pair(a.severity, b.about);
      });
  if (HasStop(*report)) {
    report->mappable = Mappable::kNot;
    report->verdict = "can not be mapped as it is: first change what is marked stop";
  } else if (report->rig) {
    JudgeWithRig(report);
  } else {
    JudgeWithoutRig(report);
  }
}

}  // namespace

CheckReport CheckRecording(const std::string& path, const std::optional<Rig>& rig) {
  if (!rig) return CheckSurvey(SurveyRecording(path, nullptr), rig);
  std::optional<Rig> moving = rig;
  std::shared_ptr<const ImuReadings> imu;
  if (rig->imu ||
      std::any_of(rig->scanners.begin(), rig->scanners.end(), [](const Scanner& scanner) {
        return scanner.mount || scanner.camera_row;
      })) {
    const RecordingReader reader(path, *rig);
    PlaceScanners(reader, &*moving);
    imu = reader.imu();
  }
  RecordingSurvey survey = SurveyRecording(path, &*moving);
  survey.imu = std::move(imu);
  return CheckSurvey(std::move(survey), moving);
}

bool SitAtOnePose(const Rig& rig) {
  const auto is_first = [&rig](const Scanner& scanner) {
    const Rigid3d& first = rig.scanners.front().body_from_scanner;
    const Rigid3d& pose = scanner.body_from_scanner;
    return pose.translation == first.translation &&
           pose.rotation.coeffs() == first.rotation.coeffs();
  };
  return rig.scanners.size() > 1 &&
         std::all_of(rig.scanners.begin(), rig.scanners.end(), is_first);
}

std::string InWords(const Finding& finding) {
  return OnOneLine((finding.subject.empty() ? "" : finding.subject + ": ") + finding.sentence +
                   (finding.advice.empty() ? "" : " (" + finding.advice + ")"));
}

CheckReport CheckSurvey(RecordingSurvey survey, const std::optional<Rig>& stated) {
  const std::optional<Rig> rig =
      stated ? std::make_optional(WithoutCameraRows(*stated)) : std::nullopt;
  CheckReport report;
  report.rig = rig;
  report.survey = std::move(survey);
  if (rig && rig->scanners.empty()) {
    report.mappable = Mappable::kInSpace;
    report.verdict = "can be mapped; images of depth cameras are not looked at before";
    return report;
  }
  std::vector<std::vector<SampledLine>> sample;
  for (size_t i = 0; i < report.survey.topics.size(); ++i) {
    sample.push_back(SegmentSample(report.survey.sample[i],
                                   std::max(kMinNoise, report.survey.topics[i].noise_m)));
  }
  report.doublings = FindDoublings(report.survey.sample);
  report.attitudes = JudgeAttitudes(sample);
  for (const std::vector<SampledLine>& lines : sample) {
    report.turns.push_back(CommonTurns(lines));
  }
  for (size_t i = 0; i < sample.size(); ++i) {
    report.nods.push_back(FindNod(report.survey.sample[i]));
    if (report.nods.back()) report.attitudes[i].attitude = Attitude::kNodding;
  }
  for (size_t i = 0; i < sample.size(); ++i) {
    const bool is_asked =
        rig ? !rig->odometry_topic.empty() : report.attitudes[i].attitude == Attitude::kLevel;
    report.moves.push_back(is_asked ? FindMoves(sample[i]) : std::vector<StepMove>());
    if (!rig) report.travel_directions.push_back(FindTravelDirection(report.moves[i]));
  }
  if (rig) {
    LookAtRig(sample, &report);
    FindNodsOfRig(&report);
  }
  if (report.survey.topics.empty()) {
    report.findings.push_back({Severity::kStop,
                               "",
                               "the recording has no topic with scan lines",
                               report.survey.other_topics.empty()
                                   ? "check that the scanners' topics were recorded"
                                   : "it has " + Enumerate(report.survey.other_topics) +
                                         "; record sensor_msgs/LaserScan"});
  }
  for (const std::string& warning : report.survey.warnings) {
    report.findings.push_back({Severity::kWarning, "", warning, ""});
    report.findings.back().is_told_by_reader = true;
  }
  FindTimingFaults(&report);
  FindRangeFaults(&report);
  FindWheelFaults(&report);
  FindRigFaults(&report);
  Judge(&report);
  return report;
}

}  // namespace plumbline
