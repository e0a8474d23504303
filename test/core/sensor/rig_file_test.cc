// Rig files with depth cameras; those with scanners alone: rig_test.cc.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "core/geometry/angles.h"
#include "core/sensor/rig.h"
#include "test/testing/temporary_directory.h"

namespace plumbline {
namespace {

using ::testing::HasSubstr;

const std::string kCamera =
    "  - name: eye\n    topic: /depth\n    info_topic: /info\n"
    "    body_from_camera: {translation: [0.1, 0.2, 0.3], rotation_rpy_deg: [-90, 0, -90]}\n"
    "    rows: 3\n    range_noise_m: 0.001\n    range_noise_per_m2: 0.002\n"
    "    min_range_m: 0.5\n    max_range_m: 4\n    time_offset_s: 0.02\n"
    "    image: [8, 6]\n    field_of_view_deg: [90, 60]\n    scan_rate_hz: 15\n";
const std::string kScanner =
    "scanners:\n  - name: top\n    topic: /top\n"
    "    body_from_scanner: {translation: [1, 2, 3], rotation_rpy_deg: [10, 20, 30]}\n"
    "    range_noise_m: 0.03\n    min_range_m: 0.1\n    max_range_m: 30\n";

class RigFileTest : public TemporaryDirectoryTest {
 protected:
  Rig ReadText(const std::string& text) {
    const std::string path = (directory_ / "rig.yaml").string();
    std::ofstream(path) << text;
    return ReadRig(path);
  }
  std::string ErrorWith(const std::string& from, const std::string& to) {
    std::string text = "depth_cameras:\n" + kCamera;
    text.replace(text.find(from), from.size(), to);
    return ErrorOf([&] { ReadText(text); });
  }
};

TEST_F(RigFileTest, ARowOfADepthCameraIsAScanner) {
  const Rig rig = ReadText(kScanner + "depth_cameras:\n" + kCamera);
  ASSERT_EQ(rig.scanners.size(), 4u);
  EXPECT_FALSE(rig.scanners[0].camera_row);
  ASSERT_EQ(rig.depth_cameras.size(), 1u);
  const double focal_y = 3.0 / std::tan(30.0 * kRadiansPerDegree);
  EXPECT_NEAR(rig.depth_cameras[0].model.focal_y, focal_y, 1e-12);
  for (int i = 0; i < 3; ++i) {
    const Scanner& row = rig.scanners[static_cast<size_t>(i + 1)];
    ASSERT_TRUE(row.camera_row);
    EXPECT_EQ(row.name, "eye row " + std::to_string(i + 1));
    EXPECT_EQ(row.topic, "/depth");
    EXPECT_EQ(row.camera_row->row, 2 * i + 1);
    EXPECT_EQ(row.beams, 8);
    EXPECT_EQ(row.time_offset_s, 0.02);
    EXPECT_EQ(row.uncertainty.rotation_rad, 0.0);
    EXPECT_LT((row.body_from_scanner.translation - Eigen::Vector3d(0.1, 0.2, 0.3)).norm(),
              1e-12);
    // The camera looks ahead: rows above the middle rise.
    const Eigen::Vector3d ahead(focal_y, 0.0, 2.5 - (2 * i + 1));
    EXPECT_LT((row.body_from_scanner.rotation * Eigen::Vector3d::UnitX() - ahead.normalized())
                  .norm(),
              1e-12);
    EXPECT_LT(
        (row.body_from_scanner.rotation * Eigen::Vector3d::UnitY() - Eigen::Vector3d::UnitY())
            .norm(),
        1e-12);
  }
  EXPECT_FALSE(IsPlanar(rig));
  EXPECT_EQ(WithoutCameraRows(rig).scanners.size(), 1u);
}

TEST_F(RigFileTest, WrittenCamerasReadBack) {
  const Rig rig = ReadText("depth_cameras:\n" + kCamera);
  const std::string path = (directory_ / "written.yaml").string();
  WriteRig(rig, path);
  const Rig read = ReadRig(path);
  ASSERT_EQ(read.scanners.size(), rig.scanners.size());
  ASSERT_EQ(read.depth_cameras.size(), 1u);
  const DepthCamera& camera = read.depth_cameras[0];
  EXPECT_EQ(camera.name, "eye");
  EXPECT_EQ(camera.topic, "/depth");
  EXPECT_EQ(camera.info_topic, "/info");
  EXPECT_EQ(camera.model.width, 8);
  EXPECT_NEAR(camera.model.focal_x, rig.depth_cameras[0].model.focal_x, 1e-9);
  for (size_t i = 0; i < rig.scanners.size(); ++i) {
    const Scanner& row = read.scanners[i];
    EXPECT_EQ(row.name, rig.scanners[i].name);
    EXPECT_EQ(row.range_noise_m, 0.001);
    EXPECT_EQ(row.range_noise_per_m2, 0.002);
    EXPECT_EQ(row.max_range_m, 4.0);
    EXPECT_EQ(row.time_offset_s, 0.02);
    EXPECT_EQ(row.scan_rate_hz, 15.0);
    EXPECT_LT(row.body_from_scanner.rotation.angularDistance(
                  rig.scanners[i].body_from_scanner.rotation),
              1e-9);
  }
}

TEST_F(RigFileTest, ScannersMayGrowNoisierToo) {
  std::string text = kScanner;
  text.replace(text.find("    min_range_m"), 0, "    range_noise_per_m2: 0.004\n");
  const Rig rig = ReadText(text);
  const std::string path = (directory_ / "written.yaml").string();
  WriteRig(rig, path);
  EXPECT_EQ(ReadRig(path).scanners[0].range_noise_per_m2, 0.004);
}

TEST_F(RigFileTest, MistakesAreNamedWithTheirLine) {
  EXPECT_THAT(ErrorWith("info_topic", "information_topic"), HasSubstr("info_topic"));
  EXPECT_THAT(ErrorWith("rows: 3", "rows: 7"), HasSubstr("rig.yaml:12: "));
  EXPECT_THAT(ErrorWith("noise_m: 0.001", "noise_m: estimate"), HasSubstr("rig.yaml:7: "));
  EXPECT_THAT(ErrorOf([&] { ReadText("depth_cameras:\n" + kCamera + kCamera); }),
              HasSubstr("a scanner named 'eye' stands above already"));
  EXPECT_THAT(ErrorOf([&] { ReadText("depth_cameras: []\n"); }), HasSubstr("scanners"));
}

}  // namespace
}  // namespace plumbline
