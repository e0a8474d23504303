#include "core/floor_plan/storey_levels.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace plumbline {
namespace {

constexpr double kMinWayM = 2.0;      // over a floor
constexpr double kMinStoreyM = 1.8;   // from floor to floor
constexpr double kMinCeilingM = 1.8;  // above the floor
constexpr double kMaxCeilingM = 8.0;
constexpr double kDefaultCeilingM = 2.5;  // where none was seen
constexpr double kMaxRigHeightM = 2.5;
constexpr double kOutlineMarginM = 0.5;

bool IsLevel(const PlanePatch& plane, double direction) {
  constexpr double kMinCosine = 0.97;
  return !plane.IsCurved() && direction * plane.normal.z() > kMinCosine &&
         plane.outline.size() >= 3;
}

// The highest floor below the pose that is within reach of the rig, or null.
const PlanePatch* FloorBelow(const std::vector<const PlanePatch*>& floors,
                             const Eigen::Vector3d& position) {
  const PlanePatch* below = nullptr;
  for (const PlanePatch* floor : floors) {
    const double height = position.z() - floor->centre.z();
    if (height < 0.0 || height > kMaxRigHeightM) continue;
    if (below != nullptr && floor->centre.z() < below->centre.z()) continue;
    if (CoversInPlan(floor->outline, position.head<2>(), kOutlineMarginM)) below = floor;
  }
  return below;
}

// Of the level ceilings between two heights, the one with most points.
const PlanePatch* CeilingBetween(const std::vector<PlanePatch>& planes,
                                 double low_m,
                                 double high_m) {
  const PlanePatch* found = nullptr;
  for (const PlanePatch& plane : planes) {
    if (!IsLevel(plane, -1.0)) continue;
    const double z = plane.centre.z();
    if (z < low_m || z > high_m) continue;
    if (found == nullptr || plane.num_points > found->num_points) found = &plane;
  }
  return found;
}

}  // namespace

bool CoversInPlan(const std::vector<Eigen::Vector3d>& outline,
                  const Eigen::Vector2d& p,
                  double margin_m) {
  bool inside = false;
  for (size_t i = 0; i < outline.size(); ++i) {
    const Eigen::Vector2d a = outline[i].head<2>();
    const Eigen::Vector2d b = outline[(i + 1) % outline.size()].head<2>();
    const Eigen::Vector2d along = b - a;
    const double length2 = along.squaredNorm();
    const double share =
        length2 > 0.0 ? std::clamp((p - a).dot(along) / length2, 0.0, 1.0) : 0.0;
    if ((a + share * along - p).norm() <= margin_m) return true;
    if ((a.y() > p.y()) != (b.y() > p.y()) &&
        p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x())) {
      inside = !inside;
    }
  }
  return inside;
}

std::vector<StoreyLevel> FindStoreys(const std::vector<PlanePatch>& planes,
                                     const std::vector<StampedPose>& poses) {
  std::vector<const PlanePatch*> floors;
  for (const PlanePatch& plane : planes) {
    if (IsLevel(plane, 1.0)) floors.push_back(&plane);
  }
  std::map<const PlanePatch*, double> way_m;
  for (size_t i = 1; i < poses.size(); ++i) {
    const Eigen::Vector3d& position = poses[i].world_from_body.translation;
    const PlanePatch* floor = FloorBelow(floors, position);
    if (floor == nullptr) continue;
    way_m[floor] += (position - poses[i - 1].world_from_body.translation).norm();
  }
  std::sort(floors.begin(), floors.end(), [&](const PlanePatch* a, const PlanePatch* b) {
    return way_m[a] != way_m[b] ? way_m[a] > way_m[b] : a->id < b->id;
  });
  std::vector<StoreyLevel> storeys;
  for (const PlanePatch* floor : floors) {
    if (way_m[floor] < kMinWayM) continue;
    const double z = floor->centre.z();
    const bool is_new =
        std::none_of(storeys.begin(), storeys.end(), [z](const StoreyLevel& storey) {
          return std::abs(storey.floor_m - z) < kMinStoreyM;
        });
    if (!is_new) continue;
    storeys.emplace_back().floor_m = z;
  }
  if (storeys.empty()) {
    StoreyLevel& only = storeys.emplace_back();
    only.has_floor = false;
    if (!poses.empty()) only.floor_m = poses.front().world_from_body.translation.z();
  }
  std::sort(storeys.begin(), storeys.end(), [](const StoreyLevel& a, const StoreyLevel& b) {
    return a.floor_m < b.floor_m;
  });
  for (size_t i = 0; i < storeys.size(); ++i) {
    StoreyLevel& storey = storeys[i];
    const double limit_m =
        i + 1 < storeys.size() ? storeys[i + 1].floor_m : storey.floor_m + kMaxCeilingM;
    const PlanePatch* ceiling =
        storey.has_floor ? CeilingBetween(planes, storey.floor_m + kMinCeilingM, limit_m)
                         : nullptr;
    storey.has_ceiling = ceiling != nullptr;
    storey.top_m = ceiling != nullptr ? ceiling->centre.z()
                                      : std::min(limit_m, storey.floor_m + kDefaultCeilingM);
  }
  return storeys;
}

}  // namespace plumbline
