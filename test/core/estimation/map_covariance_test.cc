// Of maps: end_to_end/covariance_test.cc.

#include "core/estimation/map_covariance.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <vector>

#include "core/estimation/linearisation.h"
#include "core/trajectory/pose_uncertainty.h"
#include "core/util/error.h"
#include "test/core/estimation/prior_problem.h"

namespace plumbline {
namespace {

using ::testing::ElementsAre;

Eigen::MatrixXd InverseOf(const Eigen::MatrixXd& matrix) {
  return matrix.llt().solve(Eigen::MatrixXd::Identity(matrix.rows(), matrix.cols()));
}

TEST(MapCovarianceTest, IsTheInverseOfTheNormalMatrix) {
  PriorProblem priors;
  priors.AddAllPriors();
  const MapCovariance covariance = MapCovariance::Of(priors.problem());
  const Eigen::MatrixXd inverse = InverseOf(priors.Hessian());
  EXPECT_THAT(covariance.landmark_ids(), ElementsAre(0, 1));
  EXPECT_THAT(covariance.offsets(), ElementsAre(0, 1, 4));
  EXPECT_LT((covariance.landmarks() - inverse.bottomRightCorner(4, 4)).norm(),
            1e-9 * inverse.bottomRightCorner(4, 4).norm());
  EXPECT_EQ(covariance.scanners().size(), 0);
  const Eigen::MatrixXd points = inverse.block(30, 30, 24, 24);
  EXPECT_LT((covariance.OfBand(30, 24) - points).norm(), 1e-9 * points.norm());
}

TEST(MapCovarianceTest, PoseIsThatOfItsControlPoints) {
  PriorProblem priors;
  priors.AddAllPriors();
  const MapCovariance covariance = MapCovariance::Of(priors.problem());
  const Eigen::MatrixXd inverse = InverseOf(priors.Hessian());
  const PoseUncertainty uncertainty(0, inverse.topLeftCorner(66, 66));
  for (const double knots : {0.0, 2.3, 7.9}) {
    const int64_t time_ns =
        PriorProblem::kStartNs + static_cast<int64_t>(knots * PriorProblem::kKnotNs);
    const Matrix6d expected = uncertainty.At(priors.trajectory(), time_ns);
    EXPECT_LT((covariance.PoseAt(priors.trajectory(), time_ns) - expected).norm(),
              1e-9 * expected.norm());
  }
}

// With errors that repeat, too.
TEST(MapCovarianceTest, PositionsInATurnedMapAreApartFromItsHeading) {
  for (const bool planar : {false, true}) {
    PriorProblem priors(planar);
    priors.AddAllPriors();
    const int block_size = planar ? 4 : 6;
    const int heading = planar ? 0 : 2;
    const Eigen::Index size = PriorProblem::kNumControlPoints * block_size;
    CorrelatedErrors errors;
    errors.shift = Eigen::VectorXd::LinSpaced(size, -0.3, 0.4);
    errors.landmarks = Eigen::MatrixXd::Zero(4, 4);
    const BlockLayout layout = priors.problem().Layout();
    for (Eigen::Index i = 0; i < size; ++i) {
      if (!layout.is_free[static_cast<size_t>(i)]) errors.shift.row(i).setZero();
    }
    const MapCovariance covariance =
        MapCovariance::Of(priors.problem(),
                          LineariseArrowhead(priors.problem(), layout),
                          [&](const ArrowheadCholesky&) { return errors; });
    const int64_t time_ns = PriorProblem::kStartNs + 23 * PriorProblem::kKnotNs / 10;
    const Trajectory::Location at = priors.trajectory().Locate(time_ns);
    Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(3, size);
    for (int j = 0; j < 4; ++j) {
      jacobian.middleCols<3>((at.first + j) * block_size + block_size - 3)
          .diagonal()
          .setConstant(priors.trajectory().PoseJacobian(at).position_weights[j]);
    }
    const Eigen::Vector3d position = priors.trajectory().WorldFromBody(time_ns).translation;
    const Eigen::VectorXd information = priors.Hessian().diagonal();
    double sum = 0.0;
    for (int i = heading; i < size; i += block_size) sum += information[i];
    for (int i = heading; i < size; i += block_size) {
      jacobian.col(i) -=
          information[i] / sum * Eigen::Vector3d(-position.y(), position.x(), 0.0);
    }
    const std::vector<int> free = layout.FreeColumns();
    Eigen::MatrixXd joint = Eigen::MatrixXd::Zero(layout.size(), layout.size());
    joint(free, free) = InverseOf(priors.Hessian()(free, free));
    joint.topLeftCorner(size, size) += errors.shift * errors.shift.transpose();
    const Eigen::Matrix3d expected =
        jacobian * joint.topLeftCorner(size, size) * jacobian.transpose();
    const Eigen::Matrix3d found = covariance.PositionInTurnedMap(priors.trajectory(), time_ns);
    EXPECT_LT((found - expected).norm(), 1e-9 * expected.norm()) << planar;
  }
}

TEST(MapCovarianceTest, PosesOnSurfacesAreLessUncertain) {
  PriorProblem priors;
  priors.AddAllPriors();
  const MapCovariance held = MapCovariance::OfPoses(priors.problem());
  const Eigen::MatrixXd points =
      InverseOf(priors.Hessian().topLeftCorner(66, 66)).block(30, 30, 24, 24);
  EXPECT_LT((held.OfBand(30, 24) - points).norm(), 1e-9 * points.norm());
  EXPECT_LT(points.trace(), MapCovariance::Of(priors.problem()).OfBand(30, 24).trace());
}

// A planar rig: heights and tilts are held, and have no variance.
TEST(MapCovarianceTest, WhatIsHeldHasNoVariance) {
  PriorProblem priors(true);
  priors.AddAllPriors();
  const MapCovariance covariance = MapCovariance::Of(priors.problem());
  const Matrix6d pose =
      covariance.PoseAt(priors.trajectory(), PriorProblem::kStartNs + PriorProblem::kKnotNs);
  for (const int held : {0, 1, 5}) {
    EXPECT_EQ(pose.row(held).norm() + pose.col(held).norm(), 0.0) << held;
  }
  for (const int free : {2, 3, 4}) EXPECT_GT(pose(free, free), 0.0) << free;
}

TEST(MapCovarianceTest, CorrelatedErrorsAreAdded) {
  PriorProblem priors;
  priors.AddAllPriors();
  const BlockLayout layout = priors.problem().Layout();
  CorrelatedErrors errors;
  errors.shift = Eigen::MatrixXd::Zero(layout.NumBandColumns(), 1);
  errors.shift(3, 0) = 0.5;
  errors.landmarks = 0.25 * Eigen::MatrixXd::Identity(4, 4);
  const MapCovariance plain = MapCovariance::Of(priors.problem());
  const MapCovariance covariance =
      MapCovariance::Of(priors.problem(),
                        LineariseArrowhead(priors.problem(), layout),
                        [&](const ArrowheadCholesky&) { return errors; });
  EXPECT_LT((covariance.landmarks() - plain.landmarks() - errors.landmarks).norm(), 1e-12);
  Eigen::MatrixXd added = covariance.OfBand(0, 12) - plain.OfBand(0, 12);
  EXPECT_NEAR(added(3, 3), 0.25, 1e-12);
  added(3, 3) = 0.0;
  EXPECT_LT(added.norm(), 1e-12);
}

TEST(MapCovarianceTest, WeakDirectionsAreTheLeastEigenvalues) {
  PriorProblem priors;
  priors.AddAllPriors();
  const Eigen::MatrixXd hessian = priors.Hessian();
  const Eigen::VectorXd scale = hessian.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::VectorXd eigenvalues = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(
                                          scale.asDiagonal() * hessian * scale.asDiagonal())
                                          .eigenvalues();
  const MapCovariance covariance = MapCovariance::Of(priors.problem());
  const auto& weak = covariance.weak_directions();
  ASSERT_EQ(weak.size(), 3u);
  EXPECT_NEAR(weak[0].eigenvalue, eigenvalues[0], 1e-3 * eigenvalues[0]);
  EXPECT_LE(weak[0].eigenvalue, weak[1].eigenvalue);
  EXPECT_LE(weak[1].eigenvalue, weak[2].eigenvalue);
  for (const WeakDirection& direction : weak) {
    EXPECT_GT(direction.share, 0.0);
    EXPECT_LE(direction.share, 1.0 + 1e-12);
  }
}

TEST(MapCovarianceTest, UnknownsThatNothingDeterminesAreAnError) {
  PriorProblem priors;
  priors.AddPrior({PositionBlock(0), LandmarkBlock(0)},
                  Eigen::Vector4d(1.0, 0.0, 1.0, 1.0).asDiagonal().toDenseMatrix());
  EXPECT_THROW(MapCovariance::Of(priors.problem()), Error);
}

}  // namespace
}  // namespace plumbline
