#include "core/judging/first_rig.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/sensor/rig.h"
#include "test/testing/temporary_directory.h"

namespace plumbline {
namespace {

class FirstRigTest : public TemporaryDirectoryTest {};

// Whatever the topics are called, the file can be read.
TEST_F(FirstRigTest, IsARigFile) {
  CheckReport report;
  report.survey.path = "a\nb.bag";
  for (const char* name : {"/front/scan", "/", "scan: \"x\"", "front_scan"}) {
    TopicSurvey topic;
    topic.name = name;
    topic.noise_m = 0.017;
    topic.limits.max_m = 29.9995;
    topic.beams.assign(10, {100, 100, 0, 0.0F, 0});
    topic.beams[3] = {100, 100, 99, 0.31F, 0};
    report.survey.topics.push_back(topic);
    report.attitudes.push_back({});
  }
  report.attitudes[0].attitude = Attitude::kLevel;
  TravelDirection travel;  // to the right of the beam at angle 0
  travel.angle_rad = -0.5 * M_PI;
  travel.num_steps = 12;
  report.travel_directions = {travel};
  report.survey.wheels = std::make_shared<const Odometry>();
  report.survey.wheels_topic = "/odom";
  const std::string text = FormatFirstRig(report);
  EXPECT_THAT(text, testing::HasSubstr("FILL IN"));
  EXPECT_THAT(text, testing::HasSubstr("from 12 half seconds"));
  const std::string path = (directory_ / "rig.yaml").string();
  WriteBytes(path, text);
  const Rig rig = ReadRig(path);
  ASSERT_EQ(rig.scanners.size(), 4u);
  EXPECT_EQ(rig.scanners[0].name, "front_scan");
  EXPECT_EQ(rig.scanners[0].topic, "/front/scan");
  // Turned to the left, so that its right is ahead.
  const Eigen::Vector3d ahead =
      rig.scanners[0].body_from_scanner.rotation * -Eigen::Vector3d::UnitY();
  EXPECT_LT((ahead - Eigen::Vector3d::UnitX()).norm(), 1e-9);
  EXPECT_EQ(rig.scanners[2].topic, "scan: \"x\"");
  EXPECT_NEAR(rig.scanners[0].range_noise_m, 0.017, 1e-9);
  EXPECT_NEAR(rig.scanners[0].min_range_m, 0.33, 1e-9);
  EXPECT_NEAR(rig.scanners[0].max_range_m, 29.99, 1e-9);
  EXPECT_EQ(rig.odometry_topic, "/odom");
  EXPECT_FALSE(rig.odometry_time_offset_s);
}

}  // namespace
}  // namespace plumbline
