#pragma once

#include <Eigen/Core>
#include <vector>

namespace plumbline {

// PlanSegment is a straight piece that cuts the plan; label: of whoever put it there.
struct PlanSegment {
  Eigen::Vector2d a = Eigen::Vector2d::Zero();
  Eigen::Vector2d b = Eigen::Vector2d::Zero();
  int label = 0;
};

// PlanSubdivision is the plane cut into cells by segments. Every edge is two half-edges, each
// with the cell on its left. All numbers are positions in the vectors.
struct PlanSubdivision {
  struct HalfEdge {
    int origin = 0;
    int target = 0;
    int twin = 0;
    int next = 0;  // along the boundary of its cell
    int cell = 0;
    int label = 0;  // of its segment; the least where several lie on each other
  };
  struct Cell {
    std::vector<int> loops;  // one half-edge of each boundary loop
    bool is_unbounded = false;
  };
  std::vector<Eigen::Vector2d> points;
  std::vector<HalfEdge> half_edges;
  std::vector<Cell> cells;
};

// Cuts the plane by the segments, with exact arithmetic, so that cells are right however close
// the segments are. Segments of no length are left out.
PlanSubdivision Subdivide(const std::vector<PlanSegment>& segments);

}  // namespace plumbline
