#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/geometry/scan_plane_motion.h"
#include "core/map/landmark.h"
#include "core/map/landmark_view.h"
#include "core/sensor/scan_line.h"
#include "core/visibility/plane_set.h"
#include "core/visibility/plane_trace.h"

namespace plumbline {

// One end of a segment: its last beam, which way the beams leave it, and how far they are
// free.
struct FreeEnd {
  int beam = 0;
  int step = 1;                 // +1 at the last beam, -1 at the first
  int limit = 0;                // first beam beyond that is not the segment's to take
  int middle = 0;               // of the segment: what lies beyond is the other end's
  int neighbour_landmark = -1;  // of the segment that starts there
};

// The trace of a segment's plane on its scan line.
struct PlaneOnScanLine {
  const ScanLine& scan_line;
  const ScanPlacement& placement;  // at the end's instant
  const LandmarkView& plane;
  const Trace& trace;
};

// Where it meets another plane.
struct PlaneIntersection {
  int last;  // beam before it, counted outwards from the segment's end; inside: negative
  Trace other;
  const LandmarkView* plane;
  // Whether the segment's plane has been seen beyond, by more than segments that went on past
  // an edge for a few beams.
  bool goes_on;
  // It ends there, and the scanner does not see the face round the corner: beams beyond pass
  // both, to whatever lies behind.
  bool is_edge;
};

// Where a segment's plane meets those of the others that have been seen there, beyond the
// segment's middle; p_world: the segment's end. From outside inwards: where three planes meet,
// what lies beyond the first may be far from the second. The other side of a thin wall is left
// out: what was seen of it lies behind the plane, which goes on.
std::vector<PlaneIntersection> FindIntersections(const PlaneOnScanLine& own,
                                                 const Eigen::Vector3d& p_world,
                                                 const PlaneSet& others,
                                                 const FreeEnd& end);

}  // namespace plumbline
