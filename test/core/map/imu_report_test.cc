#include "core/map/imu_report.h"

#include <gtest/gtest.h>

#include <cmath>

#include "factors/spline/so3.h"

namespace plumbline {
namespace {

constexpr double kDegree = M_PI / 180.0;
constexpr int64_t kStart = 1'000'000'000;
constexpr int64_t kKnot = 50'000'000;

class ImuReportTest : public testing::Test {
 protected:
  ImuReportTest() : state_{Trajectory(kStart, kKnot, Rigid3d()), {}, {}, kStart} {
    state_.trajectory.ExtendTo(kStart + 7'000'000'000);
    Imu imu;
    imu.rotation_rad = 1.0 * kDegree;
    imu.translation_m = 0.01;
    imu.time_s = 0.002;
    imu.gyroscope.bias = 5.0 * kDegree;
    state_.calibration.imu.emplace(imu, false, 0.05);
    state_.calibration.imu->ExtendTo(140);
  }

  MapState state_;
};

TEST_F(ImuReportTest, SaysWhatTheRigFileIsOffBy) {
  ImuEstimate& imu = *state_.calibration.imu;
  imu.block[kImuTurnAt + 2] = 0.5 * kDegree;
  imu.block[kImuLeanAt] = -0.2 * kDegree;
  imu.covariance(kImuDelayAt, kImuDelayAt) = 1e-8;
  const CalibratedImu found = DescribeImu(state_);
  ASSERT_EQ(found.parameters.size(), static_cast<size_t>(kImuBlockSize));
  EXPECT_EQ(found.parameters[2].name, "yaw_deg");
  EXPECT_NEAR(found.parameters[2].value, 0.5, 1e-12);
  EXPECT_NEAR(found.parameters[2].prior_sigma, 1.0, 1e-12);
  EXPECT_EQ(found.parameters[6].name, "time_s");
  EXPECT_NEAR(found.parameters[6].sigma, 1e-4, 1e-12);
  EXPECT_EQ(found.parameters[13].name, "gravity_x_deg");
  EXPECT_NEAR(found.parameters[13].value, -0.2, 1e-12);
}

TEST_F(ImuReportTest, BiasesStandAtTheirNodes) {
  ImuEstimate& imu = *state_.calibration.imu;
  ASSERT_EQ(imu.intervals_per_bias, 8);
  ASSERT_EQ(imu.num_biases(), 19);
  imu.biases[1].gyroscope[0] = 2.0 * kDegree;
  const CalibratedImu found = DescribeImu(state_);
  ASSERT_EQ(found.biases.size(), 19u);
  EXPECT_EQ(found.biases[1].time_ns, kStart + 400'000'000);
  EXPECT_NEAR(found.biases[1].gyroscope_deg_s.x(), 2.0, 1e-12);
  EXPECT_NEAR(found.biases[0].gyroscope_sigma_deg_s.x(), 5.0, 1e-12);
}

TEST_F(ImuReportTest, TheNextRigFileHasPoseAndClock) {
  ImuEstimate& imu = *state_.calibration.imu;
  imu.block[kImuTurnAt] = 0.1;
  imu.block[kImuShiftAt + 1] = 0.02;
  imu.block[kImuDelayAt] = 0.004;
  imu.covariance.setZero();
  imu.covariance(kImuTurnAt + 1, kImuTurnAt + 1) = 1e-6;
  const Imu next = ImuAsEstimated(imu);
  EXPECT_LT(next.body_from_imu.rotation.angularDistance(Exp(Eigen::Vector3d(0.1, 0.0, 0.0))),
            1e-12);
  EXPECT_EQ(next.body_from_imu.translation, Eigen::Vector3d(0.0, 0.02, 0.0));
  EXPECT_EQ(next.time_offset_s, 0.004);
  EXPECT_NEAR(next.rotation_rad, 1e-3, 1e-12);
  EXPECT_EQ(next.translation_m, 0.0);
}

}  // namespace
}  // namespace plumbline
