#include "core/outputs/storey_levels.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "core/outputs/plan_scales.h"
#include "core/util/quantiles.h"

namespace plumbline {
namespace {

constexpr double kMinWayM = 2.0;    // over a floor
constexpr double kMaxSwingM = 0.3;  // of the height of a rig that is carried

bool IsLevel(const PlanePatch& plane, double direction) {
  return direction * plane.normal.z() > kLevelCosine && plane.outline.size() >= 3;
}

double HeightAt(const PlanePatch& plane, const Eigen::Vector2d& p) {
  return LevelOrSlope{plane.normal, plane.distance}.HeightAt(p);
}

// The highest floor below the pose that is within reach of the rig, or null.
const PlanePatch* FloorBelow(const std::vector<const PlanePatch*>& floors,
                             const Eigen::Vector3d& position) {
  const PlanePatch* below = nullptr;
  for (const PlanePatch* floor : floors) {
    const double floor_m = HeightAt(*floor, position.head<2>());
    const double height = position.z() - floor_m;
    if (height < 0.0 || height > kUsualClearM) continue;
    if (below != nullptr && floor_m < HeightAt(*below, position.head<2>())) continue;
    if (CoversInPlan(floor->outline, position.head<2>(), kOutlineMarginM)) below = floor;
  }
  return below;
}

// Returns the level ceiling between two heights with most points.
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

// The way over floors: its length, and where it was.
struct WayOver {
  double length_m = 0.0;
  std::vector<Eigen::Vector2d> places;
  std::vector<double> rig_heights_m;  // above the floor, at these

