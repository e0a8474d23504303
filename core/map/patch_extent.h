#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/geometry/cell_grid.h"

namespace plumbline {

// Where on its plane a landmark has been seen: occupied cells of a grid and the bounding
// rectangle, in fixed axes through an anchor on the plane. The anchor lies where the landmark
// was first seen, so that the coordinates stay put while the estimate of its direction
// improves.
class PatchExtent {
 public:
  using Cell = CellGrid::Cell;
  static constexpr double kCellSize = 0.25;  // m

  PatchExtent() = default;
  PatchExtent(const Eigen::Vector3d& anchor_world,
              const Eigen::Vector3d& u_axis,
              const Eigen::Vector3d& v_axis)
      : anchor_(anchor_world), u_axis_(u_axis), v_axis_(v_axis) {}

  // The straight piece from a to b (world) has been seen.
  void AddSegment(const Eigen::Vector3d& a_world, const Eigen::Vector3d& b_world);
  // Whether any part of the piece from a to b lies within max_gap_m of what has been seen.
  bool IsNear(const Eigen::Vector3d& a_world,
              const Eigen::Vector3d& b_world,
              double max_gap_m) const;
  bool IsNear(const PatchExtent& other, double max_gap_m) const;
  // The same for a piece that has been added itself: whether anything else has been seen
  // there.
  bool OthersAreNear(const Eigen::Vector3d& a_world,
                     const Eigen::Vector3d& b_world,
                     double max_gap_m) const;
  // The same for the bounding rectangles, quickly: true wherever IsNear() is.
  bool MayBeNear(const PatchExtent& other, double max_gap_m) const;
  // Whether the point lies within the bounding rectangle, or at most margin_m beyond it.
  bool IsWithin(const Eigen::Vector3d& p_world, double margin_m) const {
    return Contains(Project(p_world), margin_m);
  }
  // The same in the extent's axes, and what takes a point there.
  bool Contains(const Eigen::Vector2d& uv, double margin_m) const {
    return uv.x() >= min_.x() - margin_m && uv.y() >= min_.y() - margin_m &&
           uv.x() <= max_.x() + margin_m && uv.y() <= max_.y() + margin_m;
  }
  Eigen::Vector2d Project(const Eigen::Vector3d& p_world) const {
    const Eigen::Vector3d from_anchor = p_world - anchor_;
    return {u_axis_.dot(from_anchor), v_axis_.dot(from_anchor)};
  }
  // Whether the point lies where segments have been seen: on an occupied cell, or at most
  // margin_m beyond the bounding rectangle beside one.
  bool IsSeenAt(const Eigen::Vector3d& p_world, double margin_m) const;
  // Whether the bounding rectangle comes within reach_m of the point.
  bool IsWithinReach(const Eigen::Vector3d& p_world, double reach_m) const {
    const Eigen::Vector3d from_anchor = p_world - anchor_;
    const Eigen::Array2d p(u_axis_.dot(from_anchor), v_axis_.dot(from_anchor));
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
  // The occupied cell that the point lies on, within the given middle share of the bounding
  // rectangle's width (along u); nothing elsewhere.
  std::optional<Cell> MiddleCell(const Eigen::Vector3d& p_world, double middle_share) const;
  // Number of segments seen on each occupied cell.
  const CellGrid& cells() const { return cells_; }
  void Merge(const PatchExtent& other);

  bool empty() const { return cells_.num_occupied() == 0; }
  double area_m2() const;
  Eigen::Vector2d min_corner() const { return min_; }
  Eigen::Vector2d max_corner() const { return max_; }
  Eigen::Vector3d ToWorld(const Eigen::Vector2d& uv) const {
    return anchor_ + uv.x() * u_axis_ + uv.y() * v_axis_;
  }
  // Of the bounding rectangle: sides, middle, and half the diagonal.
  Eigen::Vector2d size() const { return max_ - min_; }
  Eigen::Vector3d Centre() const { return ToWorld(0.5 * (min_ + max_)); }
  double radius_m() const { return 0.5 * (max_ - min_).norm(); }
  const Eigen::Vector3d& anchor() const { return anchor_; }
  const Eigen::Vector3d& u_axis() const { return u_axis_; }
  const Eigen::Vector3d& v_axis() const { return v_axis_; }
  // A polygon in (u, v) around all that has been seen, counter-clockwise: of an upright patch
  // the bounding rectangle, of others the convex hull of the end points.
  std::vector<Eigen::Vector2d> Outline() const;

 private:
  bool is_upright() const { return v_axis_.z() > 0.5; }
  void AddCorner(const Eigen::Vector2d& p);
  // The cell of this extent that holds the middle of another extent's cell.
  Cell CellFrom(const PatchExtent& other, const Cell& cell) const;

  Eigen::Vector3d anchor_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d u_axis_ = Eigen::Vector3d::UnitX();
  Eigen::Vector3d v_axis_ = Eigen::Vector3d::UnitY();
  CellGrid cells_;
  // Not of upright patches; reduced to their hull now and then.
  std::vector<Eigen::Vector2d> hull_points_;
  Eigen::Vector2d min_ = Eigen::Vector2d::Constant(1e300);
  Eigen::Vector2d max_ = Eigen::Vector2d::Constant(-1e300);
};

}  // namespace plumbline
