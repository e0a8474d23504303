#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/judging/doublings.h"
#include "core/judging/finding.h"
#include "core/judging/header_search.h"
#include "core/judging/mounting_fit.h"
#include "core/judging/mounting_search.h"
#include "core/judging/nodding.h"
#include "core/judging/recording_survey.h"
#include "core/judging/scanner_outlook.h"
#include "core/judging/start_search.h"
#include "core/judging/travel_direction.h"
#include "core/sensor/rig.h"

namespace plumbline {

// The kind of map that a recording allows.
enum class Mappable { kNot, kInThePlane, kInSpace };

// CheckReport is all that plumbline_check has found out.
struct CheckReport {
  RecordingSurvey survey;
  std::vector<Doubling> doublings;           // of topics of the survey
  std::vector<OwnAttitude> attitudes;        // by topic of the survey
  std::vector<std::vector<StepTurn>> turns;  // by topic
  std::vector<std::optional<Nod>> nods;      // by topic; none: it does not nod
  std::vector<std::vector<StepMove>>
      moves;  // by topic; with a rig file where it has wheels, else of level scanners
  // Directions of travel of level scanners, by topic; empty with a rig file.
  std::vector<std::optional<TravelDirection>> travel_directions;

  // The rig file; what follows needs it.
  std::optional<Rig> rig;
  std::vector<int> topics_of_scanners;  // by scanner: topic of the survey; -1: none
  std::vector<HeightView> heights;      // by scanner
  std::vector<PairAgreement> agreements;
  std::optional<OtherHeader> other_header;  // with which all that follows was found
  std::optional<OtherMounting> other_mounting;
  std::vector<MountingCorrection> corrections;  // by scanner of the rig; may be empty
  // Mountings under which all scanners agree, the body's held, by scanner of the rig; empty
  // where they agree as stated or stay apart, where one has no lines, and where none is
  // estimated.
  std::optional<MountedRig> near;
  StartSearch starts;
  // Delay of the wheels' stamps that their turns show, s; empty where it is stated, or where
  // the turns leave it open.
  std::optional<double> wheels_late_s;

  std::vector<Finding> findings;  // the gravest first
  // How a topic's scanner nods; none: it does not.
  std::optional<Nod> NodOf(size_t topic) const {
    return topic < nods.size() ? nods[topic] : std::nullopt;
  }
  Mappable mappable = Mappable::kNot;
  std::string verdict;  // one sentence
};

// Looks at a recording before it is mapped. Without a rig it tells what the scan lines show by
// themselves. Throws Error where the recording can not be read.
CheckReport CheckRecording(const std::string& path, const std::optional<Rig>& rig);

// Checks a recording that has been surveyed.
CheckReport CheckSurvey(RecordingSurvey survey, const std::optional<Rig>& rig);

// Whether all of several scanners sit at one pose, as in a rig file that was not filled in.
bool SitAtOnePose(const Rig& rig);

// The finding in words, on one line: "/scan: sentence (advice)".
std::string InWords(const Finding& finding);

}  // namespace plumbline
