#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/outputs/plan_scales.h"
#include "core/outputs/wall_faces.h"

namespace plumbline {

// The kind of a column of a wall's face.
enum class ColumnState {
  kUnseen,   // no beam says anything
  kOpen,     // beams pass through
  kSolid,    // beams hit the face
  kBridged,  // a gap in the face that the wall's line bridges: what is hidden, slits
  kDoor,     // a gap that separates rooms: a door, or an opening below a lintel
};

// DoorGap is a door, or a wide opening below a lintel, in one face: where along it, m.
struct DoorGap {
  double from_m = 0.0;
  double to_m = 0.0;
  double stddev_m = 0.0;       // of its width
  bool has_lintel = false;     // the face was hit above it
  bool reaches_floor = false;  // beams passed below where sills are
  bool leads_indoors = false;  // the rig went through, or beams, to a ceiling behind
};

// Stretches is a face, column by column: what is wall and what is not.
struct Stretches {
  std::vector<ColumnState> states;
  std::vector<bool> windows;  // solid below, and beams pass above
  std::vector<DoorGap> doors;

  bool IsClosed(size_t column) const {
    return states[column] == ColumnState::kSolid || states[column] == ColumnState::kBridged ||
           states[column] == ColumnState::kDoor;
  }
};

// Tells walls from openings on all faces of a storey. A gap of 0.6 to 1.5 m through which
// beams pass is a door where the face was hit above it, or where the opposite face has a door.
// Else the gap has to be one between two stretches of the face that are at least 0.3 m long,
// and must not be as wide as a room: bounded on both sides by walls that go on. Wider gaps (up
// to 8 m) are closed in the same way where the face was hit above nearly all of them. Shorter
// gaps are bridged, and so are wider ones, up to 8 m, that no beam passed, or that beams
// passed only to end within 0.6 m on what is no wall: windows, with what stands in their
// recess. A gap below which more beams hit the face than passed it, up to 0.8 m above
// the floor, has a sill: it is a window, whatever its width, unless the rig went through. So
// is what is narrower than a door, where beams pass and meet no ceiling: a pane beside a post.
// Other gaps stay open, and so does where furniture ends below the ceiling.
std::vector<Stretches> FindStretches(const std::vector<WallFace>& faces);

// The intersection of two faces: the parameters on both, m. None where they are nearly
// parallel.
struct FaceCrossing {
  size_t face = 0;  // the other one
  double s = 0.0;
  double other_s = 0.0;
};
std::vector<FaceCrossing> CrossingsOf(size_t face, const std::vector<WallFace>& faces);

// A stretch of a face whose columns are solid, from the first hit to the last, m.
struct SolidRun {
  double from_m = 0.0;
  double to_m = 0.0;
};
std::vector<SolidRun> SolidRuns(const WallFace& face, const Stretches& stretches);

}  // namespace plumbline
