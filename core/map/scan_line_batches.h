#pragma once

#include <cstddef>
#include <vector>

#include "core/map/map_state.h"
#include "core/sensor/recording.h"
#include "core/sensor/scan_line.h"

namespace plumbline {

// A few scan lines that follow each other in a recording, and the positions [first, last) of
// their observations, sub-minimum segments and moving beams in a map's state.
struct ScanLineBatch {
  struct Line {
    ScanLine scan_line;
    size_t first_observation = 0;
    size_t last_observation = 0;
    size_t first_run = 0;  // of the sub-minimum segments
    size_t last_run = 0;
    size_t first_moving = 0;  // of the beams that met something that moves
    size_t last_moving = 0;
  };

  std::vector<Line> lines;
  int end_index = 0;  // of the recording's scan line after these
};

// Reads a recording once more, from its beginning, a batch of scan lines at a time: enough for
// a thread to work on, and little to be kept.
class ScanLineBatchReader {
 public:
  ScanLineBatchReader(RecordingReader* recording, const MapState& state);

  // Reads the next batch; false at the end. The batch's memory is used again.
  bool Next(ScanLineBatch* block);

 private:
  RecordingReader* recording_;
  const MapState& state_;
  int next_index_ = 0;
  size_t next_observation_ = 0;
  size_t next_run_ = 0;
  size_t next_moving_ = 0;
};

}  // namespace plumbline
