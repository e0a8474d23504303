#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "core/map/map_state.h"
#include "core/window/window.h"

namespace plumbline {

// A part of the recording as following it has left it, before the batch.
struct FollowedPart {
  explicit FollowedPart(MapState state) : state(std::move(state)) {}

  MapState state;
  std::vector<int64_t> scan_times_ns;            // instant of each mapped scan
  std::vector<WindowEstimate> window_estimates;  // where the options ask for them
  double start_s = 0.0;                          // since the recording's start
  double end_s = 0.0;
  std::string ended_by;  // a sentence where the part ends before the recording; else empty
};

struct FollowedRecording {
  std::vector<FollowedPart> parts;  // in the order of time, at least one
  int num_skipped = 0;              // scans before the first part
  // Stretches followed for too short a time to be a part, and why they ended, and parts that
  // start later than they might, in words.
  std::vector<std::string> left_out;
};

// The inputs of a map, by name ("recording", "program"): the same inputs give the same map.
using MapInputs = std::vector<std::pair<std::string, std::string>>;

// Returns the inputs of a job: program and recording, each with its size and the time of its
// last change, and the texts of the rig file and of the settings in force.
MapInputs InputsOf(const std::string& recording,
                   const std::string& rig,
                   const std::string& options_yaml);

// Writes what has been followed to a file that appears whole. Throws Error.
void WriteCheckpoint(const MapInputs& inputs,
                     const std::string& path,
                     FollowedRecording* followed);
// Reads it back. Throws Error where the file is damaged, or of other inputs than these.
FollowedRecording ReadCheckpoint(const MapInputs& inputs, const std::string& path);

}  // namespace plumbline
