#include "core/outputs/map_cloud.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/result/ply_writer.h"
#include "core/result/point_buffer.h"
#include "test/testing/temporary_directory.h"

namespace plumbline {
namespace {

using ::testing::HasSubstr;

class MapCloudTest : public TemporaryDirectoryTest {
 protected:
  void Write(int count) {
    PlyWriter writer(Path(), "result/map.ply");
    PointBuffer points;
    for (int i = 0; i < count; ++i) {
      const auto x = static_cast<float>(i);
      points.Add({{x, 2.0f, 3.0f}, 0.5 * i, 1, i - 2, 0.25f});
    }
    writer.Add(points);
    writer.Finish();
  }
  std::string Path() const { return (directory_ / "map.ply").string(); }
};

TEST_F(MapCloudTest, ReadsWhatTheMapperWrites) {
  Write(3);
  const std::vector<CloudPoint> points = ReadMapCloud(Path());
  ASSERT_EQ(points.size(), 3u);
  EXPECT_EQ(points[2].p_world, Eigen::Vector3f(2.0f, 2.0f, 3.0f));
  EXPECT_EQ(points[2].time_s, 1.0);
  EXPECT_EQ(points[2].scanner, 1);
  EXPECT_EQ(points[2].plane_id, 0);
  EXPECT_EQ(points[2].residual_m, 0.25f);
}

TEST_F(MapCloudTest, ErrorsNameTheFileAndWhatIsWrong) {
  EXPECT_THAT(ErrorOf([&] { ReadMapCloud(Path()); }), HasSubstr("map.ply: can not be read"));
  Write(3);
  const std::string bytes = ReadBytes(Path());
  WriteBytes(Path(), bytes.substr(0, bytes.size() - 1));
  EXPECT_THAT(ErrorOf([&] { ReadMapCloud(Path()); }), HasSubstr("map.ply: ends within"));
  WriteBytes(Path(), "solid\n");
  EXPECT_THAT(ErrorOf([&] { ReadMapCloud(Path()); }), HasSubstr("map.ply: is not a map"));
}

TEST(BeamOrigins, LieBetweenPoses) {
  Rig rig;
  rig.scanners.resize(1);
  rig.scanners[0].body_from_scanner.translation = {0.0, 0.0, 0.5};
  std::vector<StampedPose> poses(3);
  poses[1].time_ns = 100'000'000;
  poses[1].world_from_body.translation.x() = 1.0;
  poses[2].time_ns = 9'000'000'000;
  const BeamOrigins origins(rig, poses, -50'000'000);
  const auto at = origins.At(0, 0.1);  // 0.05 s after the first pose
  ASSERT_TRUE(at.has_value());
  EXPECT_NEAR((*at - Eigen::Vector3d(0.5, 0.0, 0.5)).norm(), 0.0, 1e-9);
  EXPECT_FALSE(origins.At(0, 4.0).has_value());  // no pose is near
  EXPECT_FALSE(origins.At(1, 0.1).has_value());  // no such scanner
}

}  // namespace
}  // namespace plumbline
