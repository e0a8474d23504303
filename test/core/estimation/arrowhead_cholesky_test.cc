#include "core/estimation/arrowhead_cholesky.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <random>
#include <vector>

#include "core/util/error.h"

namespace plumbline {
namespace {

// A random positive definite matrix of the block arrowhead matrix's shape, in both forms: a sum of outer
// products of rows that touch neighbours in the band and a few variables of the border.
struct RandomArrowhead {
  RandomArrowhead(int num_band, int bandwidth, int num_border, uint64_t seed)
      : arrowhead(num_band, std::max(1, bandwidth), num_border),
        dense(Eigen::MatrixXd::Zero(num_band + num_border, num_band + num_border)) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    constexpr int kMaxSeen = 4;
    const int count = 4 * static_cast<int>(dense.rows());
    for (int repeat = 0; repeat < count; ++repeat) {
      std::vector<int> columns;
      const int first = num_band > 0 ? repeat % num_band : 0;
      for (int i = first; i < std::min(num_band, first + bandwidth + 1); ++i) {
        columns.push_back(i);
      }
      // As with planes: others come into view as time goes on.
      const int num_seen = std::min(kMaxSeen, num_border);
      const int first_seen =
          num_band > 0 ? first * (num_border - num_seen + 1) / num_band : repeat % num_border;
      for (int i = 0; i < num_seen; ++i) {
        columns.push_back(num_band + (first_seen + i) % num_border);
      }
      std::sort(columns.begin(), columns.end());
      Eigen::VectorXd row(static_cast<Eigen::Index>(columns.size()));
      for (double& value : row) value = normal(random);
      const Eigen::MatrixXd product = row * row.transpose();
      arrowhead.AddBlock(columns, product);
      dense(columns, columns) += product;
    }
  }

  ArrowheadMatrix arrowhead;
  Eigen::MatrixXd dense;
};

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
    ArrowheadCholesky factor(random.arrowhead);
    const Eigen::MatrixXd expected = dense.inverse();
    const double tolerance = 1e-9 * expected.norm();
    Eigen::MatrixXd right_side(dense.rows(), 2);
    right_side << Eigen::VectorXd::LinSpaced(dense.rows(), -1.0, 2.0),
        Eigen::VectorXd::LinSpaced(dense.rows(), 3.0, 1.0);
    const Eigen::MatrixXd solution = expected * right_side;
    EXPECT_LT((factor.Solve(right_side) - solution).norm(), 1e-9 * solution.norm());
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
  EXPECT_THROW(ArrowheadCholesky{band}, Error);
  ArrowheadMatrix border(1, 1, 2);
  border.AddBlock({0}, Eigen::MatrixXd::Identity(1, 1));
  border.AddBlock({1, 2}, ones);
  EXPECT_THROW(ArrowheadCholesky{border}, Error);
}

TEST(ArrowheadCholeskyTest, ClearsVariablesThatStandAlone) {
  ArrowheadMatrix matrix(3, 2, 2);
  for (int i = 0; i < 5; ++i) matrix.AddBlock({i}, 0.5 * Eigen::MatrixXd::Identity(1, 1));
  ArrowheadInverse inverse = ArrowheadCholesky(matrix).TakeInverse();
  inverse.Clear(2);
  inverse.Clear(3);
  const Eigen::Vector3d band(2.0, 2.0, 0.0);
  const Eigen::Vector2d border(0.0, 2.0);
  EXPECT_LT((inverse.BandBlock(0, 3) - Eigen::MatrixXd(band.asDiagonal())).norm(), 1e-12);
  EXPECT_LT((inverse.border() - Eigen::MatrixXd(border.asDiagonal())).norm(), 1e-12);
  EXPECT_EQ(inverse.BandBlock(2, 1)(0, 0), 0.0);
}

TEST(ArrowheadMatrixDeathTest, RefusesEntriesOutsideTheBand) {
  ArrowheadMatrix arrowhead(10, 2, 1);
  EXPECT_DEATH(arrowhead.AddBlock({1, 4}, Eigen::MatrixXd::Ones(2, 2)), "outside the band");
}

}  // namespace
}  // namespace plumbline
