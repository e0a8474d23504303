#pragma once

#include <vector>

#include "core/judging/sightings.h"
#include "core/map/map_state.h"
#include "core/sensor/rig.h"

namespace plumbline {

// RevisitOffset is the shift and turn of a second's segments, with or without a plane, against
// the planes that earlier visits saw at the same places.
struct RevisitOffset {
  int num_segments = 0;        // that could be compared
  double translation_m = 0.0;  // of the rigid motion that would take them onto those planes
  double rotation_rad = 0.0;   // about the vertical
  double near_share = 0.0;     // of the segments, on those planes as they stand
  double moved_share = 0.0;    // of the segments, on those planes after the motion
  int num_surfaces = 0;        // planes that it takes segments onto which lay off them

  // Whether the motion is a shift of the rig: it takes many more of the segments onto the
  // planes. Where only few are off, they lie on something else; where those of one plane alone
  // are, and turned, a door has moved.
  bool is_shift() const;
};

// Compares each second of the recording with what was seen `kVisitGap` seconds earlier and
// before: a small rigid motion (three shifts, a turn about the vertical) fitted with a robust
// loss. Directions that the common planes leave open are held. One element for each second.
std::vector<RevisitOffset> CompareVisits(const Rig& rig,
                                         const MapState& state,
                                         const Sightings& sightings,
                                         int64_t start_ns);

}  // namespace plumbline
