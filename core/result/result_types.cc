#include "core/result/result_types.h"

#include <glog/logging.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace plumbline {

const PlaneTypeFields& FieldsOf(PlaneType type) {
  static const std::array<PlaneTypeFields, 4> kFields = {{
      {"horizontal", {"d"}, 0, false},
      {"vertical", {"angle", "d"}, 1, false},
      {"general", {"turn_u", "turn_v", "d_centre"}, 2, false},
      {"cylinder", {"turn_u", "radius", "d_centre"}, 1, true},
  }};
  return kFields.at(static_cast<size_t>(type));
}

double PlanePatch::AreaBehindChord(double chord_m) const {
  if (curvature == 0.0) return 0.0;
  const double turn = 2.0 * std::asin(std::min(1.0, 0.5 * chord_m / Radius()));
  const double area_m2 = 0.5 * Radius() * Radius() * (turn - std::sin(turn));
  return curvature < 0.0 ? area_m2 : -area_m2;
}

Eigen::Vector3d PlanePatch::NormalAt(const Eigen::Vector3d& p_world) const {
  // The vector from the axis over the radius, turned towards the side that was seen.
  Eigen::Vector3d outwards = normal;
  outwards.head<2>() += curvature * (p_world - centre).head<2>();
  return outwards.normalized();
}

double PlanePatch::SignedDistance(const Eigen::Vector3d& p_world) const {
  // (sqrt(1 + k t) - 1) / k with the curvature k, of which the root is the distance from the
  // axis over the radius; in this form it is exact for planes, too.
  const double t = 2.0 * (normal.dot(p_world) - distance) +
                   curvature * (p_world - centre).head<2>().squaredNorm();
  return t / (1.0 + std::sqrt(std::max(0.0, 1.0 + curvature * t)));
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
