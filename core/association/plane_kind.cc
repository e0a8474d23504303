#include "core/association/plane_kind.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/plane_tangents.h"

namespace plumbline {
namespace {

// A wall, which is likelier than other planes, is decided once its normal is known to this.
constexpr double kMaxWallSigma = 3.0 * kRadiansPerDegree;
// A plane is vertical or level if its normal differs from that by at most this number of
// standard deviations plus an angle: the accuracy of walls and of mountings.
constexpr double kSigmas = 3.5;
constexpr double kUprightTo = 1.0 * kRadiansPerDegree;
constexpr double kLevelTo = 0.3 * kRadiansPerDegree;

}  // namespace

std::optional<Landmark> DecideKind(const PlaneThroughLines::Fit& fit,
                                   const Eigen::Vector3d& seen_from_world) {
  const double side = fit.normal.dot(seen_from_world - fit.centre_world) > 0.0 ? 1.0 : -1.0;
  const Eigen::Vector3d normal = side * fit.normal;
  const Eigen::Matrix<double, 3, 2> tangents = PlaneTangents(normal);
  const Eigen::Matrix2d of_turns =
      tangents.transpose() * fit.normal_covariance * tangents;  // towards level u, upward v
  if (of_turns.trace() > kMaxWallSigma * kMaxWallSigma) return std::nullopt;
  const double sigma_up = std::sqrt(of_turns(1, 1));
  const double from_upright = std::abs(std::asin(std::clamp(normal.z(), -1.0, 1.0)));
  if (from_upright < kSigmas * sigma_up + kUprightTo) {
    Landmark wall = MakeVerticalLandmark(
        Eigen::Vector3d(normal.x(), normal.y(), 0.0).normalized(), fit.centre_world);
    // Known at the centre, where distance and angle do not correlate.
    Eigen::Matrix2d by_centre = Eigen::Matrix2d::Identity();
    by_centre(1, 0) = wall.extent.axes().u.dot(fit.centre_world);
    wall.covariance.topLeftCorner<2, 2>() =
        by_centre * Eigen::Vector2d(of_turns(0, 0), fit.centre_variance).asDiagonal() *
        by_centre.transpose();
    return wall;
  }
  const double sigma = std::sqrt(of_turns.trace());
  if (sigma > kDecidedSigma) return std::nullopt;
  const double from_level = 0.5 * M_PI - from_upright;
  if (from_level < kSigmas * sigma + kLevelTo) {
    // Known no better than floors are level, a normal looks more level than a ramp of 1.4
    // degrees.
    if (from_level > kSigmas * kLevelTo + kLevelTo) return std::nullopt;
    Landmark level = MakeHorizontalLandmark(normal.z() > 0.0 ? 1.0 : -1.0, fit.centre_world);
    level.covariance(0, 0) = fit.centre_variance;
    return level;
  }
  Landmark general = MakeGeneralLandmark(normal, fit.centre_world);
  general.covariance.topLeftCorner<2, 2>() = of_turns;
  general.covariance(2, 2) = fit.centre_variance;
  return general;
}

}  // namespace plumbline
