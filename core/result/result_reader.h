#pragma once

#include <string>
#include <vector>

#include "core/result/plane_covariance.h"
#include "core/result/result_types.h"

namespace plumbline {

// These functions read the text files of a result (docs/outputs.md). All throw Error with file
// and line, or with file and element.

std::vector<StampedPose> ReadTrajectory(const std::string& path);  // trajectory.tum
std::vector<PlanePatch> ReadPlanes(const std::string& path);       // planes.json

// Reads the instant from which the points' times count, the first scan line's of the recording,
// ns on the recording's clock, from summary.json. Throws Error where it is missing, as in
// results of earlier versions.
int64_t ReadStartTime(const std::string& path);

// Reads planes.json and plane_covariance.csv.
PlaneCovariance ReadPlaneCovariance(const std::string& result_directory);

}  // namespace plumbline
