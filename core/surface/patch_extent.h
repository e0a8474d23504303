#pragma once

#include <Eigen/Core>
#include <cmath>
#include <utility>
#include <vector>

#include "core/geometry/plane_axes.h"
#include "core/surface/cell_grid.h"

namespace plumbline {

// The part of its plane on which a landmark has been seen: the occupied cells of a grid and
// their bounding rectangle, in axes through an anchor on the plane. The anchor lies where the
// landmark was first seen, so that the coordinates stay put while the estimate of its
// direction improves.
class PatchExtent {
 public:
  using Cell = CellGrid::Cell;
  static constexpr double kCellSize = 0.25;  // m

  // The cell that a point in the extent's axes lies in.
  static Cell CellAt(const Eigen::Vector2d& uv) {
    return {CellIndex(uv.x() / kCellSize), CellIndex(uv.y() / kCellSize)};
  }

  PatchExtent() = default;
  PatchExtent(const Eigen::Vector3d& anchor_world,
              const Eigen::Vector3d& u_axis,
              const Eigen::Vector3d& v_axis,
              double curvature = 0.0)
      : axes_{anchor_world, u_axis, v_axis, curvature} {}

  // Marks the straight piece from a to b as seen.
  void AddSegment(const Eigen::Vector3d& a_world, const Eigen::Vector3d& b_world);
  // Marks all that has been seen of another extent, on the same plane, as seen.
  void Merge(const PatchExtent& other);

  // Whether any part of the piece from a to b lies within max_gap_m of what has been seen.
  bool IsNear(const Eigen::Vector3d& a_world,
              const Eigen::Vector3d& b_world,
              double max_gap_m) const;
  // Whether any part of the other extent lies within max_gap_m of what has been seen.
  bool IsNear(const PatchExtent& other, double max_gap_m) const;
  // Whether anything besides the piece from a to b, which has been added itself, has been seen
  // within max_gap_m of it.
  bool OthersAreNear(const Eigen::Vector3d& a_world,
                     const Eigen::Vector3d& b_world,
                     double max_gap_m) const;
  // Whether the bounding rectangles may come within max_gap_m of each other: quick, and true
  // wherever IsNear() is.
  bool MayBeNear(const PatchExtent& other, double max_gap_m) const;
  // Whether a point in the extent's axes lies within the bounding rectangle, or at most
  // margin_m beyond it.
  bool Contains(const Eigen::Vector2d& uv, double margin_m) const {
    return uv.x() >= min_.x() - margin_m && uv.y() >= min_.y() - margin_m &&
           uv.x() <= max_.x() + margin_m && uv.y() <= max_.y() + margin_m;
  }
  // Whether the point lies where segments have been seen: on an occupied cell, or at most
  // margin_m beyond the bounding rectangle beside one.
  bool IsSeenAt(const Eigen::Vector3d& p_world, double margin_m) const;
  // Whether the bounding rectangle comes within reach_m of the point.
  bool IsWithinReach(const Eigen::Vector3d& p_world, double reach_m) const {
    const Eigen::Vector3d from_anchor = p_world - axes_.anchor;
    if (axes_.curvature != 0.0) {
      const double sphere_m = reach_m + radius_m();
      return (p_world - Centre()).squaredNorm() <= sphere_m * sphere_m;
    }
    const Eigen::Array2d p(axes_.u.dot(from_anchor), axes_.v.dot(from_anchor));
    const double away2 =
        (min_.array() - p).max(p - max_.array()).max(0.0).matrix().squaredNorm();
    const double across2 = from_anchor.squaredNorm() - p.matrix().squaredNorm();
    return away2 + across2 <= reach_m * reach_m;
  }
  // Whether the patch goes on beyond a point on it along a unit vector: within three metres
  // many segments have been seen again. A few that went on past an edge do not count.
  bool GoesOnBeyond(const Eigen::Vector3d& p_world,
                    const Eigen::Vector3d& direction_world) const;
  // Share of this extent's cells that the other one occupies too.
  double OverlapWith(const PatchExtent& other) const;

  // A point in the extent's axes; round an arc, the coordinate nearest to what has been seen.
  Eigen::Vector2d Project(const Eigen::Vector3d& p_world) const {
    Eigen::Vector2d uv = axes_.Project(p_world);
    if (axes_.curvature != 0.0) {
      const double middle = 0.5 * (min_.x() + max_.x());
      uv.x() = middle + std::remainder(uv.x() - middle, axes_.Circumference());
    }
    return uv;
  }
  // Number of segments seen on each occupied cell.
  const CellGrid& cells() const { return cells_; }
  bool empty() const { return cells_.num_occupied() == 0; }
  double area_m2() const;
  // The bounding rectangle, and a sphere around it.
  Eigen::Vector2d min_corner() const { return min_; }
  Eigen::Vector2d max_corner() const { return max_; }
  Eigen::Vector3d Centre() const { return ToWorld(0.5 * (min_ + max_)); }
  double radius_m() const { return 0.5 * (max_ - min_).norm(); }
  // A solid about the centre that holds all that has been seen: a rectangle with these halves
  // of its sides, as vectors in the world, and a ball about each of its points. Of an arc it
  // is the ball alone.
  struct Bounds {
    Eigen::Vector3d half_u = Eigen::Vector3d::Zero();
    Eigen::Vector3d half_v = Eigen::Vector3d::Zero();
    double ball_m = 0.0;
  };
  Bounds BoundsAboutCentre() const;
  // A polygon in (u, v) around all that has been seen, counter-clockwise: of an upright patch
  // the bounding rectangle, of others the convex hull of the end points.
  std::vector<Eigen::Vector2d> Outline() const;

  const PlaneAxes& axes() const { return axes_; }
  Eigen::Vector3d ToWorld(const Eigen::Vector2d& uv) const { return axes_.ToWorld(uv); }

  // Calls visit(member) for each: to keep them in a file and take them back.
  template <typename Visit>
  void VisitMembers(Visit& visit) {
    visit(axes_.anchor);
    visit(axes_.u);
    visit(axes_.v);
    visit(axes_.curvature);
    cells_.VisitMembers(visit);
    visit(hull_points_);
    visit(min_);
    visit(max_);
  }

 private:
  bool is_upright() const { return axes_.v.z() > 0.5; }
  void AddCorner(const Eigen::Vector2d& p);
  // Both ends of a straight piece, along an arc the shorter way round.
  std::pair<Eigen::Vector2d, Eigen::Vector2d> ProjectPiece(
      const Eigen::Vector3d& a_world, const Eigen::Vector3d& b_world) const;
  // The cell of this extent that holds the middle of another extent's cell.
  Cell CellFrom(const PatchExtent& other, const Cell& cell) const;

  PlaneAxes axes_;
  CellGrid cells_;
  // End points of the pieces seen, reduced to their hull now and then; none of upright
  // patches.
  std::vector<Eigen::Vector2d> hull_points_;
  Eigen::Vector2d min_ = Eigen::Vector2d::Constant(1e300);
  Eigen::Vector2d max_ = Eigen::Vector2d::Constant(-1e300);
};

// Points at which another surface of the same kind is compared with what was seen: the middle,
// and of an arc both ends, too.
std::vector<Eigen::Vector3d> ComparedPoints(const PatchExtent& extent);

}  // namespace plumbline
