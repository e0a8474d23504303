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
  std::map<std::string, double> found(summary_.motion_found.begin(),
                                      summary_.motion_found.end());
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

}  // namespace
}  // namespace plumbline
