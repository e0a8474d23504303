#include "core/estimation/arrowhead_cholesky.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <random>
#include <vector>

#include "core/util/error.h"
#include "test/core/estimation/random_arrowhead.h"

namespace plumbline {
namespace {

TEST(ArrowheadCholeskyTest, SolvesAndInvertsLikeTheDenseMatrix) {
  // The last ones are cut into subdomains, and their separators again.
  for (const auto& [num_band, bandwidth, num_border] : {std::array<int, 3>{40, 7, 6},
                                                        {3, 7, 4},
                                                        {12, 0, 3},
                                                        {25, 24, 1},
                                                        {0, 3, 5},
                                                        {14, 3, 0},
                                                        {101, 2, 20},
                                                        {400, 3, 60},
                                                        {720, 3, 90}}) {
    const RandomArrowhead random(num_band, bandwidth, num_border, 8);
    const Eigen::MatrixXd& dense = random.dense;
    ArrowheadCholesky factor(random.arrowhead, BorderElimination::kLast);
    const ArrowheadCholesky nested(random.arrowhead, BorderElimination::kNested);
    const Eigen::MatrixXd expected = dense.inverse();
    const double tolerance = 1e-9 * expected.norm();
    Eigen::MatrixXd right_side(dense.rows(), 2);
    right_side << Eigen::VectorXd::LinSpaced(dense.rows(), -1.0, 2.0),
        Eigen::VectorXd::LinSpaced(dense.rows(), 3.0, 1.0);
    const Eigen::MatrixXd solution = expected * right_side;
    EXPECT_LT((factor.Solve(right_side) - solution).norm(), 1e-9 * solution.norm());
    EXPECT_LT((nested.Solve(right_side) - solution).norm(), 1e-9 * solution.norm());
    const ArrowheadInverse inverse = factor.TakeInverse();
    EXPECT_LT((inverse.border() - expected.bottomRightCorner(num_border, num_border)).norm(),
              tolerance);
    const int size = std::min(num_band, bandwidth + 1);
    for (int first = 0; first + size <= num_band && size > 0; ++first) {
      EXPECT_LT(
          (inverse.BandBlock(first, size) - expected.block(first, first, size, size)).norm(),
          tolerance)
          << first << " of " << num_band;
    }
  }
}

TEST(ArrowheadCholeskyTest, SingularMatrixIsAnError) {
  const Eigen::MatrixXd ones = Eigen::MatrixXd::Ones(2, 2);
  ArrowheadMatrix band(3, 1, 1);
  for (int i = 0; i < 4; ++i) band.AddBlock({i}, Eigen::MatrixXd::Identity(1, 1));
  band.AddBlock({0, 1}, ones - Eigen::MatrixXd::Identity(2, 2));
  EXPECT_THROW(ArrowheadCholesky(band, BorderElimination::kLast), Error);
  ArrowheadMatrix border(1, 1, 2);
  border.AddBlock({0}, Eigen::MatrixXd::Identity(1, 1));
  border.AddBlock({1, 2}, ones);
  EXPECT_THROW(ArrowheadCholesky(border, BorderElimination::kLast), Error);
  ArrowheadMatrix seen(1, 1, 2);
  seen.AddBlock({0, 1, 2}, Eigen::MatrixXd::Ones(3, 3));
  seen.AddBlock({0}, Eigen::MatrixXd::Identity(1, 1));
  EXPECT_THROW(ArrowheadCholesky(seen, BorderElimination::kNested), Error);
}

TEST(ArrowheadMatrixDeathTest, RefusesEntriesOutsideTheBand) {
  ArrowheadMatrix arrowhead(10, 2, 1);
  EXPECT_DEATH(arrowhead.AddBlock({1, 4}, Eigen::MatrixXd::Ones(2, 2)), "outside the band");
}

}  // namespace
}  // namespace plumbline
