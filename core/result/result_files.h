#pragma once

#include <string>
#include <vector>

namespace plumbline {

// The names that a result has for its files (docs/outputs.md). In an output directory, files of
// these names belong to the result, and everything else to the user.
bool IsResultFile(const std::string& name);

// The rig file that the map was made with.
inline constexpr char kRigUsed[] = "rig_used.yaml";
// The rig as the recording has shown it, to be used next time; there is none where the rig
// file knows everything exactly.
inline constexpr char kRigCalibrated[] = "rig_calibrated.yaml";

// Name of the directory of the part'th part of a recording, from 1: "part_<part>".
std::string PartName(size_t part);
bool IsPartName(const std::string& name);

// The folders of parts in a directory of a result, in their order.
std::vector<std::string> PartsOf(const std::string& directory);

}  // namespace plumbline
