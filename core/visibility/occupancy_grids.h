#pragma once

#include <Eigen/Core>
#include <array>
#include <deque>
#include <vector>

#include "core/geometry/cell_grid.h"
#include "core/geometry/scan_plane_motion.h"
#include "core/map/landmark.h"
#include "core/map/plane_axes.h"

namespace plumbline {

// The openings of one plane, ready to be asked for every beam.
class PlaneOpenings {
 public:
  bool none() const { return nearby_.num_occupied() == 0; }
  // Whether the plane has been seen at different heights. Level scan planes alone see
  // furniture as often as walls, with gaps that are no openings.
  bool has_height() const { return has_height_; }
  bool IsAt(const Eigen::Vector3d& p_world) const { return IsAtLocal(axes_.Project(p_world)); }
  // The same in the plane's axes, with what takes a point of the scan plane there:
  // (u, v) = OnAxes(placement) (x, y, 1).
  bool IsAtLocal(const Eigen::Vector2d& uv) const;
  Eigen::Matrix<double, 2, 3> OnAxes(const ScanPlacement& placement) const {
    Eigen::Matrix<double, 2, 3> on_axes;
    on_axes << axes_.u.transpose() * placement, axes_.v.transpose() * placement;
    on_axes.col(2) -= Eigen::Vector2d(axes_.u.dot(axes_.anchor), axes_.v.dot(axes_.anchor));
    return on_axes;
  }
  // Quickly: false where none is within a quarter of a metre of the piece from a to b.
  bool MayBeAlong(const Eigen::Vector3d& a_world, const Eigen::Vector3d& b_world) const;

 private:
  friend class OccupancyGrids;
  // What has become of the beams that met the plane in a cell, as a grid's count.
  enum State {
    kUnknown = 0,
    kSolid,  // all stayed on it, at the next cells too; close to openings only
    kMixed,  // some did not
    kOpen,   // most did not
  };
  void Mark(const CellGrid::Cell& cell, bool narrow_along_u, State state);
  // Whether any opening lies where this cell does, or beside it.
  bool IsNearby(const CellGrid::Cell& cell, bool narrow_along_u) const;

  bool has_height_ = false;
  PlaneAxes axes_;
  std::array<CellGrid, 2> states_;  // of the cells narrow along u, along v
  CellGrid nearby_;                 // wide cells in which any open or mixed one lies
};

// Counts the beams of segments that were taken to lie on a plane, those beside their ends that
// went through and those that something in front of it stopped. Where a wall ends at a door,
// beams on its jamb may pass for the wall's, or the floor's, seen from one place; from others
// the beams go through, or are stopped.
//
// Counted twice, on cells that are narrow along u and on cells that are narrow along v:
// openings have upright and level edges, and few beams pass close to one of them. A cell that
// lies across an edge is mixed: there the other kind's tells on which side a place is.
class OccupancyGrids {
 public:
  // num_beams: that one stands for.
  void CountHit(const Landmark& landmark, const Eigen::Vector3d& p_world, int num_beams = 1);
  void CountPassage(const Landmark& landmark,
                    const Eigen::Vector3d& p_world,
                    int num_beams = 1);
  // What another has counted of the same landmarks.
  void Add(OccupancyGrids other);
  // Where more than a tenth of the beams (half of them, of a plane without height) went
  // through here or at the next cell; not where most
  // stayed and those that meet the plane in the other kind's cell all do. What is solid lets
  // none through, whatever the noise; but most beams that seem to lie in an opening are the
  // jambs'. Goes on along upright edges by one cell where hardly any beam tells otherwise.
  PlaneOpenings OpeningsOf(const Landmark& landmark) const;
  // The same of all of them, by id: a fraction of what the counts take.
  std::vector<PlaneOpenings> OpeningsOf(const std::deque<Landmark>& landmarks) const;

 private:
  struct Counts {
    CellGrid hits;
    CellGrid passages;
  };

  // Counts on the cells that are narrow along u, along v.
  using CountsOfPlane = std::array<Counts, 2>;
  void Count(const Landmark& landmark,
             const Eigen::Vector3d& p_world,
             int num_beams,
             CellGrid Counts::*grid);
  static void MarkOpen(const Counts& counts, bool narrow_along_u, PlaneOpenings* openings);
  static void MarkSolid(const Counts& counts, bool narrow_along_u, PlaneOpenings* openings);

  std::vector<CountsOfPlane> counts_;  // by landmark id
};

}  // namespace plumbline
