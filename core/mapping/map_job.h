#pragma once

#include <string>

#include "core/mapping/mapper.h"

namespace plumbline {

// The job of plumbline_map: one recording in, one directory of results out.
struct MapJob {
  std::string recording;  // ROS 1 bag
  std::string rig;        // YAML
  std::string config;     // YAML, empty: defaults
  std::string output;     // directory
  int threads = 1;        // 0: as many as the machine has
};

// Maps the recording and writes all files of docs/outputs.md, or none of them. Throws Error.
Summary RunMapJob(const MapJob& job, const ProgressCallback& progress);

}  // namespace plumbline
