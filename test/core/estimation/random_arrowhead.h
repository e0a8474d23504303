#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <random>
#include <vector>

#include "core/estimation/arrowhead_matrix.h"

namespace plumbline {

// A random positive definite matrix of the block arrowhead matrix's shape, in both forms: a
// sum of outer products of rows that touch neighbours in the band and a few variables of the
// border.
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

}  // namespace plumbline
