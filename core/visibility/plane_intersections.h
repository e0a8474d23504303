#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/geometry/scan_plane_motion.h"
#include "core/sensor/scan_line.h"
#include "core/surface/landmark.h"
#include "core/surface/landmark_view.h"
#include "core/visibility/plane_set.h"
#include "core/visibility/plane_trace.h"

namespace plumbline {

// One end of a segment: its last beam, the direction in which the beams leave it, and how far
// they are free.
struct FreeEnd {
  int beam = 0;
  int step = 1;                 // +1 at the last beam, -1 at the first
  int limit = 0;                // first beam beyond that belongs to another segment
  int middle = 0;               // beam in the middle of the segment
  int neighbour_landmark = -1;  // of the segment that starts at the limit
};

// The trace of a segment's plane on its scan line.
struct PlaneOnScanLine {
  const ScanLine& scan_line;
  const ScanPlacement& placement;  // at the end's instant
  const LandmarkView& plane;
  const Trace& trace;
};

// The place where the trace of a segment's plane meets another plane.
struct PlaneIntersection {
  int last;  // beam before it, counted outwards from the segment's end; inside: negative
  Trace other;
  bool at_wall;  // the other plane is one
  // Whether the segment's plane has been seen beyond, by more than segments that went on past
  // an edge for a few beams.
  bool goes_on;
  // Whether the segment's plane ends there and the scanner does not see the face round the
  // corner: beams beyond pass both planes, to whatever lies behind.
  bool is_edge;
};

// Finds the intersections of a segment's plane with the other planes, where these have been
// seen and beyond the segment's middle; p_world: the segment's end. They are ordered from
// outside inwards: where three planes meet, a place beyond the first may be far from the
// second. The other side of a thin wall is left out: what was seen of it lies behind the
// plane, which goes on.
std::vector<PlaneIntersection> FindIntersections(const PlaneOnScanLine& own,
                                                 const Eigen::Vector3d& p_world,
                                                 const PlaneSet& others,
                                                 const FreeEnd& end);

}  // namespace plumbline
