#include "core/result/surface_colour.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "core/result/point_buffer.h"

namespace plumbline {
namespace {

// The largest difference of two colours in a channel.
int Difference(const std::array<uint8_t, 3>& a, const std::array<uint8_t, 3>& b) {
  int largest = 0;
  for (size_t i = 0; i < 3; ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

TEST(SurfaceColour, NeighbouringIdsAreFarApart) {
  for (int id = 0; id < 200; ++id) {
    EXPECT_GT(Difference(SurfaceColour(id), SurfaceColour(id + 1)), 100) << id;
    EXPECT_GT(Difference(SurfaceColour(id), SurfaceColour(id + 2)), 40) << id;
  }
}

// Grey is for what lies on no surface.
TEST(SurfaceColour, IsNeverGrey) {
  for (int id = 0; id < 200; ++id) {
    const auto [lowest, highest] =
        std::minmax({SurfaceColour(id)[0], SurfaceColour(id)[1], SurfaceColour(id)[2]});
    EXPECT_EQ(highest, 255) << id;
    EXPECT_EQ(lowest, 64) << id;
  }
}

TEST(PointColour, IsThatOfTheSurfaceOrGrey) {
  EXPECT_EQ(PointColour(7), SurfaceColour(7));
  const auto none = PointColour(-1);
  const auto moving = PointColour(kMovingPlaneId);
  EXPECT_EQ(none[0], none[1]);
  EXPECT_EQ(none[1], none[2]);
  EXPECT_LT(moving[0], none[0]);
}

}  // namespace
}  // namespace plumbline
