#pragma once

#include <cstddef>
#include <vector>

#include "core/map/map_state.h"
#include "core/sensor/recording.h"
#include "core/sensor/scan_line.h"

namespace plumbline {

// Some scan lines that follow each other in a recording, and what a map's state holds of each:
// positions [first, last) in observations and sub_minimum_segments.
struct ScanLineBatch {
  struct Line {
    ScanLine scan_line;
    size_t first_observation = 0;
    size_t last_observation = 0;
    size_t first_run = 0;
    size_t last_run = 0;
  };

  std::vector<Line> lines;
  int end_index = 0;  // of the recording's scan line after these
};

// Goes through a recording once more, from its beginning, a block at a time: much for a thread
// to work on, and little to be kept.
class LineBlockReader {
 public:
  LineBlockReader(RecordingReader* recording, const MapState& state);

  // False at the end. The block's memory is used again.
  bool Next(ScanLineBatch* block);

 private:
  RecordingReader* recording_;
  const MapState& state_;
  int next_index_ = 0;
  size_t next_observation_ = 0;
  size_t next_run_ = 0;
};

}  // namespace plumbline
