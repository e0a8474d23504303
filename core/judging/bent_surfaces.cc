#include "core/judging/bent_surfaces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "core/association/line_deviation.h"
#include "core/judging/verdict_levels.h"
#include "core/map/observation_poses.h"
#include "core/surface/landmark_view.h"
#include "core/util/time.h"

namespace plumbline {
namespace {

constexpr double kTile = 1.5;  // m
constexpr int kMinTiles = 12;  // of a surface
// The third largest of all tiles: right maps have up to 5 mm, those of gentle ramps from 6.4
// on.
constexpr double kMaxOff = 0.006;  // m

struct Tile {
  double sum = 0.0;
  double weight = 0.0;
  int num_segments = 0;

  bool counts() const { return num_segments >= kMinAveraged; }
  double mean() const { return sum / weight; }
  bool is_off() const { return counts() && std::abs(mean()) > kMaxOff; }
};

using TileId = std::array<int, 3>;  // landmark, place

bool IsFloorOrCeiling(const Landmark& landmark) {
  return std::abs(landmark.Normal().z()) > 0.7;  // 45 degrees
}

// Calls visit(observation, tile, deviation) for the segments of floors and ceilings.
template <typename Visit>
void ForEachSegment(const Rig& rig, const MapState& state, const Visit& visit) {
  std::vector<LandmarkView> views;
  for (const Landmark& landmark : state.landmarks) views.emplace_back(landmark);
  SharedPoses poses(rig, state.trajectory);
  for (const Observation& observation : state.observations) {
    if (observation.landmark_id < 0) continue;
    const LandmarkView& view = views[static_cast<size_t>(observation.landmark_id)];
    if (!IsFloorOrCeiling(*view.landmark)) continue;
    const ObservationPoses& at = poses.Of(observation);
    const Eigen::Vector3d p = at.motion.nodes()[1] * observation.centroid().homogeneous();
    visit(observation,
          TileId{observation.landmark_id,
                 static_cast<int>(std::floor(p.x() / kTile)),
                 static_cast<int>(std::floor(p.y() / kTile))},
          DeviationFromPlane(observation, at, view));
  }
}

}  // namespace

BentSurfaces FindBentSurfaces(const Rig& rig, const MapState& state, int64_t start_ns) {
  std::map<TileId, Tile> tiles;
  ForEachSegment(
      rig, state, [&](const Observation&, const TileId& id, const LineDeviation& deviation) {
        const double variance = deviation.covariance(0, 0);
        if (!std::isfinite(variance) || !(variance > 0.0)) return;
        Tile& tile = tiles[id];
        tile.sum += deviation.value.x() / variance;
        tile.weight += 1.0 / variance;
        ++tile.num_segments;
      });
  BentSurfaces found;
  for (const auto& [id, tile] : tiles) {
    if (!tile.counts()) continue;
    if (found.surfaces.empty() || found.surfaces.back().landmark_id != id[0]) {
      found.surfaces.push_back({id[0], 0, 0, 0.0});
    }
    BentSurface& surface = found.surfaces.back();
    ++surface.num_tiles;
    surface.num_off += tile.is_off() ? 1 : 0;
    surface.largest_m = std::max(surface.largest_m, std::abs(tile.mean()));
  }
  int num_off = 0;
  int num_bent = 0;
  std::vector<bool> is_judged(state.landmarks.size(), false);
  for (const BentSurface& surface : found.surfaces) {
    if (surface.num_tiles < kMinTiles) continue;
    is_judged[static_cast<size_t>(surface.landmark_id)] = true;
    num_off += surface.num_off;
    if (surface.num_off > 0) ++num_bent;
  }
  if (num_off < kMinAgreeing || num_bent < 2) return found;
  ForEachSegment(
      rig, state, [&](const Observation& observation, const TileId& id, const LineDeviation&) {
        if (!is_judged[static_cast<size_t>(id[0])] || !tiles[id].is_off()) return;
        const auto second = static_cast<size_t>(
            std::max(0.0, SecondsBetween(start_ns, observation.start_time_ns())));
        if (found.seconds.size() <= second) found.seconds.resize(second + 1, false);
        found.seconds[second] = true;
      });
  return found;
}

}  // namespace plumbline
