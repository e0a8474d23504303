#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/outputs/floor_plan.h"

namespace plumbline {

inline RoomLoop LoopOf(const std::vector<Eigen::Vector2d>& corners, int first_plane) {
  RoomLoop loop;
  for (const Eigen::Vector2d& corner : corners) {
    RoomEdge& edge = loop.emplace_back();
    edge.from = corner;
    edge.plane_id = first_plane < 0 ? -1 : first_plane++;
  }
  return loop;
}

// A storey with a room of 4 m by 3 m, 2.5 m high, that has a pillar, and with a room of which
// no ceiling was seen.
inline FloorPlans PlanOfRooms() {
  FloorPlans plan;
  plan.origin = {"consistent", "office.bag", "0.1.0", "2026-11-27"};
  StoreyPlan& storey = plan.storeys.emplace_back();
  storey.level.floor_m = -1.2;
  Room& room = storey.rooms.emplace_back();
  room.number = 1;
  room.entered = true;
  room.loops = {LoopOf({{0.0, 0.0}, {4.0, 0.0}, {4.0, 3.0}, {0.0, 3.0}}, 10),
                LoopOf({{1.0, 1.0}, {1.0, 2.0}, {2.0, 2.0}, {2.0, 1.0}}, -1)};
  room.area_m2 = 11.00004;
  room.area_stddev_m2 = 0.01236;
  room.perimeter_m = 14.0;
  room.floor_m = -1.2;
  room.ceiling_m = 1.3;
  room.height_stddev_m = 0.001;
  Room& open = storey.rooms.emplace_back();
  open.number = 2;
  open.loops = {LoopOf({{5.0, 0.0}, {6.0, 0.0}, {6.0, 3.0}}, 20)};
  return plan;
}

}  // namespace plumbline
