#include "core/judging/consistency.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "test/core/judging/hand_made_map.h"

namespace plumbline {
namespace {

struct Door {
  double x;
  double first_y;
  double last_y;
};

// The wall behind the doors, in pieces: a few beams stand for all of each.
void SeeInPieces(int second, int wall, double first_y, double last_y, HandMadeMap* map) {
  constexpr double kPiece = 0.8;  // m
  for (double y = first_y; y + kPiece <= last_y; y += kPiece) {
    map->See(second, wall, 8.0, y, y + kPiece);
  }
}

// Whether beams through doors that were shut before make some seconds doubtful: for four
// seconds the doors stand before a wall, which is then seen through where they stood.
bool IsDoubtful(const std::vector<Door>& doors) {
  HandMadeMap map;
  std::vector<int> ids;
  for (const Door& door : doors) ids.push_back(map.AddWall(door.x, door.first_y, door.last_y));
  const int behind = map.AddWall(8.0, -7.0, 7.0);
  for (int second = 0; second < 8; ++second) {
    if (second < 4) {
      for (size_t i = 0; i < doors.size(); ++i) {
        map.See(second, ids[i], doors[i].x, doors[i].first_y, doors[i].last_y);
      }
      SeeInPieces(second, behind, -6.9, -3.7, &map);
      SeeInPieces(second, behind, 3.7, 6.9, &map);
    } else {
      SeeInPieces(second, behind, -6.9, 6.9, &map);
    }
  }
  const FinishedMap finished{false, map.state(), 1.0, 0, std::vector<double>(8, 0.001)};
  const ConsistencyReport report =
      JudgeConsistency(map.rig(), finished, ScannerActivity(1), 0);
  const auto& intervals = report.consistency.doubtful_intervals;
  return std::any_of(intervals.begin(), intervals.end(), [](const DoubtfulInterval& one) {
    return one.reason.find("beams pass through") != std::string::npos;
  });
}

TEST(Consistency, OneDoorThatHasMovedIsNoDoubt) {
  EXPECT_FALSE(IsDoubtful({{5.0, -1.2, 1.2}}));
}

TEST(Consistency, SeveralSurfacesThatBeamsPassAre) {
  EXPECT_TRUE(IsDoubtful({{5.0, -2.2, -0.1}, {6.5, 0.1, 2.8}}));
}

}  // namespace
}  // namespace plumbline
