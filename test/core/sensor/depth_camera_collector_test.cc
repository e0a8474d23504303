#include "core/sensor/depth_camera_collector.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>

#include <cmath>
#include <fstream>
#include <functional>

#include "test/core/sensor/recording_fixture.h"

namespace plumbline {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

// Images of two rows and four columns; the rig uses both rows.
class DepthCameraRecordingTest : public RecordingTest {
 protected:
  Rig CameraRig() {
    const std::string path = (directory_ / "rig.yaml").string();
    std::ofstream(path)
        << "depth_cameras:\n  - name: eye\n    topic: /depth\n    info_topic: /info\n"
           "    body_from_camera: {translation: [0, 0, 0], rotation_rpy_deg: [-90, 0, -90]}\n"
           "    rows: 2\n    range_noise_m: 0.001\n    min_range_m: 0.5\n    max_range_m: 4\n"
           "    image: [4, 2]\n    field_of_view_deg: [90, 60]\n";
    return ReadRig(path);
  }

  sensor_msgs::CameraInfo Info() {
    sensor_msgs::CameraInfo info;
    info.width = 4;
    info.height = 2;
    info.K = {2.0, 0.0, 1.0, 0.0, 4.0, 1.0, 0.0, 0.0, 1.0};
    return info;
  }

  // Row 0 is 1 m away, row 1 lacks its first pixel and is 2 m away.
  sensor_msgs::Image Image(int64_t stamp_ns) {
    sensor_msgs::Image image;
    image.header.stamp.fromNSec(static_cast<uint64_t>(stamp_ns));
    image.width = 4;
    image.height = 2;
    image.encoding = "16UC1";
    image.step = 8;
    for (const int depth_mm : {1000, 1000, 1000, 1000, 0, 2000, 2000, 2000}) {
      image.data.push_back(static_cast<uint8_t>(depth_mm & 0xff));
      image.data.push_back(static_cast<uint8_t>(depth_mm >> 8));
    }
    return image;
  }

  // Writes three images and what comes before and after them.
  void Write(const std::function<void(sensor_msgs::Image*)>& change,
             const std::function<void(rosbag::Bag*)>& more) {
    rosbag::Bag bag(path_, rosbag::bagmode::Write);
    for (int i = 0; i < 3; ++i) {
      sensor_msgs::Image image = Image(kStart + i * kPeriod);
      if (i == 2) change(&image);
      Record(&bag, "/depth", image);
    }
    more(&bag);
  }

