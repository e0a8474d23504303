#include "core/estimation/imu_terms.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <memory>
#include <vector>

#include "core/estimation/estimation_problem.h"
#include "core/estimation/linearisation.h"
#include "core/estimation/map_covariance.h"
#include "core/estimation/normal_equations.h"
#include "core/estimation/pose_prior.h"
#include "core/geometry/matrix_types.h"
#include "core/trajectory/pose_gaussian.h"
#include "core/trajectory/pose_uncertainty.h"
#include "factors/spline/so3.h"
#include "factors/spline/spline.h"

namespace plumbline {
namespace {

constexpr int64_t kStart = 1'000'000'000;
constexpr int64_t kKnot = 50'000'000;
constexpr int kNumIntervals = 100;

// A trajectory that turns and accelerates steadily, and an IMU that is as stated.
class ImuTermsTest : public testing::Test {
 protected:
  static constexpr double kTurnRate = 0.5;      // rad/s about z
  static constexpr double kAcceleration = 0.3;  // m/s^2 along the world's x axis

  ImuTermsTest() : state_{Trajectory(kStart, kKnot, Rigid3d()), {}, {}, kStart} {
    state_.trajectory.ExtendTo(kStart + kNumIntervals * kKnot - 1);
    for (int i = 0; i < state_.trajectory.num_control_points(); ++i) {
      const double time_s = (i - 1) * 0.05;
      ControlPoint& point = state_.trajectory.control_point(i);
      Eigen::Map<Eigen::Quaterniond>(point.rotation.data()) =
          Exp(Eigen::Vector3d(0.0, 0.0, kTurnRate * time_s));
      point.position = {0.5 * kAcceleration * time_s * time_s, 0.0, 0.0};
    }
    imu_.gyroscope = {1e-3, 1e-4, 0.1, 0.0};
    imu_.accelerometer = {1e-2, 1e-3, 0.5, 0.0};
    rig_.scanners.resize(1);
  }

  // step: added to the rate about z from the middle of the time on.
  void Read(double step = 0.0) {
    std::vector<ImuSample> samples;
    for (int i = 0; i < 10 * kNumIntervals; ++i) {
      ImuSample sample;
      sample.time_ns = kStart + i * kKnot / 10 + kKnot / 20;
      const double time_s = 1e-9 * static_cast<double>(sample.time_ns - kStart);
      sample.angular_rate.z() = kTurnRate + (2 * i < 10 * kNumIntervals ? 0.0 : step);
      sample.specific_force = Exp(Eigen::Vector3d(0.0, 0.0, -kTurnRate * time_s)) *
                              Eigen::Vector3d(kAcceleration, 0.0, kStandardGravity);
      samples.push_back(sample);
    }
    state_.imu = std::make_shared<const ImuReadings>(samples, imu_);
    state_.calibration.imu.emplace(imu_, planar_, 0.05);
    state_.calibration.imu->ExtendTo(kNumIntervals);
  }

  EstimationProblem Problem() {
    return {rig_, planar_, &state_.trajectory, &state_.landmarks, &state_.calibration};
  }

  // The IMU's terms, and priors on all poses.
  void AddPosesAndImu(EstimationProblem* problem) const {
    AddImuPrior(*state_.calibration.imu, problem);
    AddImu(state_, 0, kNumIntervals, 1, problem);
    for (int i = 0; i < state_.trajectory.num_control_points(); ++i) {
      PoseGaussian pose;
      pose.first = i;
      pose.mean = {state_.trajectory.control_point(i)};
      pose.information = 1e4 * Eigen::MatrixXd::Identity(kPoseSize, kPoseSize);
      problem->AddPrior(PosePrior(pose, planar_));
    }
  }

  // The dense inverse of the problem's normal matrix; zero for what is held.
  static Eigen::MatrixXd InverseOf(const EstimationProblem& problem) {
    const BlockLayout layout = problem.Layout();
    const std::vector<int> free = layout.FreeColumns();
    const Eigen::MatrixXd hessian = LineariseDense(problem, layout).hessian;
    Eigen::MatrixXd inverse = Eigen::MatrixXd::Zero(layout.size(), layout.size());
    const Eigen::MatrixXd of_free = hessian(free, free).inverse();
    inverse(free, free) = of_free;
    return inverse;
  }

