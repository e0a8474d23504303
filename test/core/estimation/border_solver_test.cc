#include "core/estimation/border_solver.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <random>

#include "test/core/estimation/random_arrowhead.h"

namespace plumbline {
namespace {

// Right sides in pieces over the whole band, each seen again later; in the band's order as far
// as a shuffle of neighbours leaves it.
TEST(BorderSolverTest, SolvesForTheBorderLikeTheDenseMatrix) {
  for (const auto& [num_band, bandwidth, num_border] : {std::array<int, 3>{40, 7, 6},
                                                        {3, 7, 4},
                                                        {12, 1, 3},
                                                        {0, 3, 5},
                                                        {101, 2, 20},
                                                        {2000, 3, 15}}) {
    RandomArrowhead random_matrix(num_band, bandwidth, num_border, 7);
    const ArrowheadCholesky factor(std::move(random_matrix.arrowhead),
                                   BorderElimination::kLast);
    BorderSolver solver(factor);
    constexpr int kNumColumns = 30;
    Eigen::MatrixXd right = Eigen::MatrixXd::Zero(random_matrix.dense.rows(), kNumColumns);
    std::mt19937_64 random(11);
    std::normal_distribution<double> normal;
    std::uniform_int_distribution<int> jump(-15, 15);
    for (int i = 0; i < std::max(7 * kNumColumns, 2 * num_band); ++i) {
      const int column = (i / 7 + i % 3) % kNumColumns;
      if (num_band > 0) {
        const int row = std::clamp(i / 2 + jump(random), 0, num_band - 1);
        Eigen::VectorXd load(std::min(5, num_band - row));
        for (double& value : load) value = normal(random);
        solver.AddToBand(row, load, {column});
        right.col(column).segment(row, load.size()) += load;
      }
      const Eigen::Vector2d load(normal(random), normal(random));
      solver.AddToBorder(i % (num_border - 1), load, {column});
      right.col(column).segment<2>(num_band + i % (num_border - 1)) += load;
    }
    const Eigen::MatrixXd expected =
        random_matrix.dense.partialPivLu().solve(right).bottomRows(num_border);
    const Eigen::MatrixXd found = solver.TakeSolution();
    ASSERT_EQ(found.cols(), kNumColumns);
    EXPECT_LT((found - expected).norm(), 1e-9 * expected.norm())
        << num_band << " " << bandwidth << " " << num_border;
  }
}

TEST(BorderSolverTest, NoRightSidesGiveNoColumns) {
  RandomArrowhead random_matrix(40, 7, 6, 7);
  const ArrowheadCholesky factor(std::move(random_matrix.arrowhead), BorderElimination::kLast);
  BorderSolver solver(factor);
  const Eigen::MatrixXd found = solver.TakeSolution();
  EXPECT_EQ(found.rows(), 6);
  EXPECT_EQ(found.cols(), 0);
}

}  // namespace
}  // namespace plumbline