  std::string ErrorAfter(const std::function<void(sensor_msgs::Image*)>& change,
                         const std::function<void(sensor_msgs::CameraInfo*)>& change_info) {
    Write(change, [&](rosbag::Bag* bag) {
      sensor_msgs::CameraInfo info = Info();
      change_info(&info);
      Record(bag, "/info", info);
    });
    return ErrorOf([&] { RecordingReader reader(path_, CameraRig()); });
  }
};

const auto kSame = [](auto*) {};

TEST_F(DepthCameraRecordingTest, RowsAreScanLinesOfTheirScanners) {
  Write(kSame, [&](rosbag::Bag* bag) { Record(bag, "/info", Info()); });
  Rig rig = CameraRig();
  RecordingReader reader(path_, rig);
  EXPECT_THAT(reader.warnings(), IsEmpty());
  EXPECT_DOUBLE_EQ(reader.scan_period_s(), 0.025);
  PlaceScanners(reader, &rig);
  EXPECT_EQ(rig.depth_cameras[0].model.focal_y, 4.0);
  // The upper row's plane rises by 1/4; the lower one goes through the centre.
  const Eigen::Vector3d up =
      rig.scanners[0].body_from_scanner.rotation.toRotationMatrix().col(0);
  EXPECT_LT((up - Eigen::Vector3d(4.0, 0.0, 1.0).normalized()).norm(), 1e-12);
  const Eigen::Vector3d level =
      rig.scanners[1].body_from_scanner.rotation.toRotationMatrix().col(0);
  EXPECT_LT((level - Eigen::Vector3d::UnitX()).norm(), 1e-12);
  for (int pass = 0; pass < 2; ++pass) {
    const std::vector<ScanLine> lines = ReadAll(&reader);
    ASSERT_EQ(lines.size(), 6u);
    for (size_t i = 0; i < 6; ++i) {
      const ScanLine& line = lines[i];
      EXPECT_EQ(line.scanner_index, static_cast<int>(i % 2));
      EXPECT_EQ(line.stamp_ns, kStart + static_cast<int64_t>(i / 2) * kPeriod);
      EXPECT_EQ(line.time_increment_s, 0.0);
      ASSERT_EQ(line.num_beams(), 4);
      // The last beam is the first column, half as far to the left as ahead.
      const Eigen::Vector3d p_body =
          rig.scanners[i % 2].body_from_scanner *
          (line.ranges[i % 2 == 0 ? 3 : 2] *
           Eigen::Vector3d(line.BeamDirection(i % 2 == 0 ? 3 : 2).x(),
                           line.BeamDirection(i % 2 == 0 ? 3 : 2).y(),
                           0.0));
      const Eigen::Vector3d expected =
          i % 2 == 0 ? Eigen::Vector3d(1.0, 0.5, 0.25) : Eigen::Vector3d(2.0, 0.0, 0.0);
      EXPECT_LT((p_body - expected).norm(), 1e-6) << i;
      EXPECT_EQ(std::isnan(line.ranges[3]), i % 2 == 1);
    }
    reader.Rewind();
  }
}

TEST_F(DepthCameraRecordingTest, ARectifiedImageHasTheModelP) {
  sensor_msgs::CameraInfo info = Info();
  info.D = {0.1, 0.0, 0.0, 0.0, 0.0};
  info.P = {3.0, 0.0, 1.5, 0.0, 0.0, 5.0, 0.5, 0.0, 0.0, 0.0, 1.0, 0.0};
  Write(kSame, [&](rosbag::Bag* bag) { Record(bag, "/info", info); });
  Rig rig = CameraRig();
  const RecordingReader reader(path_, rig);
  PlaceScanners(reader, &rig);
  const PinholeModel& model = rig.depth_cameras[0].model;
  EXPECT_EQ(model.focal_x, 3.0);
  EXPECT_EQ(model.centre_x, 1.5);
  EXPECT_EQ(model.focal_y, 5.0);
  EXPECT_EQ(model.centre_y, 0.5);
  ASSERT_EQ(reader.warnings().size(), 1u);
  EXPECT_THAT(reader.warnings().front(), HasSubstr("distortion of the lens"));
}

TEST_F(DepthCameraRecordingTest, WhatCanNotBeUsedIsNamedWithFileAndTopic) {
  const std::string where = path_ + ": topic /depth (depth camera 'eye' of the rig) ";
  EXPECT_EQ(ErrorAfter([](sensor_msgs::Image* image) { image->encoding = "rgb8"; }, kSame),
            where + "has images of encoding 'rgb8', not of depths in 16UC1 (mm) or 32FC1 (m)");
  EXPECT_EQ(ErrorAfter([](sensor_msgs::Image* image) { image->width = 3; }, kSame),
            where + "has images of 4 x 2 pixels and of 3 x 2 pixels");
  EXPECT_EQ(ErrorAfter([](sensor_msgs::Image* image) { image->step = 7; }, kSame),
            where + "has images whose rows of 7 bytes are too short for 4 pixels");
  EXPECT_EQ(ErrorAfter(kSame, [](sensor_msgs::CameraInfo* info) { info->height = 3; }),
            where + "has images of 4 x 2 pixels, and topic /info states 4 x 3 pixels");
  EXPECT_THAT(
      ErrorAfter(kSame, [](sensor_msgs::CameraInfo* info) { info->K[0] = 0.0; }),
      HasSubstr(path_ + ": topic /info (depth camera 'eye' of the rig) states no focal"));
}

TEST_F(DepthCameraRecordingTest, MissingTopicsAreNamed) {
  Write(kSame, [](rosbag::Bag*) {});
  EXPECT_EQ(ErrorOf([&] { RecordingReader reader(path_, CameraRig()); }),
            path_ +
                ": has no sensor_msgs/CameraInfo in topic /info (depth camera 'eye' of the "
                "rig); topics with such messages in this recording: none");
  {
    rosbag::Bag bag(path_, rosbag::bagmode::Write);
    Record(&bag, "/info", Info());
  }
  EXPECT_THAT(ErrorOf([&] { RecordingReader reader(path_, CameraRig()); }),
              HasSubstr(path_ + ": has no sensor_msgs/Image in topic /depth"));
}

// An image that is shorter than it says is lost, and counted.
TEST_F(DepthCameraRecordingTest, TruncatedImagesAreLostAndCounted) {
  Write([](sensor_msgs::Image* image) { image->data.pop_back(); },
        [&](rosbag::Bag* bag) { Record(bag, "/info", Info()); });
  RecordingReader reader(path_, CameraRig());
  EXPECT_EQ(reader.num_scan_lines(), 4);
  ASSERT_FALSE(reader.warnings().empty());
  EXPECT_THAT(reader.warnings().front(),
              HasSubstr("depth camera 'eye': 1 message is lost that can not be decoded"));
}

TEST_F(DepthCameraRecordingTest, ImagesWithFewerRowsThanAreUsedAreRefused) {
  Rig rig = CameraRig();
  PinholeModel model = rig.depth_cameras[0].model;
  model.height = 1;
  EXPECT_EQ(ErrorOf([&] { PlaceRows(0, model, &rig); }),
            "images of depth camera eye have 1 rows, of which the rig file uses 2");
}

}  // namespace
}  // namespace plumbline
