#include "core/result/result_types.h"

#include <glog/logging.h>

#include <array>

namespace plumbline {

const PlaneTypeFields& FieldsOf(PlaneType type) {
  static const std::array<PlaneTypeFields, 4> kFields = {{
      {"horizontal", {"d"}, 0},
      {"vertical", {"angle", "d"}, 1},
      {"general", {"turn_u", "turn_v", "d_centre"}, 2},
      {"cylinder", {"turn_u", "radius", "d_centre"}, 1},
  }};
  return kFields.at(static_cast<size_t>(type));
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
