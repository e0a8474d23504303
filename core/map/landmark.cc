#include "core/map/landmark.h"

#include <glog/logging.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/map/landmark_view.h"
#include "core/map/patch_extent.h"

namespace plumbline {
bool Landmark::IsJudged() const {
  constexpr int kMaxJudged = 200;  // their mean is known to a fourteenth
  return num_judged >= kMaxJudged;
}

bool Landmark::AgreesWithin(double mean_deviation) const {
  // One more segment, as good as expected: so that one alone, or none, does not decide.
  return sum_deviations <= mean_deviation * num_judged + kExpectedDeviation;
}

Eigen::Vector3d Landmark::Normal() const {
  switch (model) {
    case PlaneModel::kHorizontal:
      return Eigen::Vector3d(0.0, 0.0, sign);
    case PlaneModel::kVertical:
      return Eigen::Vector3d(std::cos(parameters[0]), std::sin(parameters[0]), 0.0);
    case PlaneModel::kGeneral:
      return Eigen::Vector3d(parameters[0], parameters[1], parameters[2]);
  }
  LOG(FATAL) << "unknown plane model";
  return Eigen::Vector3d::Zero();
}

PatchExtent Landmark::EmptyExtent() const {
  const Eigen::Vector3d normal = Normal();
  const Eigen::Vector3d anchor = extent.anchor() - SignedDistance(extent.anchor()) * normal;
  const bool vertical = model == PlaneModel::kVertical;
  return PatchExtent(
      anchor,
      vertical ? Eigen::Vector3d(Eigen::Vector3d::UnitZ().cross(normal)) : extent.u_axis(),
      extent.v_axis());
}

double Landmark::Distance() const {
  return parameters[static_cast<size_t>(PlaneModelSize(model) - 1)];
}

Eigen::Matrix2d Landmark::DeviationJacobian(const Eigen::Vector3d& p_world,
                                            const Eigen::Vector3d& direction_world) const {
  return LandmarkView(*this).DeviationJacobian(p_world, direction_world);
}

Landmark MakeHorizontalLandmark(double sign, const Eigen::Vector3d& p_world) {
  Landmark landmark;
  landmark.model = PlaneModel::kHorizontal;
  landmark.sign = sign;
  landmark.parameters[0] = sign * p_world.z();
  landmark.extent = PatchExtent(p_world, Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY());
  return landmark;
}

Landmark MakeVerticalLandmark(const Eigen::Vector3d& normal_world,
                              const Eigen::Vector3d& p_world) {
  Landmark landmark;
  landmark.model = PlaneModel::kVertical;
  const double angle = std::atan2(normal_world.y(), normal_world.x());
  const Eigen::Vector3d normal(std::cos(angle), std::sin(angle), 0.0);
  landmark.parameters[0] = angle;
  landmark.parameters[1] = normal.dot(p_world);
  landmark.extent =
      PatchExtent(p_world, Eigen::Vector3d::UnitZ().cross(normal), Eigen::Vector3d::UnitZ());
  return landmark;
}

}  // namespace plumbline
