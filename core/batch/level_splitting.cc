#include "core/batch/level_splitting.h"

#include <cmath>
#include <cstddef>
#include <map>
#include <optional>

#include "core/association/surface_levels.h"
#include "core/map/observation_poses.h"
#include "core/util/quantiles.h"

namespace plumbline {
namespace {

// The levels of one surface by cell.
using LevelOfCell = std::map<PatchExtent::Cell, size_t>;

// The level that most of a segment lies on.
std::optional<size_t> LevelOf(const Observation& observation,
                              const ObservationPoses& poses,
                              const PatchExtent& extent,
                              const LevelOfCell& levels) {
  const Eigen::Vector2d start =
      extent.Project(poses.motion.ToWorld(observation.start(), observation.start_time_ns()));
  const Eigen::Vector2d end =
      extent.Project(poses.motion.ToWorld(observation.end(), observation.end_time_ns()));
  std::map<size_t, int> counts;
  const int steps = 1 + static_cast<int>((end - start).norm() / PatchExtent::kCellSize);
  for (int i = 0; i <= steps; ++i) {
    const double share = static_cast<double>(i) / steps;
    const auto found = levels.find(PatchExtent::CellAt(start + share * (end - start)));
    if (found != levels.end()) ++counts[found->second];
  }
  for (const auto& [level, count] : counts) {
    if (2 * count > steps + 1) return level;
  }
  return std::nullopt;
}

}  // namespace

std::set<std::pair<int, int>> SplitLevels(const Rig& rig,
                                          const AssociationOptions& options,
                                          const std::vector<LevelOnSurface>& levels,
                                          std::vector<PlaneOpenings>* openings,
                                          MapState* state) {
  const double least_step_m = kSignificantStddevs * options.surface_flatness_m;
  std::map<int, LevelOfCell> by_surface;
  for (size_t i = 0; i < levels.size(); ++i) {
    if (std::abs(levels[i].step_m) < least_step_m) continue;
    for (const PatchExtent::Cell& cell : levels[i].cells) {
      by_surface[levels[i].landmark_id][cell] = i;
    }
  }
  std::vector<int> landmark_of_level(levels.size(), -1);
  std::set<std::pair<int, int>> split;
  SharedPoses poses(rig, state->trajectory);
  const auto level_of = [&](const Observation& observation) -> std::optional<size_t> {
    const auto surface = by_surface.find(observation.landmark_id);
    if (surface == by_surface.end()) return std::nullopt;
    const Landmark& landmark = state->landmarks[static_cast<size_t>(surface->first)];
    return LevelOf(observation, poses.Of(observation), landmark.extent, surface->second);
  };
  for (Observation& observation : state->observations) {
    const std::optional<size_t> level = level_of(observation);
    if (!level) continue;
    int& id = landmark_of_level[*level];
    if (id < 0) {
      const Landmark& landmark =
          state->landmarks[static_cast<size_t>(observation.landmark_id)];
      id = static_cast<int>(state->landmarks.size());
      split.emplace(landmark.id, id);
      Landmark on_level = landmark;
      on_level.id = id;
      on_level.heading_fixed = false;
      state->landmarks.push_back(std::move(on_level));
      openings->push_back(levels[*level].elsewhere);
    }
    observation.landmark_id = id;
  }
  for (Observation& segment : state->sub_minimum_segments) {
    const std::optional<size_t> level = level_of(segment);
    if (!level || landmark_of_level[*level] < 0) continue;
    segment.landmark_id = landmark_of_level[*level];
  }
  std::vector<bool> is_changed(state->landmarks.size(), false);
  for (const auto& [surface, on_level] : split) {
    is_changed[static_cast<size_t>(surface)] = true;
    is_changed[static_cast<size_t>(on_level)] = true;
  }
  RebuildLandmarks(rig, is_changed, state);
  KeepHeadingHeld(state);
  return split;
}

}  // namespace plumbline