  void Add(const PlanePatch& floor, const Eigen::Vector3d& position, double step_m) {
    length_m += step_m;
    places.emplace_back(position.head<2>());
    rig_heights_m.push_back(position.z() - HeightAt(floor, position.head<2>()));
  }
  double RigHeight() const { return Median(rig_heights_m); }
};

using Floors = std::vector<const PlanePatch*>;
using Ways = std::map<const PlanePatch*, WayOver>;

Ways WaysOverHighest(const Floors& floors, const std::vector<StampedPose>& poses) {
  Ways ways;
  for (size_t i = 1; i < poses.size(); ++i) {
    const Eigen::Vector3d& position = poses[i].world_from_body.translation;
    const PlanePatch* floor = FloorBelow(floors, position);
    if (floor == nullptr) continue;
    ways[floor].Add(
        *floor, position, (position - poses[i - 1].world_from_body.translation).norm());
  }
  return ways;
}

// The ways over floors above which the rig is as high as it is elsewhere: of those below a
// pose, the one for which that holds best. Tables have none.
Ways WaysAtRigHeight(const Floors& floors,
                     const std::vector<StampedPose>& poses,
                     double rig_height_m) {
  Ways ways;
  for (size_t i = 1; i < poses.size(); ++i) {
    const Eigen::Vector3d& position = poses[i].world_from_body.translation;
    const PlanePatch* best = nullptr;
    double least = kMaxSwingM;
    for (const PlanePatch* floor : floors) {
      const double off =
          std::abs(position.z() - HeightAt(*floor, position.head<2>()) - rig_height_m);
      if (off >= least || !CoversInPlan(floor->outline, position.head<2>(), kOutlineMarginM)) {
        continue;
      }
      least = off;
      best = floor;
    }
    if (best == nullptr) continue;
    ways[best].Add(
        *best, position, (position - poses[i - 1].world_from_body.translation).norm());
  }
  return ways;
}

// The ceiling over these places of a floor: of those over most of them, the lowest one.
std::optional<LevelOrSlope> CeilingOver(const std::vector<PlanePatch>& planes,
                                        const LevelOrSlope& floor,
                                        const std::vector<Eigen::Vector2d>& places) {
  struct Candidate {
    LevelOrSlope ceiling;
    double clear_m = 0.0;  // above the floor, on average
    size_t num_places = 0;
  };
  std::vector<Candidate> candidates;
  size_t most = 0;
  for (const PlanePatch& plane : planes) {
    if (!IsLevel(plane, -1.0)) continue;
    Candidate candidate = {{plane.normal, plane.distance}, 0.0, 0};
    for (const Eigen::Vector2d& p : places) {
      const double clear_m = HeightAt(plane, p) - floor.HeightAt(p);
      if (clear_m < kMinClearM || clear_m > kMaxClearM) continue;
      if (!CoversInPlan(plane.outline, p, 0.0)) continue;
      ++candidate.num_places;
      candidate.clear_m += clear_m;
    }
    if (candidate.num_places == 0) continue;
    candidate.clear_m /= static_cast<double>(candidate.num_places);
    most = std::max(most, candidate.num_places);
    candidates.push_back(candidate);
  }
  std::optional<LevelOrSlope> best;
  double least_m = std::numeric_limits<double>::max();
  for (const Candidate& candidate : candidates) {
    if (2 * candidate.num_places < most || candidate.clear_m >= least_m) continue;
    least_m = candidate.clear_m;
    best = candidate.ceiling;
  }
  return best;
}

// Gives the storey a map of its floors, where they are at several heights. members: its
// floors, that of its own height first.
void MapFloors(const std::vector<PlanePatch>& planes,
               const Ways& ways,
               const Floors& members,
               const std::vector<CloudPoint>& points,
               StoreyLevel* storey) {
  std::vector<FloorArea> areas;
  std::map<int, size_t> area_of_plane;
  bool is_level = true;
  for (const PlanePatch* floor : members) {
    const auto way = ways.find(floor);
    if (way == ways.end()) continue;
    area_of_plane[floor->id] = areas.size();
    FloorArea& area = areas.emplace_back();
    area.floor = {floor->normal, floor->distance};
    area.ceiling = CeilingOver(planes, area.floor, way->second.places);
    for (const Eigen::Vector2d& p : way->second.places) {
      is_level = is_level && std::abs(HeightAt(*floor, p) - storey->floor_m) < kSameM;
    }
  }
  if (is_level) return;
  std::vector<FloorMap::Sighting> sightings;
  for (const CloudPoint& point : points) {
    const auto area = area_of_plane.find(point.plane_id);
    if (area == area_of_plane.end()) continue;
    sightings.push_back({point.p_world.head<2>().cast<double>(), area->second});
  }
  if (sightings.empty()) return;
  storey->floors = std::make_shared<const FloorMap>(std::move(areas), sightings);
}

}  // namespace

StoreyHeights StoreyLevel::At(const Eigen::Vector2d& p) const {
  StoreyHeights heights = *this;
  if (floors == nullptr) return heights;
  const FloorArea& area = floors->At(p);
  heights.floor_m = area.floor.HeightAt(p);
  heights.has_ceiling = area.ceiling.has_value();
  heights.top_m = area.ceiling ? area.ceiling->HeightAt(p) : heights.floor_m + kUsualClearM;
  return heights;
}

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
                                     const std::vector<StampedPose>& poses,
                                     const std::vector<CloudPoint>& points) {
  Floors floors;
  for (const PlanePatch& plane : planes) {
    if (IsLevel(plane, 1.0)) floors.push_back(&plane);
  }
  Ways ways = WaysOverHighest(floors, poses);
  std::sort(floors.begin(), floors.end(), [&](const PlanePatch* a, const PlanePatch* b) {
    return ways[a].length_m != ways[b].length_m ? ways[a].length_m > ways[b].length_m
                                                : a->id < b->id;
  });
  Ways at_rig_height;
  if (!floors.empty() && ways[floors.front()].length_m >= kMinWayM) {
    at_rig_height = WaysAtRigHeight(floors, poses, ways[floors.front()].RigHeight());
  }
  struct Storey {
    StoreyLevel level;
    Floors floors;
  };
  std::vector<Storey> found;
  for (const PlanePatch* floor : floors) {
    const double z = floor->centre.z();
    const auto fits = [z](const PlanePatch* other) {
      return std::abs(other->centre.z() - z) < kMinClearM;
    };
    Storey* nearest = nullptr;
    for (Storey& storey : found) {
      if (!std::all_of(storey.floors.begin(), storey.floors.end(), fits)) continue;
      if (nearest == nullptr ||
          std::abs(storey.level.floor_m - z) < std::abs(nearest->level.floor_m - z)) {
        nearest = &storey;
      }
    }
    if (nearest != nullptr) {
      if (at_rig_height[floor].length_m >= kMinWayM) nearest->floors.push_back(floor);
    } else if (ways[floor].length_m >= kMinWayM) {
      Storey& storey = found.emplace_back();
      storey.level.floor_m = z;
      storey.floors = {floor};
    }
  }
  if (found.empty()) {
    StoreyLevel only;
    only.has_floor = false;
    if (!poses.empty()) only.floor_m = poses.front().world_from_body.translation.z();
    only.top_m = only.floor_m + kUsualClearM;
    return {only};
  }
  std::sort(found.begin(), found.end(), [](const Storey& a, const Storey& b) {
    return a.level.floor_m < b.level.floor_m;
  });
  std::vector<StoreyLevel> storeys;
  for (size_t i = 0; i < found.size(); ++i) {
    StoreyLevel& storey = found[i].level;
    const double limit_m =
        i + 1 < found.size() ? found[i + 1].level.floor_m : storey.floor_m + kMaxClearM;
    const PlanePatch* ceiling = CeilingBetween(planes, storey.floor_m + kMinClearM, limit_m);
    storey.has_ceiling = ceiling != nullptr;
    storey.top_m = ceiling != nullptr ? ceiling->centre.z()
                                      : std::min(limit_m, storey.floor_m + kUsualClearM);
    MapFloors(planes, at_rig_height, found[i].floors, points, &storey);
    storeys.push_back(std::move(storey));
  }
  return storeys;
}

}  // namespace plumbline
