// A smooth corridor longer than the scanners see: for seconds nothing tells how far the rig
// has gone. The motion bridges it, the map goes on, and says what it does not know.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/mapping/mapper.h"
#include "core/options/mapper_options.h"
#include "core/sensor/recording.h"
#include "test/testing/scenario.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

constexpr double kMaxSigmas = 3.0;

class OpenDirectionTest : public MappingTest {
 protected:
  void SetUp() override {
    MappingTest::SetUp();
    Scenario scenario;
    scenario.building =
        "floor_height_m: 0.0\nceiling_height_m: 2.7\noutlines:\n"
        "  - corners: [[0.0, 0.0], [26.0, 0.0], [26.0, 2.4], [0.0, 2.4]]\n";
    scenario.scanners = TiltedRig();
    for (ScenarioScanner& scanner : scenario.scanners) scanner.max_range_m = 7.0;
    scenario.path =
        "path:\n  way_points: [[3.0, 1.2], [23.0, 1.2]]\n  corner_radius_m: 0.5\n"
        "  body_height_m: 1.2\nspeed_m_s: 1.2\n";
    WriteRecording(Simulate(scenario));
  }
};

TEST_F(OpenDirectionTest, TheMapGoesOnAndIsDoubtful) {
  const Summary summary = Map();
  EXPECT_FALSE(summary.consistency.ends_at_s.has_value());
  EXPECT_EQ(summary.planes, 6);
  EXPECT_EQ(summary.consistency.verdict, Verdict::kDoubtful);
  ASSERT_FALSE(summary.consistency.degenerate_intervals.empty());
  const DegenerateInterval& open = summary.consistency.degenerate_intervals.front();
  EXPECT_THAT(open.direction, HasSubstr("horizontal"));
  EXPECT_GT(open.end_s - open.start_s, 4.0);
  ASSERT_FALSE(summary.consistency.doubtful_intervals.empty());
  EXPECT_THAT(summary.consistency.doubtful_intervals.front().reason,
              HasSubstr("motion alone"));
}

TEST_F(OpenDirectionTest, TheStatedCovarianceCoversTheError) {
  const Rig rig = ReadRig(Path("rig.yaml"));
  RecordingReader recording(Path("recording.bag"), rig);
  const std::vector<MapResult> parts = MapRecording(
      rig, MapperOptions(), [](double) {}, &recording);
  ASSERT_EQ(parts.size(), 1u);
  const MapResult& map = parts.front();
  const Trajectory& trajectory = map.state.trajectory;
  const int64_t last_ns = map.scan_times_ns.back();
  const Eigen::Vector3d way = trajectory.WorldFromBody(last_ns).translation -
                              trajectory.WorldFromBody(map.scan_times_ns.front()).translation;
  const double duration_s = SecondsBetween(map.scan_times_ns.front(), last_ns);
  const Matrix6d covariance = map.batch.covariance.PoseAt(trajectory, last_ns);
  const Eigen::Vector3d along = way.normalized();
  const double sigma = std::sqrt(along.dot(covariance.bottomRightCorner<3, 3>() * along));
  EXPECT_LT(std::abs(way.norm() - 1.2 * duration_s), kMaxSigmas * sigma);
  // The walls on both sides, and floor and ceiling, hold what they always hold.
  EXPECT_LT(std::abs(way.z()), 0.01);
  const Eigen::Vector3d across = along.cross(Eigen::Vector3d::UnitZ());
  const double held = std::sqrt(across.dot(covariance.bottomRightCorner<3, 3>() * across));
  EXPECT_LT(held, 0.01);
  EXPECT_GT(sigma, 20.0 * held);  // along, nothing holds it
}

}  // namespace
}  // namespace plumbline
