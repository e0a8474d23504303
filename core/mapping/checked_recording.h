#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/judging/finding.h"
#include "core/result/result_types.h"
#include "core/sensor/recording.h"
#include "core/sensor/rig.h"
#include "core/util/stopwatch.h"

namespace plumbline {

// CheckedRecording is a recording as it is mapped, with the findings of plumbline_check.
struct CheckedRecording {
  Rig stated;  // the rig file's
  // The rig with the headers that the scanners' common view shows, and with scanners that are
  // estimated near where they agree.
  Rig rig;
  std::unique_ptr<RecordingReader> reader;
  std::vector<Finding> findings;  // the gravest first, no notes
};

// Throws Error where all scanners of a rig file sit at one pose: it was not filled in.
void CheckPoses(const std::string& rig_file, const Rig& rig);

// Reads and checks a recording; reading: takes the time of the first reading. Throws Error
// where the recording can not be read, and where a wrong map would come of it, unless force.
CheckedRecording ReadChecked(const std::string& recording,
                             Rig rig,
                             bool force,
                             Stopwatch* reading);

// Returns the warnings that the recording's reader does not give itself.
std::vector<std::string> WarningsOf(const std::vector<Finding>& findings);

// Adds what was found before mapping to the warnings, and where the map is not consistent
// names as the likeliest cause the first of it by which no right map comes.
void AddFindings(const std::vector<Finding>& findings, Summary* summary);

}  // namespace plumbline
