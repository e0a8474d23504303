#include "core/estimation/pose_prior.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/estimation/linearisation.h"
#include "core/util/error.h"
#include "test/core/estimation/prior_problem.h"
#include "test/testing/temporary_directory.h"

namespace plumbline {
namespace {

using ::testing::ElementsAre;

// Information on the last two control points; of a planar rig, on turns about the vertical and
// shifts in the plane alone.
PoseGaussian Gaussian(const Trajectory& trajectory, bool planar) {
  PoseGaussian gaussian;
  gaussian.first = trajectory.num_control_points() - 2;
  Eigen::MatrixXd root(12, 12);
  for (int row = 0; row < 12; ++row) {
    for (int column = 0; column < 12; ++column) {
      const bool is_held = planar && (column % 6 < 2 || column % 6 == 5);
      root(row, column) = is_held ? 0.0 : std::sin(0.7 * (row + 1) * (column * column + 2));
    }
  }
  gaussian.information = root.transpose() * root;
  for (int i = gaussian.first; i < gaussian.end() + 2; ++i) {
    gaussian.mean.push_back(trajectory.control_point(i));
    if (gaussian.mean.size() == 2) break;
  }
  return gaussian;
}

TEST(RowsInPosesTest, ControlPointsHaveSixRowsEach) {
  const NormalEquations equations = ZeroSystem({{RotationBlock(4), 3},
                                                {PositionBlock(4), 3},
                                                {PositionBlock(5), 3},
                                                {LandmarkBlock(0), 1}});
  EXPECT_THAT(RowsInPoses(equations, 4), ElementsAre(0, 1, 2, 3, 4, 5, 9, 10, 11));
  EXPECT_THAT(RowsInPoses(equations, 5), ElementsAre(3, 4, 5));
}

TEST(RowsInPosesTest, APlanarTurnIsAboutTheVertical) {
  const NormalEquations equations =
      ZeroSystem({{RotationBlock(4), 1}, {PositionBlock(4), 3}, {RotationBlock(5), 1}});
  EXPECT_THAT(RowsInPoses(equations, 4), ElementsAre(2, 3, 4, 5, 8));
}

TEST(PosesFromTest, InformationStandsInTheRowsOfItsUnknowns) {
  PriorProblem priors(true);
  const NormalEquations equations =
      ZeroSystem({{RotationBlock(9), 1}, {PositionBlock(9), 3}, {PositionBlock(10), 3}});
  const Eigen::MatrixXd information =
      Eigen::VectorXd::LinSpaced(7, 1.0, 7.0).asDiagonal().toDenseMatrix();
  const PoseGaussian gaussian = PosesFrom(equations, information, priors.trajectory(), 9);
  EXPECT_EQ(gaussian.first, 9);
  EXPECT_EQ(gaussian.end(), PriorProblem::kNumControlPoints);
  Eigen::VectorXd diagonal(12);
  diagonal << 0.0, 0.0, 1.0, 2.0, 3.0, 4.0, 0.0, 0.0, 0.0, 5.0, 6.0, 7.0;
  EXPECT_EQ(gaussian.information, diagonal.asDiagonal().toDenseMatrix());
  EXPECT_EQ(gaussian.mean[1].position, priors.trajectory().control_point(10).position);
}

// The prior's cost is that of the Gaussian: x^T information x / 2.
TEST(PosePriorTest, IsTheGaussian) {
  for (const bool planar : {false, true}) {
    PriorProblem priors(planar);
    const PoseGaussian gaussian = Gaussian(priors.trajectory(), planar);
    priors.problem().AddPrior(PosePrior(gaussian, planar));
    const BlockLayout layout = priors.problem().Layout();
    const NormalEquations at_mean = LineariseDense(priors.problem(), layout);
    EXPECT_LT(at_mean.cost, 1e-20);
    std::vector<int> rows = RowsInPoses(at_mean, gaussian.first);
    EXPECT_LT((at_mean.hessian - gaussian.information(rows, rows)).norm(),
              1e-9 * gaussian.information.norm());
    Eigen::VectorXd shift = Eigen::VectorXd::Zero(12);
    shift(9) = 0.3;
    shift(10) = -0.2;
    priors.trajectory().control_point(gaussian.first + 1).position[0] += 0.3;
    priors.trajectory().control_point(gaussian.first + 1).position[1] -= 0.2;
    EXPECT_NEAR(LineariseDense(priors.problem(), layout).cost,
                0.5 * shift.dot(gaussian.information * shift),
                1e-9);
  }
}

TEST(PosePriorTest, PosesThatAreOpenAreAnError) {
  PriorProblem priors;
  // Known in the plane alone, for a rig that is not held there.
  const PoseGaussian gaussian = Gaussian(priors.trajectory(), true);
  EXPECT_EQ(ErrorOf([&] { PosePrior(gaussian, false); }),
            "the scans do not determine the poses");
}

TEST(AddScannerPriorsTest, EstimatedScannersHaveTheStandardDeviationsOfTheRigFile) {
  Rig rig;
  rig.scanners.resize(2);
  RigCalibration calibration;
  calibration.scanners.resize(2);
  calibration.scanners[1].prior_sigma[0] = 0.5;
  calibration.scanners[1].prior_sigma[4] = 0.01;
  Trajectory trajectory(0, 100, Rigid3d());
  std::deque<Landmark> landmarks;
  EstimationProblem problem(rig, false, &trajectory, &landmarks, &calibration);
  AddScannerPriors(calibration, &problem);
  const BlockLayout layout = problem.Layout();
  ASSERT_EQ(layout.blocks.size(), 1u);  // the other one is held
  EXPECT_EQ(layout.blocks[0], ScannerBlockId(1));
  EXPECT_THAT(layout.FreeColumns(), ElementsAre(0, 4));
  calibration.scanners[1].block[0] = 1.0;
  calibration.scanners[1].block[4] = 0.03;
  // Two and three standard deviations.
  EXPECT_NEAR(LineariseDense(problem, layout).cost, 0.5 * (4.0 + 9.0), 1e-9);
}

TEST(SetCalibrationCovarianceTest, ScannersTakeTheirPartsOfTheJointCovariance) {
  Rig rig;
  rig.scanners.resize(3);
  RigCalibration calibration;
  calibration.scanners.resize(3);
  const int size = calibration.scanners[0].BlockSize();
  for (int k = 0; k < size; ++k) {
    calibration.scanners[0].prior_sigma[static_cast<size_t>(k)] = k + 1.0;
    calibration.scanners[2].prior_sigma[static_cast<size_t>(k)] = k + 1.2;
  }
  Trajectory trajectory(0, 100, Rigid3d());
  std::deque<Landmark> landmarks;
  EstimationProblem problem(rig, false, &trajectory, &landmarks, &calibration);
  AddScannerPriors(calibration, &problem);
  SetCalibrationCovariance(problem, MapCovariance::Of(problem), &calibration);
  for (int i = 0; i < size; ++i) {
    EXPECT_NEAR(calibration.scanners[0].covariance(i, i), std::pow(i + 1.0, 2), 1e-9);
    EXPECT_NEAR(calibration.scanners[2].covariance(i, i), std::pow(i + 1.2, 2), 1e-9);
  }
  EXPECT_EQ(calibration.scanners[1].covariance.norm(), 0.0);
}

}  // namespace
}  // namespace plumbline
