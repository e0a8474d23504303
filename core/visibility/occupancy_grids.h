#pragma once

#include <Eigen/Core>
#include <array>
#include <deque>
#include <vector>

#include "core/geometry/plane_axes.h"
#include "core/geometry/scan_plane_motion.h"
#include "core/surface/cell_grid.h"
#include "core/surface/landmark.h"
#include "core/visibility/place_deviations.h"

namespace plumbline {

// The openings of one plane, in a form in which every beam can be looked up.
class PlaneOpenings {
 public:
  // Whether the plane has no openings.
  bool none() const { return nearby_.num_occupied() == 0; }
  // Whether the plane has been seen at different heights. Level scan planes alone see
  // furniture as often as walls, with gaps that are no openings.
  bool has_height() const { return has_height_; }
  // Whether the point lies in an opening.
  bool IsAt(const Eigen::Vector3d& p_world) const { return IsAtLocal(axes_.Project(p_world)); }
  // Whether a point in the plane's axes lies in an opening.
  bool IsAtLocal(const Eigen::Vector2d& uv) const;
  // The matrix that takes a point of the scan plane to the plane's axes:
  // (u, v) = OnAxes(placement) (x, y, 1).
  Eigen::Matrix<double, 2, 3> OnAxes(const ScanPlacement& placement) const {
    Eigen::Matrix<double, 2, 3> on_axes;
    on_axes << axes_.u.transpose() * placement, axes_.v.transpose() * placement;
    on_axes.col(2) -= Eigen::Vector2d(axes_.u.dot(axes_.anchor), axes_.v.dot(axes_.anchor));
    return on_axes;
  }
  // Whether an opening may lie along the piece from a to b: quick, and false where none is
  // within a quarter of a metre of it.
  bool MayBeAlong(const Eigen::Vector3d& a_world, const Eigen::Vector3d& b_world) const;

 private:
  friend class OccupancyGrids;
  // The state of a cell by the beams that met the plane there, kept as a grid's count.
  enum State {
    kUnknown = 0,
    kSolid,  // all beams lay on the plane, at the next cells too; close to openings only
    kMixed,  // some beams did not
    kOpen,   // most beams did not
  };
  void Mark(const CellGrid::Cell& cell, bool narrow_along_u, State state);
  // Whether any opening lies where this cell does, or beside it.
  bool IsNearby(const CellGrid::Cell& cell, bool narrow_along_u) const;

  bool has_height_ = false;
  PlaneAxes axes_;
  std::array<CellGrid, 2> states_;  // of the cells narrow along u, along v
  CellGrid nearby_;                 // wide cells in which any open or mixed one lies
};

// A level of a surface that holds two: the cells of which the beams lie on another one.
struct LevelOnSurface {
  int landmark_id = 0;                   // of the surface
  double step_m = 0.0;                   // from it
  std::vector<PatchExtent::Cell> cells;  // in order
  PlaneOpenings elsewhere;  // where the beams do not lie on this level, as its openings
};

// The occupancy grids of the planes count the beams of segments that lie on a plane (hits) and
// the beams beside the segments' ends that went through it (passages). Seen from one place,
// beams on the jamb of a door may pass for beams on the wall; seen from others, the beams
// there go through.
//
// Each plane has two grids, of cells that are narrow along u and of cells that are narrow
// along v (planes without height only the first): openings have upright and level edges, and
// few beams pass close to one of them. A cell that lies across an edge is mixed: there the
// cell of the other grid shows on which side a place is.
class OccupancyGrids {
 public:
  // Counts a beam that lies on the plane, or one that passes through it; none far from the
  // seen part. num_beams: the number of beams that this one stands for.
  void CountHit(const Landmark& landmark, const Eigen::Vector3d& p_world, int num_beams = 1);
  void CountPassage(const Landmark& landmark,
                    const Eigen::Vector3d& p_world,
                    int num_beams = 1);
  // Counts what a beam that lies on the plane deviates by from it along the normal, and the
  // standard deviation of its noise there.
  void CountDeviation(const Landmark& landmark,
                      const Eigen::Vector3d& p_world,
                      double deviation_m,
                      double stddev_m);
  // Adds the counts of another's grids of the same landmarks.
  void Add(OccupancyGrids other);
  // Returns the openings of a plane. A cell, and the next ones along its narrow side, is mixed
  // if more than a tenth of its beams (half of them, for a plane without height) went through,
  // and open if most did. A place is in an opening if its cell in either grid is open, or is
  // mixed while that of the other grid is not solid (all its beams, and those of the next
  // cells, hit). A solid plane lets no beam through, whatever the noise; but most beams that
  // seem to lie in an opening lie on its jambs. An opening goes on along upright edges by one
  // cell where hardly any beam hits.
  PlaneOpenings OpeningsOf(const Landmark& landmark) const;
  // The openings of all landmarks, by id: they take a fraction of the counts' memory. Places
  // whose beams do not lie on the plane that the others show (FindLevels) are openings, too:
  // something stands close before or behind the plane there. flatness_m: the least unevenness
  // of surfaces that are no walls. levels: gets the levels that such places form, but for
  // those that are edges only, in the order of the landmarks.
  std::vector<PlaneOpenings> OpeningsOf(const std::deque<Landmark>& landmarks,
                                        double flatness_m,
                                        std::vector<LevelOnSurface>* levels) const;

 private:
  struct Counts {
    CellGrid hits;
    CellGrid passages;
  };

  // The counts on the cells that are narrow along u, and along v.
  using CountsOfPlane = std::array<Counts, 2>;
  void Count(const Landmark& landmark,
             const Eigen::Vector3d& p_world,
             int num_beams,
             CellGrid Counts::*grid);
  static void MarkOpen(const Counts& counts, bool narrow_along_u, PlaneOpenings* openings);
  static void MarkSolid(const Counts& counts, bool narrow_along_u, PlaneOpenings* openings);

  static PlaneOpenings EmptyOpenings(const Landmark& landmark);
  // Marks the cells beside a level, and those of it that the edge may run through. Returns
  // whether it has others.
  static bool MarkElsewhere(const CellGrid& seen, LevelOnSurface* level);
  static void MarkOff(const CellGrid::Cell& cell, PlaneOpenings* openings);

  std::vector<CountsOfPlane> counts_;        // by landmark id
  std::vector<PlaceDeviations> deviations_;  // by landmark id
};

}  // namespace plumbline
