#include <ceres/manifold.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <functional>
#include <utility>

#include "core/estimation/block_layout.h"
#include "core/estimation/estimation_problem.h"
#include "core/estimation/normal_equations.h"
#include "core/util/error.h"

namespace plumbline {
namespace {

// Up to so many, the copies that Eigen's general product makes take longer than the product.
constexpr Eigen::Index kFewResiduals = 3;

}  // namespace

double EstimationProblem::VisitProducts(const BlockLayout& layout,
                                        const ProductVisitor& visit) const {
  double cost = 0.0;
  Eigen::MatrixXd product;
  Eigen::VectorXd gradient;
  VisitResidualBlocks(factors_,
                      layout,
                      [&](const std::vector<int>& columns,
                          const Eigen::MatrixXd& jacobian,
                          const Eigen::VectorXd& residuals) {
                        cost += 0.5 * residuals.squaredNorm();
                        if (residuals.size() <= kFewResiduals) {
                          product = jacobian.transpose().lazyProduct(jacobian);
                        } else {
                          product.noalias() = jacobian.transpose() * jacobian;
                        }
                        gradient.noalias() = jacobian.transpose() * residuals;
                        visit(columns, product, gradient);
                      });
  return cost;
}

NormalEquations EstimationProblem::Linearise(const BlockLayout& layout) const {
  NormalEquations equations;
  equations.blocks = layout.blocks;
  equations.offsets = layout.offsets;
  equations.hessian.setZero(equations.size(), equations.size());
  equations.gradient.setZero(equations.size());
  equations.cost =
      VisitProducts(layout,
                    [&](const std::vector<int>& columns,
                        const Eigen::MatrixXd& product,
                        const Eigen::VectorXd& gradient) {
                      for (size_t j = 0; j < columns.size(); ++j) {
                        const auto at = static_cast<Eigen::Index>(j);
                        equations.gradient[columns[j]] += gradient[at];
                        double* const column = equations.hessian.col(columns[j]).data();
                        for (size_t i = j; i < columns.size(); ++i) {
                          column[columns[i]] += product(static_cast<Eigen::Index>(i), at);
                        }
                      }
                    });
  const BlockPositions positions = PositionsIn(layout);
  for (const GroupTerm& term : groups_) AddGroup(term, layout, positions, &equations);
  equations.hessian.triangularView<Eigen::StrictlyUpper>() = equations.hessian.transpose();
  return equations;
}

std::vector<EstimationProblem::RowRange> EstimationProblem::RowRangesOf(
    const GroupTerm& term, const BlockLayout& layout, const BlockPositions& positions) const {
  const SegmentGroup& group = term.group->group();
  const auto num_poses = static_cast<size_t>(group.num_control_points());
  std::vector<RowRange> ranges;
  const auto add = [&](size_t block, int row, int num_rows) {
    const size_t at = positions.at(term.blocks[block]);
    const int begin = layout.offsets[at];
    const int end = layout.offsets[at + 1];
    // Where only the yaw is estimated, it is the last of a rotation's rows.
    row += num_rows - (end - begin);
    for (int column = begin; column < end; ++column, ++row) {
      if (!layout.is_free[static_cast<size_t>(column)]) continue;
      if (ranges.empty() || ranges.back().row + ranges.back().size != row ||
          ranges.back().column + ranges.back().size != column) {
        ranges.push_back({row, column, 0});
      }
      ++ranges.back().size;
    }
  };
  for (size_t i = 0; i < num_poses; ++i) {
    add(i, 6 * static_cast<int>(i), 3);
    add(num_poses + i, 6 * static_cast<int>(i) + 3, 3);
  }
  const std::vector<int>& offsets = group.plane_offsets();
  for (size_t i = 0; i + 1 < offsets.size(); ++i) {
    add(2 * num_poses + i, offsets[i], offsets[i + 1] - offsets[i]);
  }
  return ranges;
}

void EstimationProblem::AddGroup(const GroupTerm& term,
                                 const BlockLayout& layout,
                                 const BlockPositions& positions,
                                 NormalEquations* equations) const {
  const std::vector<RowRange> ranges = RowRangesOf(term, layout, positions);
  const LinearisedGroup::Model model = term.group->ModelAt(term.blocks.data());
  equations->cost += model.cost;
  for (size_t j = 0; j < ranges.size(); ++j) {
    const RowRange& by_column = ranges[j];
    equations->gradient.segment(by_column.column, by_column.size) +=
        model.gradient.segment(by_column.row, by_column.size);
    for (size_t i = j; i < ranges.size(); ++i) {
      const RowRange& by_row = ranges[i];
      equations->hessian.block(by_row.column, by_column.column, by_row.size, by_column.size) +=
          model.hessian.block(by_row.row, by_column.row, by_row.size, by_column.size);
    }
  }
}

EstimationProblem::Values EstimationProblem::ValuesOf(const BlockLayout& layout) const {
  Values values(layout.blocks.size());
  for (size_t i = 0; i < layout.blocks.size(); ++i) {
    std::copy_n(Data(layout.blocks[i]), AmbientSize(layout.blocks[i]), values[i].begin());
  }
  return values;
}

void EstimationProblem::SetValues(const BlockLayout& layout, const Values& values) {
  for (size_t i = 0; i < layout.blocks.size(); ++i) {
    std::copy_n(values[i].begin(), AmbientSize(layout.blocks[i]), Data(layout.blocks[i]));
  }
}

void EstimationProblem::Move(const BlockLayout& layout, const Eigen::VectorXd& step) {
  const double* next = step.data();
  for (const BlockId& block : layout.blocks) {
    double* data = Data(block);
    const int size = AmbientSize(block);
    std::array<double, 4> moved;
    if (const ceres::Manifold* manifold = ManifoldOf(block)) {
      manifold->Plus(data, next, moved.data());
      next += manifold->TangentSize();
    } else {
      std::transform(data, data + size, next, moved.begin(), std::plus<>());
      next += size;
    }
    std::copy_n(moved.begin(), size, data);
  }
}

NormalEquations EstimationProblem::SolveNormalEquations(int max_iterations,
                                                        double function_tolerance) {
  const BlockLayout layout = Layout();
  const std::vector<int> free = layout.FreeColumns();
  NormalEquations now = Linearise(layout);
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    const int num_linearisations = NumLinearisations();
    const Eigen::LLT<Eigen::MatrixXd> factor(Eigen::MatrixXd(now.hessian(free, free)));
    if (factor.info() != Eigen::Success) {
      throw Error("the estimation failed: its normal equations are singular");
    }
    const Values values = ValuesOf(layout);
    const Eigen::VectorXd gradient = now.gradient(free);
    Move(layout, -factor.solve(gradient));
    NormalEquations next = Linearise(layout);
    if (!(now.cost - next.cost > function_tolerance * now.cost)) {
      SetValues(layout, values);
      break;
    }
    now = std::move(next);
    if (NumLinearisations() == num_linearisations) break;  // the problem was linear
  }
  return now;
}

}  // namespace plumbline
