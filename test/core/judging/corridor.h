#pragma once

#include "test/core/judging/hand_made_map.h"

namespace plumbline {

// Two walls along the x axis of a hand-made map, at y = 1 and y = -1, and one across at its
// end.
class Corridor {
 public:
  explicit Corridor(HandMadeMap* map) : map_(map) {
    for (const double side : {1.0, -1.0}) {
      Landmark wall = MakeVerticalLandmark({0.0, -side, 0.0}, {0.0, side, 0.0});
      wall.id = static_cast<int>(map->state().landmarks.size());
      wall.num_segments = 1;
      map->state().landmarks.push_back(wall);
    }
    end_ = map->AddWall(10.0, -1.0, 1.0);
  }

  void See(int second, bool and_end) {
    map_->SeeAlong(second, 0, {-4.0, 1.0}, {4.0, 1.0});
    map_->SeeAlong(second, 1, {-4.0, -1.0}, {4.0, -1.0});
    if (and_end) map_->See(second, end_, 10.0, -1.0, 1.0);
  }

 private:
  HandMadeMap* map_;
  int end_ = -1;
};

}  // namespace plumbline
