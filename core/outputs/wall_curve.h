#pragma once

#include <Eigen/Core>
#include <cmath>

#include "core/result/result_types.h"

namespace plumbline {

// WallCurve is the level section of a surface in plan: the straight line n.x = d of a plane,
// or the arc of an upright cylinder. Points are known by their parameter s, m along the curve
// in the direction of the normal turned left by 90 degrees. The normal points to the side that
// was seen.
class WallCurve {
 public:
  WallCurve() = default;
  // The section of a surface at a height of the model frame, m. A plane must not be level.
  WallCurve(const PlanePatch& plane, double height_m);
  // The line through two points, with its normal to the left of the way from a to b.
  static WallCurve Through(const Eigen::Vector2d& a, const Eigen::Vector2d& b);

  bool IsArc() const { return radius_m_ > 0.0; }
  double radius_m() const { return radius_m_; }  // 0 for a line
  // +1 where the normal points away from the arc's axis, -1 where towards it.
  double side() const { return side_; }

  Eigen::Vector2d At(double s) const;
  double Parameter(const Eigen::Vector2d& p) const;
  Eigen::Vector2d NormalAt(const Eigen::Vector2d& p) const;
  double SignedDistance(const Eigen::Vector2d& p) const;

  // Calls visit(share, s) for each point where the piece from a to b crosses the curve; share:
  // 0 at a, 1 at b.
  template <typename Visit>
  void ForEachCrossing(const Eigen::Vector2d& a, const Eigen::Vector2d& b, Visit visit) const {
    if (!IsArc()) {
      const double from = normal_.dot(a) - distance_m_;
      const double to = normal_.dot(b) - distance_m_;
      if (from * to >= 0.0) return;
      const double share = from / (from - to);
      const Eigen::Vector2d p = a + share * (b - a);
      visit(share, normal_.x() * p.y() - normal_.y() * p.x());
      return;
    }
    const Eigen::Vector2d u = b - a;
    const Eigen::Vector2d from_axis = a - axis_;
    const double uu = u.squaredNorm();
    const double half = u.dot(from_axis);
    const double root = half * half - uu * (from_axis.squaredNorm() - radius_m_ * radius_m_);
    if (root <= 0.0 || uu <= 0.0) return;
    for (const double sign : {-1.0, 1.0}) {
      const double share = (-half + sign * std::sqrt(root)) / uu;
      if (share > 0.0 && share < 1.0) visit(share, Parameter(a + share * u));
    }
  }

 private:
  Eigen::Vector2d normal_ = Eigen::Vector2d::UnitX();  // of an arc: at s = 0
  double distance_m_ = 0.0;                            // of a line
  Eigen::Vector2d axis_ = Eigen::Vector2d::Zero();     // of an arc
  double radius_m_ = 0.0;
  double side_ = 1.0;
};

// The point near `start` that lies on both curves, by Newton's method; `start` itself where
// the curves are nearly parallel there, or the point would be more than max_shift_m away.
Eigen::Vector2d Meet(const WallCurve& a,
                     const WallCurve& b,
                     const Eigen::Vector2d& start,
                     double max_shift_m);

}  // namespace plumbline
