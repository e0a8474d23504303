#pragma once

#include <cstddef>
#include <cstdint>

#include "core/sensor/rig.h"
#include "core/sensor/scan_line.h"
#include "core/util/time.h"

namespace plumbline {

// Returns the instant of a beam on the rig's clock, the scanner's time offset included.
inline int64_t BeamInstant(const ScanLine& scan_line, int beam, const Rig& rig) {
  const auto scanner = static_cast<size_t>(scan_line.scanner_index);
  return scan_line.BeamTime(beam) +
         NanosecondsFromSeconds(rig.scanners[scanner].time_offset_s);
}

}  // namespace plumbline
