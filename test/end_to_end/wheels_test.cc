// A robot with one slow level scanner and wheels, as CARMEN logs hold it: wheels whose clock,
// whose samples or whose signs are wrong, and scans that show nothing for a while.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <iomanip>
#include <sstream>

#include "core/geometry/planar_pose.h"
#include "core/util/error.h"
#include "core/util/time.h"
#include "test/testing/scenario.h"

namespace plumbline {
namespace {

using testing::Contains;
using testing::HasSubstr;

// What a line of the log says of the wheels.
struct Counted {
  PlanarPose pose;
  double speed = 0.0;  // m/s
};

class WheelsTest : public MappingTest {
 protected:
  // Not in the constructor: there is no directory to write to before.
  void SetUp() override {
    MappingTest::SetUp();
    Scenario scenario;
    scenario.building = PillarRoom();
    scenario.scanners = {{"level", "0.0, 0.0, 0.0", "0.0, 0.0, 0.0", 181, 5.0, 0.01}};
    scenario.path = PillarWalk(36.0, 0.6);
    recording_ = Simulate(scenario);
    recording_.rig.odometry_topic = "ROBOTLASER1";
  }

  double SecondsOf(const ScanLine& line) const {
    return SecondsBetween(recording_.scan_lines.front().stamp_ns, line.stamp_ns);
  }

  // The true motion from where the wheels begin to count.
  PlanarPose TruthAt(int64_t time_ns) const {
    const std::vector<StampedPose>& truth = recording_.truth_trajectory;
    const auto after = std::lower_bound(
        truth.begin(), truth.end(), time_ns, [](const StampedPose& pose, int64_t t) {
          return pose.time_ns < t;
        });
    const StampedPose& pose = after == truth.end() ? truth.back() : *after;
    return FromAbove(pose.world_from_body);
  }

  // counted: what the wheels say at a time, by default the truth.
  Summary MapLog(const std::function<Counted(int64_t)>& counted,
                 const std::string& config = "") {
    std::ostringstream log;
    log << std::setprecision(12);
    Rig rig = recording_.rig;
    const auto stamp = [&](const ScanLine& line) {
      std::ostringstream words;
      words << std::setprecision(12) << line.stamp_ns / 1'000'000'000 << "."
            << std::setfill('0') << std::setw(9) << line.stamp_ns % 1'000'000'000 << " host "
            << SecondsOf(line) << "\n";
      return words.str();
    };
    for (const ScanLine& line : recording_.scan_lines) {
      if (rig.odometry_topic == "ODOM") {
        const Counted wheels = counted(line.stamp_ns);
        log << "ODOM " << wheels.pose.position.x() << " " << wheels.pose.position.y() << " "
            << wheels.pose.heading << " " << wheels.speed << " 0 0 " << stamp(line);
        if (SecondsOf(line) > gap_begin_s_ && SecondsOf(line) < gap_end_s_) continue;
      }
      log << "ROBOTLASER1 0 " << line.angle_min << " " << 270.0 * M_PI / 180.0 << " "
          << line.angle_increment << " 80.0 0.01 0 " << line.num_beams();
      for (const float range : line.ranges) {
        log << " " << (std::isfinite(range) ? range : 80.0f);
      }
      const Counted wheels = counted(line.stamp_ns);
      const auto write_pose = [&] {
        log << " " << wheels.pose.position.x() << " " << wheels.pose.position.y() << " "
            << wheels.pose.heading;
      };
      log << " 0";
      write_pose();
      write_pose();
      log << " " << wheels.speed << " 0 0 0 0 " << stamp(line);
      rig.scanners[0].time_increment_s = line.time_increment_s;
    }
    WriteBytes(Path("recording.log"), log.str());
    rig.scanners[0].topic = "ROBOTLASER1";
    WriteRig(rig, Path("rig.yaml"));
    MapJob job = Job(config);
    job.recording = Path("recording.log");
    return summary_ = RunMapJob(job, [](double) {});
  }

  void ExpectRight(double max_error_m) {
    EXPECT_TRUE(summary_.parts.empty());
    EXPECT_NE(summary_.consistency.verdict, Verdict::kContradictory);
    EXPECT_LT(EvaluateResult(recording_).trajectory.aligned.position_m.max, max_error_m);
  }

