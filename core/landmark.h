#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "core/cell_grid.h"
#include "factors/plane_model.h"

namespace plumbline {

// Planes whose normals' cosine is larger form no corner: their crossing says hardly where.
inline constexpr double kMaxCornerCosine = 0.7;

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

// A plane of the building that is being estimated, and what is known of it.
struct Landmark {
  int id = 0;
  PlaneModel model = PlaneModel::kVertical;
  double sign = 1.0;                      // horizontal planes: normal = sign * e_z
  std::array<double, 4> parameters = {};  // see factors/plane_model.h
  bool heading_fixed = false;             // the gauge's wall: its angle is not estimated
  PatchExtent extent;
  // Of the parameters, given the rig's current pose: what association tests need.
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
  int first_scan = 0;
  int last_scan = 0;
  int64_t first_time_ns = 0;
  int64_t last_time_ns = 0;
  int num_segments = 0;
  int64_t num_points = 0;
  // How the first segments that were found on it agreed with it: the sum of their squared
  // deviations over the variances then stated, two degrees of freedom each.
  double sum_deviations = 0.0;
  int num_judged = 0;

  bool IsJudged() const;  // enough of them are known
  void Judge(double squared_deviation) {
    sum_deviations += squared_deviation;
    ++num_judged;
  }
  // Whether they agree by no more than this mean, where two is expected. A slant across a
  // corner, which short segments make believe, lies elsewhere as soon as the rig does.
  bool AgreesWithin(double mean_deviation) const;
  // An empty extent with its axes on the plane as it is estimated now.
  PatchExtent EmptyExtent() const;
  int num_parameters() const { return PlaneModelSize(model); }
  Eigen::Vector3d Normal() const;
  double Distance() const;
  double SignedDistance(const Eigen::Vector3d& p_world) const {
    return Normal().dot(p_world) - Distance();
  }
  // Derivative of n.p - d (at a point, per metre along a direction) by the parameters; columns
  // beyond num_parameters() are zero.
  Eigen::Matrix2d DeviationJacobian(const Eigen::Vector3d& p_world,
                                    const Eigen::Vector3d& direction_world) const;
};

// A landmark as tests of many observations look at it: what they ask for at hand, in one
// place. Valid while the landmark stands still.
struct LandmarkCandidate {
  const Landmark* landmark;
  Eigen::Vector3d normal;
  double distance;
  // A sphere around all that has been seen of it: of hundreds of planes a scan reaches a few,
  // and most others are told by it, without a look at the landmark itself.
  Eigen::Vector3d centre_world;
  double radius_m;
  // Halves of the sides of the rectangle around it.
  Eigen::Vector3d half_u;
  Eigen::Vector3d half_v;
  bool is_vertical;
  bool heading_fixed;
  Eigen::Matrix2d covariance;

  explicit LandmarkCandidate(const Landmark& of);
  double SignedDistance(const Eigen::Vector3d& p_world) const {
    return normal.dot(p_world) - distance;
  }
  // Variance of the signed distance of a point (m^2), the point taken as given.
  double DistanceVariance(const Eigen::Vector3d& p_world) const {
    if (!is_vertical) return covariance(0, 0);
    const double along =
        heading_fixed ? 0.0 : normal.x() * p_world.y() - normal.y() * p_world.x();
    return along * (along * covariance(0, 0) - 2.0 * covariance(0, 1)) + covariance(1, 1);
  }
  // See Landmark::DeviationJacobian.
  Eigen::Matrix2d DeviationJacobian(const Eigen::Vector3d& p_world,
                                    const Eigen::Vector3d& direction_world) const;
};

// A horizontal landmark through a point; sign +1 seen from above.
Landmark MakeHorizontalLandmark(double sign, const Eigen::Vector3d& p_world);
// A vertical landmark through a point with the given horizontal normal.
Landmark MakeVerticalLandmark(const Eigen::Vector3d& normal_world,
                              const Eigen::Vector3d& p_world);

}  // namespace plumbline
