#pragma once

#include <optional>
#include <vector>

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
};

// Finds how a scanner nods from its lines, sorted by stamp; nothing where it does not, or by
// so little that ranges change as much by the way of the rig, or by its sway.
std::optional<Nod> FindNod(const std::vector<ScanLine>& lines);

}  // namespace plumbline
