#pragma once

#include <vector>

#include "core/sensor/rig.h"
#include "core/sensor/scan_line.h"

namespace plumbline {

// StartSearch counts the scans that show what the mapper starts from: floor or ceiling and a
// wall, of a planar rig a wall.
struct StartSearch {
  int num_scans = 0;      // looked at
  int num_starts = 0;     // of these, that show it
  double tilt_deg = 0.0;  // median, of the body's z axis against the vertical found
};

// Looks at instants spread over the sample. lines: by scanner of the rig, sorted by stamp;
// their ranges are metres.
StartSearch FindStarts(const Rig& rig, const std::vector<const std::vector<ScanLine>*>& lines);

}  // namespace plumbline
