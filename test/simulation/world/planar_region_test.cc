#include "simulation/world/planar_region.h"

#include <gtest/gtest.h>

namespace plumbline {
namespace {

const Polygon2 kSquare = {{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}};
const Polygon2 kLine = {{0.0, 0.0}, {0.5, 0.5}, {2.0, 2.0}};

TEST(PlanarRegion, JoinsWhatTouches) {
  PlanarRegion region;
  region.Join({kSquare, {{1.0, 0.0}, {2.0, 0.0}, {1.0, 1.0}}});
  ASSERT_EQ(region.Polygons().size(), 1U);
  const Polygon2 outer = {{0.0, 0.0}, {2.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}};
  EXPECT_EQ(region.Polygons().front().outer, outer);
}

TEST(PlanarRegion, LinesAddNothing) {
  PlanarRegion region;
  region.Join(kLine);
  EXPECT_TRUE(region.Polygons().empty());
  region.Join({kLine, kSquare, kLine});
  ASSERT_EQ(region.Polygons().size(), 1U);
  EXPECT_EQ(region.Polygons().front().outer, kSquare);
}

TEST(PlanarRegion, SubtractsHoles) {
  PlanarRegion region;
  region.Join(kSquare);
  region.Subtract({{0.2, 0.2}, {0.4, 0.2}, {0.4, 0.4}});
  ASSERT_EQ(region.Polygons().size(), 1U);
  ASSERT_EQ(region.Polygons().front().holes.size(), 1U);
  EXPECT_EQ(region.Polygons().front().holes.front().size(), 3U);
}

}  // namespace
}  // namespace plumbline
