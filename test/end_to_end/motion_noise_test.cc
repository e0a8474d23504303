#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <iterator>
#include <map>
#include <string>

#include "core/mapping/mapper.h"
#include "core/sensor/recording.h"
#include "core/util/time.h"
#include "test/testing/scenario.h"

namespace plumbline {
namespace {

// A rig that swings: the height's acceleration is a sine of 1.9 m/s^2.
class MotionNoiseTest : public MappingTest {
 protected:
  void SimulateSwing(uint64_t seed) {
    Scenario scenario;
    scenario.building = PillarRoom();
    scenario.scanners = TiltedRig();
    for (ScenarioScanner& scanner : scenario.scanners) scanner.scan_rate_hz = 40.0;
    scenario.path = PillarWalk(7.0, 1.0);
    scenario.more =
        "motion:\n"
        "  roll: {amplitude_deg: 3.0, frequency_hz: 0.9}\n"
        "  height: {amplitude_m: 0.03, frequency_hz: 1.27}\n";
    recording_ = Simulate(scenario, seed);
    WriteRecording(recording_);
  }

  // Mean over all poses of the height's squared error over its stated variance.
  double NeesOfHeight(const MapperOptions& options) {
    RecordingReader reader(Path("recording.bag"), recording_.rig);
    const MapResult result = MapRecording(
        recording_.rig, options, [](double) {}, &reader);
    std::map<int64_t, double> true_height;
    for (const StampedPose& pose : recording_.truth_trajectory) {
      true_height[pose.time_ns] = pose.world_from_body.translation.z();
    }
    const auto at = [&](int64_t time_ns) {
      const auto after = true_height.lower_bound(time_ns);
      if (after == true_height.begin()) return after->second;
      const auto before = std::prev(after);
      if (after == true_height.end()) return before->second;
      return before->second + (after->second - before->second) *
                                  SecondsBetween(before->first, time_ns) /
                                  SecondsBetween(before->first, after->first);
    };
    const double origin = at(result.state.origin_time_ns);
    double sum = 0.0;
    int count = 0;
    for (const int64_t time_ns : result.scan_times_ns) {
      const double variance =
          result.batch.covariance.PoseAt(result.state.trajectory, time_ns)(5, 5);
      if (variance < 1e-8) continue;  // the origin itself
      const double height = result.state.trajectory.WorldFromBody(time_ns).translation.z();
      sum += std::pow(height - (at(time_ns) - origin), 2) / variance;
      ++count;
    }
    return sum / count;
  }

  SimulatedRecording recording_;
};

TEST_F(MotionNoiseTest, IsThatOfTheTrueMotion) {
  SimulateSwing(1);
  // True accelerations from second differences over 50 ms.
  constexpr size_t kStep = 10;
  const auto& truth = recording_.truth_trajectory;
  const double interval_s = SecondsBetween(truth[0].time_ns, truth[kStep].time_ns);
  double horizontal = 0.0, vertical = 0.0;
  int count = 0;
  for (size_t i = kStep; i + kStep < truth.size(); ++i, ++count) {
    const Eigen::Vector3d acceleration = (truth[i - kStep].world_from_body.translation -
                                          2.0 * truth[i].world_from_body.translation +
                                          truth[i + kStep].world_from_body.translation) /
                                         (interval_s * interval_s);
    horizontal += acceleration.head<2>().squaredNorm() / 2.0;
    vertical += acceleration.z() * acceleration.z();
  }
  Map();
  std::map<std::string, double> found(summary_.motion_noise.begin(),
                                      summary_.motion_noise.end());
  ASSERT_EQ(found.size(), 3u);
  // A standard deviation that n accelerations show has a standard error of 1 / sqrt(2 n) of
  // itself. There is one for each knot interval of 125 ms, horizontal ones have two axes.
  const double num_knots = summary_.duration_s / 0.125;
  const double two_errors = 2.0 / std::sqrt(2.0 * num_knots);
  EXPECT_NEAR(found["vertical_m_s2"] / std::sqrt(vertical / count), 1.0, two_errors);
  EXPECT_NEAR(found["horizontal_m_s2"] / std::sqrt(horizontal / count),
              1.0,
              two_errors / std::sqrt(2.0));
}

// A prior that is far too narrow for the motion smooths it, and states that this were right.
// In 7 s there are 14 heights that share none of the control points, which have effect for
// 0.5 s each: honest, the NEES lies between quantiles of the chi-square distribution with 14
// degrees of freedom, 2.5 % below 5.63, 2.5 % over 26.1 and 0.1 % over 36.1.
TEST_F(MotionNoiseTest, MakesHonestWhatANarrowPriorStates) {
  SimulateSwing(2);
  MapperOptions options;
  options.trajectory.acceleration_stddev_m_s2 = 0.2;
  const double estimated = NeesOfHeight(options);
  EXPECT_GT(estimated, 5.63 / 14.0);
  EXPECT_LT(estimated, 26.1 / 14.0);
}

}  // namespace
}  // namespace plumbline
