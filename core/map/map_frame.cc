#include "core/map/map_frame.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

namespace plumbline {
namespace {

// Swaps the ids of a landmark and the first one.
void MakeFirst(int id, MapState* state) {
  Landmark& landmark = state->landmarks[static_cast<size_t>(id)];
  std::swap(landmark, state->landmarks.front());
  std::swap(landmark.id, state->landmarks.front().id);
  const auto swapped = [id](int other) { return other == id ? 0 : other == 0 ? id : other; };
  for (auto observations : {&MapState::observations, &MapState::sub_minimum_segments}) {
    for (Observation& observation : state->*observations) {
      observation.landmark_id = swapped(observation.landmark_id);
      observation.taken_to = swapped(observation.taken_to);
    }
  }
}

}  // namespace

void MoveMap(const Rig& rig, const Rigid3d& to_from, MapState* state) {
  state->trajectory.Move(to_from);
  for (Landmark& landmark : state->landmarks) landmark.Move(to_from);
  state->pose_constraints.clear();
  RebuildLandmarks(rig, state);
}

void TurnToWall(const Rig& rig, MapState* state) {
  KeepHeadingHeld(state);
  const auto wall = std::find_if(
      state->landmarks.begin(), state->landmarks.end(), [](const Landmark& landmark) {
        return landmark.heading_fixed;
      });
  if (wall == state->landmarks.end()) return;
  MakeFirst(wall->id, state);
  double& heading = state->landmarks.front().parameters[0];
  const Eigen::AngleAxisd turn(-heading, Eigen::Vector3d::UnitZ());
  MoveMap(rig, {Eigen::Quaterniond(turn), Eigen::Vector3d::Zero()}, state);
  heading = 0.0;
}

}  // namespace plumbline
