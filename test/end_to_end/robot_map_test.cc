// The shipped recording of a real robot is mapped to its end with the default settings, and
// does not come apart: there is no truth, but a map that has turned away shows the room twice,
// on planes that contradict each other and hold fewer of the points.

#include <gtest/gtest.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>

#include <string>

#include "core/mapping/map_job.h"
#include "test/testing/paths.h"
#include "test/testing/temporary_directory.h"

namespace plumbline {
namespace {

const std::string kRecording = TestDataDir() + "/robot_three_scanners.bag";

class RobotMapTest : public TemporaryDirectoryTest {
 protected:
  // The recording without its first seconds.
  std::string RecordingFrom(double start_s) const {
    const std::string path = (directory_ / "cut.bag").string();
    const rosbag::Bag recording(kRecording);
    rosbag::Bag cut(path, rosbag::bagmode::Write);
    const ros::Time start = rosbag::View(recording).getBeginTime() + ros::Duration(start_s);
    for (const rosbag::MessageInstance& message : rosbag::View(recording, start)) {
      cut.write(message.getTopic(), message.getTime(), message);
    }
    return path;
  }

  Summary Map(const std::string& recording) const {
    MapJob job;
    job.recording = recording;
    job.rig = ConfigsDir() + "/rigs/robot_three_scanners.yaml";
    job.output = (directory_ / "result").string();
    return RunMapJob(job, [](double) {});
  }
};

void ExpectWhole(const Summary& summary) {
  EXPECT_EQ(summary.motion, "planar");
  EXPECT_FALSE(summary.consistency.ends_at_s.has_value());
  EXPECT_NE(summary.consistency.verdict, Verdict::kContradictory);
  // The rest are furniture's and people's.
  EXPECT_GT(summary.points_used, 2 * summary.points / 5);
  // Ranges have the stated noise of 15 mm, and the extrinsics leave 10 to 20 mm between the
  // scanners, in the mean as much again: twice the variance stated.
  EXPECT_LT(summary.variance_factor, 2.0);
}

TEST_F(RobotMapTest, HoldsTogether) {
  const Summary summary = Map(kRecording);
  EXPECT_EQ(summary.scans, 435);
  EXPECT_EQ(summary.points, 727915);
  ExpectWhole(summary);
}

// With planes alone to hold it, the rig turned away 42 s into the recording.
TEST_F(RobotMapTest, HoldsTogetherFromALaterStart) { ExpectWhole(Map(RecordingFrom(4.5))); }

}  // namespace
}  // namespace plumbline
