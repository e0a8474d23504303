// The shipped recording of a real robot is mapped to its end, and does not come apart: there
// is no truth, but a map that has turned away shows the room twice, on planes that contradict
// each other and hold fewer of the points.

#include <gtest/gtest.h>

#include "core/mapping/map_job.h"
#include "test/testing/temporary_directory.h"

namespace plumbline {
namespace {

class RobotMapTest : public TemporaryDirectoryTest {};

TEST_F(RobotMapTest, HoldsTogether) {
  MapJob job;
  job.recording = PLUMBLINE_TEST_DATA_DIR "/robot_three_scanners.bag";
  job.rig = PLUMBLINE_CONFIGS_DIR "/rigs/robot_three_scanners.yaml";
  job.config = PLUMBLINE_CONFIGS_DIR "/mapper/robot_three_scanners.yaml";
  job.output = (directory_ / "result").string();
  const Summary summary = RunMapJob(job, [](double) {});
  EXPECT_EQ(summary.motion, "planar");
  EXPECT_EQ(summary.scans, 435);
  EXPECT_EQ(summary.points, 727915);
  // The rest are furniture's and people's.
  EXPECT_GT(summary.points_used, summary.points / 2);
  // Ranges have the stated noise of 15 mm, and the extrinsics leave 10 to 20 mm between the
  // scanners, in the mean as much again: twice the variance stated.
  EXPECT_LT(summary.variance_factor, 2.0);
}

}  // namespace
}  // namespace plumbline
