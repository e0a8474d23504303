#include "core/map/scan_line_batches.h"

#include <glog/logging.h>

#include <deque>

namespace plumbline {
namespace {

constexpr size_t kLinesPerBlock = 8;

// Moves *next behind the elements of this scan line, which it is the first of.
template <typename Element>
void Pass(const std::deque<Element>& elements, int scan_line_index, size_t* next) {
  while (*next < elements.size() && elements[*next].scan_line_index == scan_line_index) {
    ++*next;
  }
}

}  // namespace

ScanLineBatchReader::ScanLineBatchReader(RecordingReader* recording, const MapState& state)
    : recording_(recording), state_(state) {
  recording->Rewind();
}

bool ScanLineBatchReader::Next(ScanLineBatch* block) {
  block->lines.resize(kLinesPerBlock);
  size_t num_lines = 0;
  while (num_lines < kLinesPerBlock && recording_->Next(&block->lines[num_lines].scan_line)) {
    ScanLineBatch::Line& line = block->lines[num_lines];
    line.first_observation = next_observation_;
    line.first_run = next_run_;
    line.first_moving = next_moving_;
    Pass(state_.observations, next_index_, &next_observation_);
    Pass(state_.sub_minimum_segments, next_index_, &next_run_);
    Pass(state_.moving_beams, next_index_, &next_moving_);
    line.last_observation = next_observation_;
    line.last_moving = next_moving_;
    line.last_run = next_run_;
    ++next_index_;
    ++num_lines;
  }
  block->lines.resize(num_lines);
  block->end_index = next_index_;
  if (num_lines > 0) return true;
  CHECK_EQ(next_observation_, state_.observations.size()) << "observations out of order";
  CHECK_EQ(next_moving_, state_.moving_beams.size()) << "moving beams out of order";
  CHECK_EQ(next_run_, state_.sub_minimum_segments.size())
      << "sub-minimum segments out of order";
  return false;
}

}  // namespace plumbline
