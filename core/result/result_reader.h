#pragma once

#include <string>
#include <vector>

#include "core/result/plane_covariance.h"
#include "core/result/result_types.h"

namespace plumbline {

// The functions below read the text files of a result (docs/outputs.md). All throw Error with
// file and line, or with file and element.

std::vector<StampedPose> ReadTrajectory(const std::string& path);  // trajectory.tum
std::vector<PlanePatch> ReadPlanes(const std::string& path);       // planes.json

// Reads the instant from which the points' times count, the first scan line's of the recording,
// ns on the recording's clock, from summary.json. Throws Error where it is missing, as in
// results of earlier versions.
int64_t ReadStartTime(const std::string& path);

// MapOrigin says of what a map was made, and how far it may be trusted, as summary.json has it.
// Texts are empty where it does not say: maps of earlier versions, and dates of clocks that
// were not set.
struct MapOrigin {
  std::string verdict;    // "consistent", "doubtful", "contradictory"
  std::string recording;  // file name
  std::string version;    // of the program that made the map
  std::string date;       // of the recording's start, UTC: "2026-11-27"

  bool IsTrusted() const { return verdict == "consistent"; }
};
MapOrigin ReadMapOrigin(const std::string& path);

// Reads planes.json and plane_covariance.csv.
PlaneCovariance ReadPlaneCovariance(const std::string& result_directory);

}  // namespace plumbline
