#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/outputs/beam_evidence.h"
#include "core/outputs/plan_subdivision.h"
#include "core/outputs/wall_faces.h"
#include "core/outputs/wall_stretches.h"

namespace plumbline {

// StoreyRegions is a storey cut into cells by the lines of its walls, and which cells are
// rooms.
struct StoreyRegions {
  std::vector<WallFace> faces;
  std::vector<Stretches> stretches;  // of each face
  PlanSubdivision plan;              // labels: position in faces, or negative
  std::vector<bool> is_free;         // of each cell
  std::vector<int> room_of_cell;     // -1: of none
  int num_rooms = 0;
  std::vector<bool> rig_in_cell;  // of each cell, whether the rig was there

  // Of a half-edge on a face, the shares of its length that are solid, closed (solid, bridged
  // or a door), open and unseen; all zero off the faces.
  struct EdgeShares {
    double solid = 0.0;
    double closed = 0.0;
    double open = 0.0;
    double unseen = 0.0;
  };
  EdgeShares SharesOf(const PlanSubdivision::HalfEdge& edge) const;
  double Length(const PlanSubdivision::HalfEdge& edge) const;
};

// Extends the walls to their intersections, calls every cell between them free or not, and
// joins free cells that no wall separates to rooms.
//
// The labels are those of least cost, in metres of wall. A wall's face has free space before
// it and none behind: as much of it as was hit counts against the opposite. Space that beams
// passed counts against being solid, 4 m for each square metre, and unseen space a little
// against being free. A border between free and solid costs its length where beams passed it,
// a third of that where nothing is known, and nothing where there is a wall.
//
// Cells at the box of all solid stretches of walls and beyond are outdoors and never free,
// unless the rig was in them or at least 1 m of walls looks into them: the end of a corridor
// that was not seen. way: the rig's positions in the storey.
StoreyRegions PlanStorey(std::vector<WallFace> faces,
                         const FreeGrid& free,
                         const std::vector<Eigen::Vector2d>& way);

}  // namespace plumbline
