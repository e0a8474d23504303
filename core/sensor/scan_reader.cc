#include "core/sensor/scan_reader.h"

#include <algorithm>
#include <utility>

#include "core/sensor/beam_instant.h"
#include "core/util/time.h"

namespace plumbline {

ScanReader::ScanReader(const Rig& rig, RecordingReader* recording)
    : rig_(rig), recording_(recording) {
  Fetch();
}

bool ScanReader::Fetch() {
  has_pending_ = recording_->Next(&pending_);
  ++pending_index_;
  return has_pending_;
}

bool ScanReader::Next(Scan* scan) {
  *scan = Scan();
  if (!has_pending_) return false;
  const int64_t first_stamp_ns = pending_.stamp_ns;
  std::vector<bool> seen(rig_.scanners.size(), false);
  while (has_pending_ && !seen[static_cast<size_t>(pending_.scanner_index)] &&
         (pending_.stamp_ns == first_stamp_ns ||  // a recording may be too short for a period
          SecondsBetween(first_stamp_ns, pending_.stamp_ns) < recording_->scan_period_s())) {
    seen[static_cast<size_t>(pending_.scanner_index)] = true;
    const int64_t start_ns = BeamInstant(pending_, 0, rig_);
    const int64_t end_ns = BeamInstant(pending_, pending_.num_beams() - 1, rig_);
    const bool first = scan->scan_lines.empty();
    scan->start_ns = first ? start_ns : std::min(scan->start_ns, start_ns);
    scan->end_ns = first ? end_ns : std::max(scan->end_ns, end_ns);
    scan->scan_line_indices.push_back(pending_index_);
    scan->scan_lines.push_back(std::move(pending_));
    Fetch();
  }
  return true;
}

}  // namespace plumbline