  SimulatedRecording recording_;
  // Between these times there are no scans in the log, where wheels have lines of their own.
  double gap_begin_s_ = 0.0;
  double gap_end_s_ = 0.0;
};

TEST_F(WheelsTest, ScanLinesStateThem) {
  const Summary summary = MapLog([&](int64_t time_ns) { return Counted{TruthAt(time_ns)}; });
  ExpectRight(0.03);
  ASSERT_TRUE(summary.odometry);
  EXPECT_NEAR(summary.odometry->length_scale, 1.0, 0.02);
}

TEST_F(WheelsTest, TheirClockIsFound) {
  MapLog([&](int64_t time_ns) { return Counted{TruthAt(time_ns - 250'000'000)}; });
  ExpectRight(0.03);
  const Rig used = ReadRig(Path("result/rig_used.yaml"));
  ASSERT_TRUE(used.odometry_time_offset_s);
  EXPECT_NEAR(*used.odometry_time_offset_s, -0.25, 0.04);
}

TEST_F(WheelsTest, PosesSentAgainAreLeftOut) {
  int64_t previous_ns = recording_.scan_lines.front().stamp_ns;
  int count = 0;
  const Summary summary = MapLog([&](int64_t time_ns) {
    const Counted counted{TruthAt(++count % 9 == 0 ? previous_ns : time_ns)};
    if (count % 9 != 0) previous_ns = time_ns;
    return counted;
  });
  ExpectRight(0.03);
  EXPECT_THAT(summary.warnings, Contains(HasSubstr("sent again")));
}

TEST_F(WheelsTest, AWayThatIsCountedBackIsRefused) {
  const auto counted = [&](int64_t time_ns) {
    PlanarPose pose = TruthAt(time_ns);
    pose.position = -pose.position;
    return Counted{pose};
  };
  try {
    MapLog(counted);
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(),
                HasSubstr("ROBOTLASER1: the wheels count the way ahead as a way"));
  }
}

// Nobody sees anything for a quarter of a minute, in which the rig turns twice. The motion is
// not foretold too stiffly: else it would outweigh what the wheels say of these turns.
TEST_F(WheelsTest, ARigWithWheelsIsNotLost) {
  for (ScanLine& line : recording_.scan_lines) {
    if (SecondsOf(line) < 20.0 || SecondsOf(line) > 35.0) continue;
    std::fill(line.ranges.begin(), line.ranges.end(), std::numeric_limits<float>::infinity());
  }
  MapLog([&](int64_t time_ns) { return Counted{TruthAt(time_ns)}; },
         "trajectory: {angular_acceleration_density_deg_s2: 45}\n");
  ExpectRight(0.15);
  EXPECT_GT(summary_.duration_s, 50.0);
}

// Without scans, nothing but the wheels says how the rig went round the room. The gaps begin
// in turns: from an even motion on, turning all the time, the fit to the wheels ends
// elsewhere.
TEST_F(WheelsTest, ControlPointsInAGapAreWhereTheWheelsLead) {
  recording_.rig.odometry_topic = "ODOM";
  for (const double begin_s : {14.8, 21.2}) {
    gap_begin_s_ = begin_s;
    gap_end_s_ = begin_s + 20.0;
    MapLog([&](int64_t time_ns) { return Counted{TruthAt(time_ns)}; });
    ExpectRight(0.02);
    EXPECT_GT(summary_.duration_s, 50.0);
  }
}

// Wheels that slip in a turn of 20 degrees a scan have the scan lie where no plane fits it any
// more: it is searched for.
TEST_F(MappingTest, ScansAreFoundWhereWheelsSlipInATurn) {
  for (const uint64_t seed : {8u, 9u}) {
    const Evaluation evaluation = RunCase("wheels_sharp_turns", seed);
    EXPECT_LT(evaluation.trajectory.aligned.position_m.max, 0.1) << seed;
    EXPECT_NE(summary_.consistency.verdict, Verdict::kContradictory) << seed;
  }
}

// A motion prior that is stiffer than these turns turns scans by 2 degrees where wheels slip.
TEST_F(MappingTest, SharpTurnsOfARigWithWheelsAreFollowed) {
  const Evaluation evaluation = RunCase("wheels_sharp_turns", 3502);
  EXPECT_LT(evaluation.trajectory.aligned.rotation_deg.max, 0.5);
}

// The way is known at both ends of the corridor, but not where between them the wheels
// slipped: the map is 0.1 m off there, and says so.
TEST_F(MappingTest, SlipsWhileTheWayIsOpenAreTold) {
  const Evaluation evaluation = RunCase("wheels_sharp_turns", 3501);
  ASSERT_GT(evaluation.trajectory.aligned.position_m.max, 0.05);
  EXPECT_EQ(summary_.consistency.verdict, Verdict::kDoubtful);
  ASSERT_TRUE(summary_.cause);
  EXPECT_THAT(summary_.cause->name, HasSubstr("wheels"));
}

}  // namespace
}  // namespace plumbline
