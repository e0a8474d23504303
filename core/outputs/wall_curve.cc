#include "core/outputs/wall_curve.h"

#include <glog/logging.h>

#include <Eigen/LU>

namespace plumbline {
namespace {

Eigen::Vector2d TurnedLeft(const Eigen::Vector2d& v) { return {-v.y(), v.x()}; }

}  // namespace

WallCurve::WallCurve(const PlanePatch& plane, double height_m) {
  const double level = plane.normal.head<2>().norm();
  CHECK_GT(level, 0.0) << "plane " << plane.id << " is level";
  normal_ = plane.normal.head<2>() / level;
  distance_m_ = (plane.distance - plane.normal.z() * height_m) / level;
  if (!plane.IsCurved()) return;
  axis_ = plane.AxisPoint().head<2>();
  radius_m_ = plane.Radius();
  side_ = plane.curvature > 0.0 ? 1.0 : -1.0;
}

WallCurve WallCurve::Through(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  WallCurve curve;
  curve.normal_ = TurnedLeft((b - a).normalized());
  curve.distance_m_ = curve.normal_.dot(a);
  return curve;
}

Eigen::Vector2d WallCurve::At(double s) const {
  if (!IsArc()) return distance_m_ * normal_ + s * TurnedLeft(normal_);
  const double turn = s / radius_m_;
  const Eigen::Vector2d normal =
      std::cos(turn * side_) * normal_ + std::sin(turn * side_) * TurnedLeft(normal_);
  return axis_ + side_ * radius_m_ * normal;
}

double WallCurve::Parameter(const Eigen::Vector2d& p) const {
  if (!IsArc()) return TurnedLeft(normal_).dot(p);
  const Eigen::Vector2d normal = NormalAt(p);
  return side_ * radius_m_ * std::atan2(TurnedLeft(normal_).dot(normal), normal_.dot(normal));
}

Eigen::Vector2d WallCurve::NormalAt(const Eigen::Vector2d& p) const {
  return IsArc() ? Eigen::Vector2d(side_ * (p - axis_).normalized()) : normal_;
}

double WallCurve::SignedDistance(const Eigen::Vector2d& p) const {
  return IsArc() ? side_ * ((p - axis_).norm() - radius_m_) : normal_.dot(p) - distance_m_;
}

Eigen::Vector2d Meet(const WallCurve& a,
                     const WallCurve& b,
                     const Eigen::Vector2d& start,
                     double max_shift_m) {
  constexpr int kSteps = 5;          // one is exact for lines; arcs converge quadratically
  constexpr double kMinSine = 0.05;  // 3 degrees
  Eigen::Vector2d p = start;
  for (int step = 0; step < kSteps; ++step) {
    Eigen::Matrix2d normals;
    normals.row(0) = a.NormalAt(p).transpose();
    normals.row(1) = b.NormalAt(p).transpose();
    if (std::abs(normals.determinant()) < kMinSine) return start;
    p -= normals.inverse() * Eigen::Vector2d(a.SignedDistance(p), b.SignedDistance(p));
  }
  return (p - start).norm() > max_shift_m ? start : p;
}

}  // namespace plumbline