  bool planar_ = false;
  Imu imu_;
  Rig rig_;
  MapState state_;
};

TEST_F(ImuTermsTest, PerfectReadingsOfTheTrajectoryCostNothing) {
  Read();
  EstimationProblem problem = Problem();
  AddImuPrior(*state_.calibration.imu, &problem);
  AddImu(state_, 0, kNumIntervals, 1, &problem);
  const NormalEquations equations = LineariseDense(problem, problem.Layout());
  EXPECT_LT(equations.cost, 1e-6);
  // Two sensors, two means an interval, priors on the block and two biases, walks of both from
  // every eighth interval on.
  EXPECT_EQ(problem.factor_terms().size(), 4u * kNumIntervals + 3u + 2u * 13u);
}

// Biases lie in the band: an hour of them in the border would take gigabytes.
TEST_F(ImuTermsTest, CovariancesOfBiasesComeFromTheBand) {
  for (const bool planar : {false, true}) {
    planar_ = planar;
    Read();
    EstimationProblem problem = Problem();
    AddPosesAndImu(&problem);
    const BlockLayout layout = problem.Layout();
    EXPECT_EQ(layout.size() - layout.NumBandColumns(), kImuBlockSize);
    const Eigen::MatrixXd inverse = InverseOf(problem);
    SetCalibrationCovariance(problem, MapCovariance::Of(problem), &state_.calibration);
    const ImuEstimate& imu = *state_.calibration.imu;
    for (const int node : {0, 5, 13}) {
      const ImuBiases& biases = imu.biases[static_cast<size_t>(node)];
      const auto expect_near = [&](const Eigen::Matrix3d& found, const BlockId& block) {
        const int column = layout.ColumnOf(block);
        const Eigen::Matrix3d expected = inverse.block<3, 3>(column, column);
        EXPECT_LT((found - expected).norm(), 1e-6 * expected.norm()) << node;
      };
      const int last = imu.LastIntervalOf(node);
      expect_near(biases.gyroscope_covariance, GyroscopeBiasBlock(last));
      if (planar) continue;
      expect_near(biases.accelerometer_covariance, AccelerometerBiasBlock(last));
    }
    const int column = layout.ColumnOf(ImuBlockId());
    const auto of_imu = inverse.block<kImuBlockSize, kImuBlockSize>(column, column);
    for (const int i : {kImuGyroscopeScaleAt, kImuLeanAt}) {
      if (!layout.is_free[static_cast<size_t>(column + i)]) continue;
      EXPECT_NEAR(imu.covariance(i, i), of_imu(i, i), 1e-6 * of_imu(i, i));
    }
  }
}

// Behind the eighth control point stand biases.
TEST_F(ImuTermsTest, CovariancesOfPosesPassOverBiases) {
  Read();
  EstimationProblem problem = Problem();
  AddPosesAndImu(&problem);
  const BlockLayout layout = problem.Layout();
  const Eigen::MatrixXd inverse = InverseOf(problem);
  const MapCovariance covariance = MapCovariance::Of(problem);
  const Trajectory& trajectory = state_.trajectory;
  const int count = trajectory.num_control_points();
  Eigen::MatrixXd poses(6 * count, 6 * count);
  for (int i = 0; i < count; ++i) {
    for (int k = 0; k < count; ++k) {
      poses.block<6, 6>(6 * i, 6 * k) = inverse.block<6, 6>(layout.ColumnOf(RotationBlock(i)),
                                                            layout.ColumnOf(RotationBlock(k)));
    }
  }
  const PoseUncertainty uncertainty(0, poses);
  // Headings count by their information.
  const Eigen::VectorXd diagonal = LineariseArrowhead(problem, layout).diagonal;
  Eigen::VectorXd weights(count);
  for (int i = 0; i < count; ++i) weights[i] = diagonal[layout.ColumnOf(RotationBlock(i)) + 2];
  weights /= weights.sum();
  for (const int first : {3, 5, 6, 7, 8, 60}) {
    const int64_t time_ns = kStart + first * kKnot + kKnot / 3;
    const Matrix6d expected = uncertainty.At(trajectory, time_ns);
    EXPECT_LT((covariance.PoseAt(trajectory, time_ns) - expected).norm(),
              1e-6 * expected.norm())
        << first;
    const Trajectory::Location at = trajectory.Locate(time_ns);
    Eigen::MatrixXd turned = Eigen::MatrixXd::Zero(3, 6 * count);
    for (int j = 0; j < kSplineOrder; ++j) {
      turned.middleCols<3>(6 * (at.first + j) + 3)
          .diagonal()
          .setConstant(trajectory.PoseJacobian(at).position_weights[static_cast<size_t>(j)]);
    }
    const Eigen::Vector3d position = trajectory.WorldFromBody(time_ns).translation;
    for (int i = 0; i < count; ++i) {
      turned.col(6 * i + 2) -= weights[i] * Eigen::Vector3d::UnitZ().cross(position);
    }
    const Eigen::Matrix3d in_turned = turned * poses * turned.transpose();
    EXPECT_LT((covariance.PositionInTurnedMap(trajectory, time_ns) - in_turned).norm(),
              1e-6 * in_turned.norm())
        << first;
  }
}

TEST_F(ImuTermsTest, NothingWithoutReadings) {
  EstimationProblem problem = Problem();
  AddImu(state_, 0, kNumIntervals, 1, &problem);
  EXPECT_TRUE(problem.factor_terms().empty());
}

TEST_F(ImuTermsTest, ARigInThePlaneHasItsTurnsAlone) {
  planar_ = true;
  Read();
  EstimationProblem problem = Problem();
  AddImu(state_, 0, 1, 1, &problem);
  EXPECT_EQ(problem.factor_terms().size(), 2u + 1u);
  const NormalEquations equations = LineariseDense(problem, problem.Layout());
  for (const BlockId& block : equations.blocks) {
    EXPECT_NE(block.kind, BlockId::Kind::kPosition);
    EXPECT_NE(block.kind, BlockId::Kind::kAccelerometerBias);
  }
  EXPECT_LT(equations.cost, 1e-6);
}

// The readings' weight in a knot interval: J^T J of the first rotation it depends on.
double WeightAt(const MapState& state, int interval, EstimationProblem problem) {
  AddImu(state, interval, interval + 1, 1, &problem);
  const NormalEquations equations = LineariseDense(problem, problem.Layout());
  const int row = equations.offsets[FindBlock(equations, RotationBlock(interval))];
  return equations.hessian(row + 2, row + 2);
}

TEST_F(ImuTermsTest, WhatTheSplineDoesNotFollowHasLessWeight) {
  Read(0.5);
  const double usual = WeightAt(state_, 10, Problem());
  const double at_step = WeightAt(state_, kNumIntervals / 2, Problem());
  EXPECT_LT(at_step, 0.01 * usual);
  Read(1e-3);  // within the noise of a mean, 6e-3 rad/s
  EXPECT_NEAR(WeightAt(state_, kNumIntervals / 2, Problem()), usual, 1e-3 * usual);
}

TEST_F(ImuTermsTest, HeldBiasesLeaveReadingsUncertain) {
  Read();
  EstimationProblem problem = Problem();
  problem.HoldLandmarks();
  const double with_bias = WeightAt(state_, 10, std::move(problem));
  const double free = WeightAt(state_, 10, Problem());
  // Noise of a mean: 1e-3 / sqrt(0.025); bias: 0.1 rad/s.
  EXPECT_NEAR(with_bias / free, 4e-5 / (4e-5 + 1e-2), 2e-4);
}

TEST_F(ImuTermsTest, PerfectReadingsDifferByNothing) {
  Read();
  const auto difference = DifferenceFromImu(state_, 10, 30);
  ASSERT_TRUE(difference);
  EXPECT_LT(difference->turn_world.norm(), 1e-6);
  EXPECT_LT(difference->velocity_world.norm(), 1e-5);
  // A second of white noise of 1e-3 rad/s and 1e-2 m/s^2 per square root of 1 Hz.
  EXPECT_NEAR(std::sqrt(difference->turn_variance), 1e-3, 1e-6);
  EXPECT_NEAR(std::sqrt(difference->velocity_variance), 1e-2, 1e-5);
}

// As factors they have less weight, see above.
TEST_F(ImuTermsTest, TheDifferenceIsWhatTheSplineDoesNotFollow) {
  Read(0.5);
  const auto difference =
      DifferenceFromImu(state_, kNumIntervals / 2 - 10, kNumIntervals / 2 + 10);
  ASSERT_TRUE(difference);
  EXPECT_NEAR(difference->turn_world.z(), -0.25, 1e-6);  // half a second
  EXPECT_NEAR(std::sqrt(difference->turn_variance), 1e-3, 1e-6);
}

TEST_F(ImuTermsTest, DifferencesAddUp) {
  Read(0.5);
  const auto whole = DifferenceFromImu(state_, 40, 60);
  auto sum = DifferenceFromImu(state_, 40, 50);
  ASSERT_TRUE(whole && sum);
  *sum += *DifferenceFromImu(state_, 50, 60);
  EXPECT_NEAR((sum->turn_world - whole->turn_world).norm(), 0.0, 1e-12);
  EXPECT_NEAR(sum->velocity_variance, whole->velocity_variance, 1e-12);
}

TEST_F(ImuTermsTest, NoDifferenceWhereReadingsAreMissing) {
  Read();
  state_.trajectory.ExtendTo(kStart + (kNumIntervals + 10) * kKnot);
  state_.calibration.imu->ExtendTo(kNumIntervals + 10);
  EXPECT_TRUE(DifferenceFromImu(state_, kNumIntervals - 1, kNumIntervals));
  EXPECT_FALSE(DifferenceFromImu(state_, kNumIntervals - 1, kNumIntervals + 1));
}

TEST_F(ImuTermsTest, CovariancesGoWhereTheyBelong) {
  Read();
  ImuEstimate& imu = *state_.calibration.imu;
  const Eigen::MatrixXd covariance = Eigen::VectorXd::LinSpaced(30, 1.0, 30.0).asDiagonal();
  SetImuCovariance(ImuBlockId(), covariance, 0, &imu);
  EXPECT_EQ(imu.covariance(2, 2), 3.0);
  SetImuCovariance(AccelerometerBiasBlock(imu.LastIntervalOf(1)), covariance, 15, &imu);
  EXPECT_EQ(imu.biases[1].accelerometer_covariance(0, 0), 16.0);
}

}  // namespace
}  // namespace plumbline
