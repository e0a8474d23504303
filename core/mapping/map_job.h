#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/mapping/mapper.h"
#include "core/result/point_cloud_writer.h"

namespace plumbline {

// The job of plumbline_map: one recording in, one directory of results out.
struct MapJob {
  std::string recording;  // of any format that OpenRecording() knows
  std::string rig;        // YAML
  std::string config;     // YAML, empty: defaults
  std::string version;    // of the program, for summary.json
  std::string output;     // directory
  int threads = 1;        // 0: as many as the machine has
  // Goes on where a run with the same inputs and output was killed after it had followed the
  // recording; an error where there is none, or one with other inputs.
  bool resume = false;
  // A checkpoint is written if following took at least this time.
  double checkpoint_after_s = 2.0;
  // Maps a recording although the rules of plumbline_check say that a wrong map comes of it;
  // what they say is a warning then.
  bool force = false;
  bool report = false;  // also write report.html, of each part one
  // Whether the result holds floor plans (core/outputs/floor_plan_files.h). A map without
  // rooms has none, which is logged.
  bool floor_plan = false;
  // The job asks this at every scan: once it says true, the map ends there and is written.
  std::function<bool()> stop = {};
  // Formats in which the points of the map are written.
  std::vector<CloudFormat> formats = ParseCloudFormats(kDefaultCloudFormats);
};

// Maps the recording and writes all files of docs/outputs.md, or none of them. Where the
// recording could only be mapped in parts, the longest one is written to the output directory,
// the others to folders part_1, part_2, ... in it, numbered in the order of time. Returns the
// summary of the longest part. Throws Error, also where the recording's clocks, headers or
// ranges, or the scanners' places in the rig file make a map meaningless (core/judging),
// unless forced.
Summary RunMapJob(const MapJob& job, const ProgressCallback& progress);

}  // namespace plumbline
