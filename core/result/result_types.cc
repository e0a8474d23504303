#include "core/result/result_types.h"

#include <glog/logging.h>

namespace plumbline {

std::string PlaneTypeName(PlaneType type) {
  switch (type) {
    case PlaneType::kHorizontal:
      return "horizontal";
    case PlaneType::kVertical:
      return "vertical";
    case PlaneType::kGeneral:
      return "general";
    case PlaneType::kCylinder:
      return "cylinder";
  }
  LOG(FATAL) << "plane type " << static_cast<int>(type);
}

Eigen::Vector3d PlanePatch::NormalAt(const Eigen::Vector3d& p_world) const {
  if (!IsCurved()) return normal;
  Eigen::Vector3d from_axis = p_world - AxisPoint();
  from_axis.z() = 0.0;
  return std::copysign(1.0, curvature) * from_axis.normalized();
}

double PlanePatch::SignedDistance(const Eigen::Vector3d& p_world) const {
  if (!IsCurved()) return normal.dot(p_world) - distance;
  const double from_axis = (p_world - AxisPoint()).head<2>().norm();
  return std::copysign(from_axis - Radius(), (from_axis - Radius()) * curvature);
}

std::string VerdictName(Verdict verdict) {
  switch (verdict) {
    case Verdict::kConsistent:
      return "consistent";
    case Verdict::kDoubtful:
      return "doubtful";
    case Verdict::kContradictory:
      return "contradictory";
  }
  LOG(FATAL) << "verdict " << static_cast<int>(verdict);
}

}  // namespace plumbline
