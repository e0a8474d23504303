#include "core/estimation/odometry_terms.h"

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "core/util/time.h"
#include "test/testing/known_room.h"

namespace plumbline {
namespace {

// Wheels that count 1.1 m a metre, on a rig that has gone 2 s along y, as its trajectory says,
// and has seen walls all the while.
class CalibrateTest : public testing::Test {
 protected:
  static constexpr double kSpeed = 0.8;  // m/s
  static constexpr double kScale = 1.1;
  static constexpr int kNumScans = 80;

  CalibrateTest() {
    for (int i = 0; i < kNumScans; ++i) room_.Observe();
    MapState& state = room_.state();
    for (int i = 0; i < state.trajectory.num_control_points(); ++i) {
      // The middle of the four intervals that a control point reaches is one knot behind it.
      const double t = (i - 1) * state.trajectory.knot_interval_s();
      state.trajectory.control_point(i).position = {0.0, kSpeed * t, 0.0};
    }
    std::vector<OdometrySample> samples;
    for (int i = -10; i <= 300; ++i) {
      const double t = 0.01 * i;
      samples.push_back(
          {RoomWalk::kStartNs + NanosecondsFromSeconds(t), {0.0, kScale * kSpeed * t}, 0.0});
    }
    state.odometry = std::make_shared<const Odometry>(samples);
    state.odometry_calibration = OdometryCalibration(OdometryOptions());
  }

  // The scale found where all that was seen lies on one wall of the room.
  double ScaleWith(size_t wall) {
    MapState& state = room_.state();
    for (Observation& observation : state.observations) {
      observation.landmark_id = static_cast<int>(wall);
    }
    OdometryCalibration calibration{OdometryOptions()};
    Calibrate(state, 0, state.trajectory.num_control_points(), &calibration);
    EXPECT_GT(calibration.num_motions(), 10);
    return calibration.length_scale();
  }

  KnownRoom room_{Eigen::Vector3d(0.0, kSpeed, 0.0)};
};

TEST_F(CalibrateTest, AWallAcrossTheWayShowsTheScale) {
  ASSERT_GT(std::abs(room_.state().landmarks[1].Normal().y()), 0.8);
  EXPECT_NEAR(ScaleWith(1), 1.0 / kScale, 0.02);
}

TEST_F(CalibrateTest, WheelsAloneDoNot) {
  ASSERT_LT(std::abs(room_.state().landmarks[0].Normal().y()), 1e-9);
  EXPECT_EQ(ScaleWith(0), 1.0);
}

}  // namespace
}  // namespace plumbline
