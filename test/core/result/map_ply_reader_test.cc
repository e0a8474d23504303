#include "core/result/map_ply_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/result/point_cloud_writer.h"
#include "test/testing/temporary_directory.h"

namespace plumbline {
namespace {

using ::testing::HasSubstr;

class MapPlyReaderTest : public TemporaryDirectoryTest {
 protected:
  std::string Path() const { return (directory_ / "map.ply").string(); }

  static MapPoint MakePoint(int i) {
    MapPoint point;
    point.p_world = {0.5f * static_cast<float>(i), -2.0f, 3.25f};
    point.time_s = 1e-9 * i;
    point.scanner = i % 3;
    point.plane_id = i % 4 - 2;
    point.residual_m = point.plane_id < 0 ? std::numeric_limits<float>::quiet_NaN() : 0.01f;
    return point;
  }

  void WriteMap(int num_points) {
    PointCloudWriter writer(directory_.string(), directory_.string());
    PointBuffer points;
    for (int i = 0; i < num_points; ++i) points.Add(MakePoint(i));
    writer.Add(points);
    writer.Finish();
  }
};

TEST_F(MapPlyReaderTest, ReadsWhatTheWriterWrote) {
  constexpr int kNumPoints = 70'000;  // more than a block
  WriteMap(kNumPoints);
  MapPlyReader reader(Path());
  ASSERT_EQ(reader.num_points(), kNumPoints);
  std::vector<MapPoint> block;
  int i = 0;
  while (reader.Next(&block)) {
    for (const MapPoint& point : block) {
      const MapPoint expected = MakePoint(i++);
      ASSERT_EQ(point.p_world, expected.p_world);
      ASSERT_EQ(point.time_s, expected.time_s);
      ASSERT_EQ(point.scanner, expected.scanner);
      ASSERT_EQ(point.plane_id, expected.plane_id);
      ASSERT_EQ(std::isnan(point.residual_m), expected.plane_id < 0);
    }
  }
  EXPECT_EQ(i, kNumPoints);
  EXPECT_TRUE(block.empty());
}

TEST_F(MapPlyReaderTest, AMapWithoutPointsHasNoBlock) {
  WriteMap(0);
  std::vector<MapPoint> block;
  EXPECT_FALSE(MapPlyReader(Path()).Next(&block));
}

TEST_F(MapPlyReaderTest, NamesAFileThatIsNoMapOfOurs) {
  const auto error = [this] { return ErrorOf([this] { MapPlyReader reader(Path()); }); };
  EXPECT_THAT(error(), HasSubstr(Path() + ": can not be read"));
  WriteBytes(Path(), "ply\nformat ascii 1.0\nelement vertex 0\nend_header\n");
  EXPECT_THAT(error(), HasSubstr(Path() + ": is not a map that plumbline_map wrote"));
  WriteBytes(Path(), "");
  EXPECT_THAT(error(), HasSubstr("is not a map"));
  WriteMap(10);
  std::string bytes = ReadBytes(Path());
  bytes.replace(bytes.find("float z"), 7, "float w");
  WriteBytes(Path(), bytes);
  EXPECT_THAT(error(), HasSubstr("is not a map"));
  WriteMap(10);
  bytes = ReadBytes(Path());
  bytes.pop_back();
  WriteBytes(Path(), bytes);
  EXPECT_THAT(error(), HasSubstr(Path() + ": ends before its last point"));
}

}  // namespace
}  // namespace plumbline
