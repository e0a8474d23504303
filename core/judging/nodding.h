#pragma once

#include <optional>
#include <vector>

#include "core/sensor/imu.h"
#include "core/sensor/rig.h"
#include "core/sensor/scan_line.h"

namespace plumbline {

// Nod is the motion of a scanner on a mount against the rig, as its own ranges show it: they
// come back after a period, and are others after half of it.
struct Nod {
  double period_s = 0.0;
  // Of the axis in the scan plane, from the direction of angle 0, in -pi/2 .. pi/2: ranges
  // along the axis change least.
  double axis_rad = 0.0;
  // Mean change of the ranges as a share of them, half a period later and a whole one.
  double changed_share = 0.0;
  double returned_share = 0.0;
  bool is_of_rig = false;  // the rig nods, and the scanner with it
};

// Finds how a scanner nods from its lines, sorted by stamp; nothing where it does not, or by
// so little that ranges change as much by the way of the rig, or by its sway.
std::optional<Nod> FindNod(const std::vector<ScanLine>& lines);

// Whether the rig itself turns so, as its gyroscope reads: half a period after most of the
// lines it has turned about the nod's axis as far as scan planes do that are not parallel.
bool IsOfRig(const Nod& nod,
             const std::vector<ScanLine>& lines,
             const Scanner& scanner,
             const Imu& imu,
             const ImuReadings& readings);

}  // namespace plumbline
