#include "core/result/point_buffer.h"

#include <gtest/gtest.h>

#include <array>
#include <cstring>

#include "core/result/surface_colour.h"

namespace plumbline {
namespace {

MapPoint PointOn(int plane_id) {
  MapPoint point;
  point.p_world = {1.5f, -2.25f, 0.125f};
  point.time_s = 12.000000001;
  point.scanner = 255;
  point.plane_id = plane_id;
  point.residual_m = -0.01f;
  point.normal_world = {0.0f, 0.6f, -0.8f};
  return point;
}

TEST(PointBuffer, GivesBackWhatWasAdded) {
  PointBuffer buffer;
  for (int id = 0; id < 3000; ++id) buffer.Add(PointOn(id));  // more than its first memory
  ASSERT_EQ(buffer.num_points(), 3000);
  const MapPoint point = buffer.At(2999);
  const MapPoint added = PointOn(2999);
  EXPECT_EQ(point.p_world, added.p_world);
  EXPECT_EQ(point.time_s, added.time_s);
  EXPECT_EQ(point.scanner, added.scanner);
  EXPECT_EQ(point.plane_id, added.plane_id);
  EXPECT_EQ(point.residual_m, added.residual_m);
  EXPECT_EQ(point.normal_world, added.normal_world);
}

TEST(PointBuffer, ColoursEachPointByItsOwnSurface) {
  PointBuffer buffer;
  const std::array<int, 4> ids = {5, 5, -1, 6};
  for (const int id : ids) buffer.Add(PointOn(id));
  ASSERT_EQ(buffer.num_bytes(), ids.size() * PointBuffer::kPointBytes);
  for (size_t i = 0; i < ids.size(); ++i) {
    std::array<uint8_t, 3> colour{};
    std::memcpy(colour.data(),
                buffer.data() + i * PointBuffer::kPointBytes + PointBuffer::kColourOffset,
                colour.size());
    EXPECT_EQ(colour, PointColour(ids[i])) << i;
  }
}

TEST(PointBuffer, ClearsItsPoints) {
  PointBuffer buffer;
  buffer.Add(PointOn(1));
  buffer.Clear();
  EXPECT_EQ(buffer.num_points(), 0);
  buffer.Add(PointOn(2));
  EXPECT_EQ(buffer.At(0).plane_id, 2);
}

TEST(PointBufferDeathTest, TakesNoScannerBeyondAByte) {
  PointBuffer buffer;
  MapPoint point = PointOn(1);
  point.scanner = 256;
  EXPECT_DEATH(buffer.Add(point), "scanner");
}

}  // namespace
}  // namespace plumbline
