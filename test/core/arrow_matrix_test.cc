#include "core/arrow_matrix.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <random>

#include "core/error.h"

namespace plumbline {
namespace {

// A random positive definite matrix of the arrow's shape.
Eigen::MatrixXd RandomArrow(int num_band, int bandwidth, int num_border, uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  const int size = num_band + num_border;
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(size, size);
  // Sum of outer products of rows that touch neighbours in the band and the whole border.
  for (int repeat = 0; repeat < 4 * size; ++repeat) {
    Eigen::VectorXd row = Eigen::VectorXd::Zero(size);
    if (num_band > 0) {
      const int first = repeat % num_band;
      for (int i = first; i < std::min(num_band, first + bandwidth + 1); ++i) {
        row[i] = normal(random);
      }
    }
    for (int i = num_band; i < size; ++i) row[i] = normal(random);
    matrix += row * row.transpose();
  }
  return matrix;
}

TEST(ArrowMatrixTest, MarginalisesLikeDenseSchurComplement) {
  for (const auto& [num_band, bandwidth, num_border] :
       {std::array<int, 3>{40, 7, 6}, {3, 7, 4}, {12, 0, 3}, {25, 24, 1}}) {
    const Eigen::MatrixXd dense = RandomArrow(num_band, bandwidth, num_border, 7);
    ArrowMatrix arrow(num_band, bandwidth, num_border);
    for (int column = 0; column < dense.cols(); ++column) {
      for (int row = column; row < dense.rows(); ++row) {
        if (dense(row, column) == 0.0) continue;
        // In two parts: Add() adds.
        arrow.Add(row, column, 0.25 * dense(row, column));
        arrow.Add(row, column, 0.75 * dense(row, column));
      }
    }
    const Eigen::MatrixXd b = dense.topRightCorner(num_band, num_border);
    const Eigen::MatrixXd expected =
        dense.bottomRightCorner(num_border, num_border) -
        b.transpose() * dense.topLeftCorner(num_band, num_band).inverse() * b;
    const Eigen::MatrixXd found = arrow.MarginaliseBand();
    EXPECT_LT((found - expected).norm(), 1e-9 * dense.norm())
        << num_band << " " << bandwidth << " " << num_border;
  }
}

TEST(ArrowMatrixTest, SolvesAndInvertsLikeTheDenseMatrix) {
  for (const auto& [num_band, bandwidth, num_border] :
       {std::array<int, 3>{40, 7, 6}, {3, 7, 4}, {12, 0, 3}, {25, 24, 1}}) {
    const Eigen::MatrixXd dense = RandomArrow(num_band, bandwidth, num_border, 8);
    ArrowMatrix arrow(num_band, bandwidth, num_border);
    for (int column = 0; column < dense.cols(); ++column) {
      for (int row = column; row < dense.rows(); ++row) {
        if (dense(row, column) != 0.0) arrow.Add(row, column, dense(row, column));
      }
    }
    const ArrowFactor factor(arrow);
    const Eigen::MatrixXd expected = dense.inverse();
    const double tolerance = 1e-9 * expected.norm();
    const Eigen::VectorXd right_side = Eigen::VectorXd::LinSpaced(dense.rows(), -1.0, 2.0);
    EXPECT_LT((factor.Solve(right_side) - expected * right_side).norm(), 10.0 * tolerance);
    const ArrowInverse inverse = factor.Inverse();
    EXPECT_LT((inverse.border - expected.bottomRightCorner(num_border, num_border)).norm(),
              tolerance);
    EXPECT_LT((inverse.cross - expected.topRightCorner(num_band, num_border)).norm(),
              tolerance);
    const int size = std::min(num_band, bandwidth + 1);
    for (int first = 0; first + size <= num_band; ++first) {
      EXPECT_LT(
          (inverse.BandBlock(first, size) - expected.block(first, first, size, size)).norm(),
          tolerance);
    }
  }
}

TEST(ArrowMatrixTest, SingularBandIsAnError) {
  ArrowMatrix arrow(3, 1, 1);
  for (int i = 0; i < 4; ++i) arrow.Add(i, i, 1.0);
  arrow.Add(1, 0, 1.0);
  EXPECT_THROW(arrow.MarginaliseBand(), Error);
}

TEST(ArrowMatrixDeathTest, RefusesEntriesOutsideTheBand) {
  ArrowMatrix arrow(10, 2, 1);
  EXPECT_DEATH(arrow.Add(5, 2, 1.0), "outside the band");
}

}  // namespace
}  // namespace plumbline
