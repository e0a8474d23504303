#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "factors/imu/imu_block.h"
#include "factors/spline/so3.h"
#include "factors/spline/spline.h"
#include "test/testing/factor_testing.h"

namespace plumbline {

inline constexpr double kTestInterval = 0.05;  // s
inline constexpr double kTestGravity = 9.8;    // m/s^2

// A spline that turns by `step` from control point to control point, an IMU that is not quite
// as stated, and what it reads, by differences of poses: no derivative of the spline.
class ImuFactorTest : public testing::Test {
 protected:
  void MakeMotion(double step) {
    blocks_.AddSpline(kSplineOrder, step, &random_);
    imu_.setZero(kImuBlockSize);
    imu_.segment<3>(kImuTurnAt) = Eigen::Vector3d(0.02, -0.03, 0.01);
    imu_.segment<3>(kImuShiftAt) = Eigen::Vector3d(0.01, 0.02, -0.03);
    imu_[kImuDelayAt] = 0.003;
    imu_.segment<3>(kImuGyroscopeScaleAt) = Eigen::Vector3d(0.03, -0.02, 0.01);
    imu_.segment<3>(kImuAccelerometerScaleAt) = Eigen::Vector3d(-0.01, 0.02, 0.03);
    imu_.segment<2>(kImuLeanAt) = Eigen::Vector2d(0.05, -0.02);
    stated_.body_from_imu = random_.Rotation(2.0);
    stated_.position_body = random_.Vector(0.3);
  }

  // Pose of the IMU at an instant in knot intervals, readings' delay included.
  SplinePose ImuAt(double u) {
    const std::vector<const double*> data = blocks_.pointers();
    const SplinePose body = EvaluatePose(data.data(),
                                         data.data() + kSplineOrder,
                                         u + imu_[kImuDelayAt] / kTestInterval,
                                         nullptr);
    const Eigen::Vector3d turn = imu_.segment<3>(kImuTurnAt);
    const Eigen::Vector3d lever = stated_.position_body + imu_.segment<3>(kImuShiftAt);
    return {body.world_from_body * Exp(turn) * stated_.body_from_imu,
            body.position + body.world_from_body * lever};
  }

  Eigen::Vector3d RateAt(double u) {
    constexpr double kStep = 1e-3;
    const Eigen::Quaterniond turn =
        ImuAt(u - kStep).world_from_body.conjugate() * ImuAt(u + kStep).world_from_body;
    return Log(turn) / (2.0 * kStep * kTestInterval);
  }

  Eigen::Vector3d ForceAt(double u) {
    constexpr double kStep = 1e-3;
    const double step_s = kStep * kTestInterval;
    const SplinePose now = ImuAt(u);
    const Eigen::Vector3d acceleration =
        (ImuAt(u + kStep).position - 2.0 * now.position + ImuAt(u - kStep).position) /
        (step_s * step_s);
    const Eigen::Vector3d lean(imu_[kImuLeanAt], imu_[kImuLeanAt + 1], 0.0);
    const Eigen::Vector3d gravity = Exp(lean) * Eigen::Vector3d(0.0, 0.0, -kTestGravity);
    return now.world_from_body.conjugate() * (acceleration - gravity);
  }

  // Adds the blocks that follow those of the spline.
  void AddImuBlocks() {
    blocks_.AddEuclidean(imu_);
    blocks_.AddEuclidean(Eigen::Vector3d(0.1, 0.2, -0.1));
    blocks_.AddEuclidean(Eigen::Vector3d(0.3, 0.1, -0.2));
  }

  // What a sensor of these scales and biases reads where there is `value`.
  Eigen::Vector3d Reading(const Eigen::Vector3d& value, int scale_at, double share) const {
    const Eigen::Vector3d bias = (1.0 - share) * Eigen::Vector3d(0.1, 0.2, -0.1) +
                                 share * Eigen::Vector3d(0.3, 0.1, -0.2);
    return value + imu_.segment<3>(scale_at).cwiseProduct(value) + bias;
  }

  TestRandom random_{5};
  TestBlocks blocks_;
  Eigen::VectorXd imu_;
  ImuPose stated_;
};

}  // namespace plumbline
