#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "core/map/patch_extent.h"
#include "factors/manifold/plane_model.h"

namespace plumbline {

// Planes whose normals' cosine is larger form no corner: their crossing says hardly where.
inline constexpr double kMaxCornerCosine = 0.7;

// A plane of the building that is being estimated, and what is known of it.
struct Landmark {
  int id = 0;
  PlaneModel model = PlaneModel::kVertical;
  double sign = 1.0;                      // horizontal planes: normal = sign * e_z
  std::array<double, 4> parameters = {};  // see factors/manifold/plane_model.h
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

// A horizontal landmark through a point; sign +1 seen from above.
Landmark MakeHorizontalLandmark(double sign, const Eigen::Vector3d& p_world);
// A vertical landmark through a point with the given horizontal normal.
Landmark MakeVerticalLandmark(const Eigen::Vector3d& normal_world,
                              const Eigen::Vector3d& p_world);

}  // namespace plumbline
