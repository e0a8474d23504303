#include "core/estimation/linearisation.h"

#include <ceres/cost_function.h>
#include <ceres/manifold.h>
#include <glog/logging.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <unordered_map>
#include <utility>

#include "core/util/ordered_pipeline.h"

namespace plumbline {
namespace {

using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Number of rows up to which a product takes less time than the copies that Eigen's general
// product makes.
constexpr Eigen::Index kFewResiduals = 3;

// Position in the layout of each block that it has, by the block's data.
using BlockPositions = std::unordered_map<const double*, size_t>;

BlockPositions PositionsIn(const EstimationProblem& problem, const BlockLayout& layout) {
  BlockPositions positions;
  for (size_t i = 0; i < layout.blocks.size(); ++i) {
    positions[problem.unknowns().Data(layout.blocks[i])] = i;
  }
  return positions;
}

// Evaluates factor terms one after the other. Ceres' own evaluation of a residual block takes
// several times what the factors do.
class FactorEvaluator {
 public:
  FactorEvaluator(const EstimationProblem& problem, const BlockLayout& layout)
      : problem_(problem), layout_(layout), positions_(PositionsIn(problem, layout)) {}

  void Evaluate(const FactorTerm& term) {
    Order(term);
    const ceres::CostFunction& factor = *term.factor;
    const int num_residuals = factor.num_residuals();
    const std::vector<int>& sizes = factor.parameter_block_sizes();
    residuals_.resize(num_residuals);
    values_.resize(
        static_cast<size_t>(num_residuals * std::accumulate(sizes.begin(), sizes.end(), 0)));
    by_parameters_.assign(term.blocks.size(), nullptr);
    double* next = values_.data();
    for (const auto& [at, i] : order_) {
      by_parameters_[i] = next;
      next += num_residuals * sizes[i];
    }
    CHECK(factor.Evaluate(term.blocks.data(), residuals_.data(), by_parameters_.data()));
    jacobian_.resize(num_residuals, static_cast<Eigen::Index>(columns_.size()));
    Eigen::Index column = 0;
    for (const auto& [at, i] : order_) {
      column += TakeBlock(layout_.blocks[at], term.blocks[i], by_parameters_[i], column);
    }
  }

  const std::vector<int>& columns() const { return columns_; }
  const Eigen::MatrixXd& jacobian() const { return jacobian_; }
  const Eigen::VectorXd& residuals() const { return residuals_; }

 private:
  // The term's blocks in the order of the layout; blocks that it lacks are constant.
  void Order(const FactorTerm& term) {
    order_.clear();
    columns_.clear();
    for (size_t i = 0; i < term.blocks.size(); ++i) {
      const auto at = positions_.find(term.blocks[i]);
      if (at != positions_.end()) order_.emplace_back(at->second, i);
    }
    std::sort(order_.begin(), order_.end());
    for (const auto& [at, i] : order_) {
      for (int column = layout_.offsets[at]; column < layout_.offsets[at + 1]; ++column) {
        if (layout_.is_free[static_cast<size_t>(column)]) columns_.push_back(column);
      }
    }
  }

  // Writes a block's part of the Jacobian, by its tangent; returns the tangent's size.
  Eigen::Index TakeBlock(const BlockId& block,
                         const double* data,
                         const double* by_parameters,
                         Eigen::Index column) {
    const Eigen::Index num_residuals = residuals_.size();
    const int ambient = problem_.unknowns().AmbientSize(block);
    const Eigen::Map<const RowMajorMatrix> by_block(by_parameters, num_residuals, ambient);
    const ceres::Manifold* manifold = problem_.unknowns().ManifoldOf(block);
    if (manifold == nullptr) {
      jacobian_.middleCols(column, ambient) = by_block;
      return ambient;
    }
    const int size = manifold->TangentSize();
    manifold->PlusJacobian(data, tangents_.data());
    jacobian_.middleCols(column, size) = by_block.lazyProduct(
        Eigen::Map<const RowMajorMatrix>(tangents_.data(), ambient, size));
    return size;
  }

  const EstimationProblem& problem_;
  const BlockLayout& layout_;
  BlockPositions positions_;
  std::vector<std::pair<size_t, size_t>> order_;  // position in the layout, in the term
  std::vector<double> values_;
  std::vector<double*> by_parameters_;  // Jacobians by the blocks' ambient parameters
  std::array<double, Unknowns::kLargestBlock * Unknowns::kLargestBlock>
      tangents_;  // of the largest block
  std::vector<int> columns_;
  Eigen::MatrixXd jacobian_;
  Eigen::VectorXd residuals_;
};

// Visits (columns, J^T J, J^T r) of all factor terms; returns their cost.
double VisitProducts(const EstimationProblem& problem,
                     const BlockLayout& layout,
                     const ResidualVisitor& visit) {
  double cost = 0.0;
  Eigen::MatrixXd product;
  Eigen::VectorXd gradient;
  VisitFactors(problem,
               layout,
               std::nullopt,
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

// Rows of a group that are consecutive columns of a layout, too.
struct RowRange {
  int row;
  int column;
  int size;
};

// A group's rows that are free, ascending in the layout as in the group.
std::vector<RowRange> RowRangesOf(const GroupTerm& term,
                                  const BlockLayout& layout,
                                  const BlockPositions& positions) {
  const SegmentGroup& group = term.group->group();
  const auto num_poses = static_cast<size_t>(group.num_control_points());
  std::vector<RowRange> ranges;
  const auto add = [&](size_t block, int row, int num_rows) {
    const auto found = positions.find(term.blocks[block]);
    if (found == positions.end()) return;  // held
    const size_t at = found->second;
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
  for (int i = 0; i < group.num_estimated_scanners(); ++i) {
    add(2 * num_poses + offsets.size() - 1 + static_cast<size_t>(i),
        group.ScannerOffset(i),
        group.ScannerSize(i));
  }
  return ranges;
}

// Adds a group's cost, gradient and the lower triangle of its Hessian.
void AddGroup(const GroupTerm& term,
              const BlockLayout& layout,
              const BlockPositions& positions,
              NormalEquations* equations) {
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

// Nothing but the unit diagonal of what is held.
ArrowheadEquations EmptyEquations(const BlockLayout& layout, bool planar) {
  const int num_band = layout.NumBandColumns();
  const int tile_size =
      std::max(kTileControlPoints * (planar ? 4 : 6), layout.WidthOfBiases());
  ArrowheadEquations equations{ArrowheadMatrix(num_band, tile_size, layout.size() - num_band),
                               Eigen::VectorXd::Zero(layout.size()),
                               Eigen::VectorXd::Zero(layout.size())};
  for (int i = 0; i < layout.size(); ++i) {
    if (layout.is_free[static_cast<size_t>(i)]) continue;
    equations.hessian.AddBlock({i}, Eigen::MatrixXd::Identity(1, 1));
    equations.diagonal[i] = 1.0;
  }
  return equations;
}

}  // namespace

int NumGroupLinearisations(const EstimationProblem& problem) {
  int count = 0;
  for (const GroupTerm& term : problem.group_terms()) {
    count += term.group->num_linearisations();
  }
  return count;
}

void VisitFactors(const EstimationProblem& problem,
                  const BlockLayout& layout,
                  std::optional<FactorTerm::Kind> kind,
                  const ResidualVisitor& visit) {
  FactorEvaluator evaluator(problem, layout);
  for (const FactorTerm& term : problem.factor_terms()) {
    if (kind && term.kind != *kind) continue;
    evaluator.Evaluate(term);
    visit(evaluator.columns(), evaluator.jacobian(), evaluator.residuals());
  }
}

NormalEquations LineariseDense(const EstimationProblem& problem, const BlockLayout& layout) {
  NormalEquations equations;
  equations.blocks = layout.blocks;
  equations.offsets = layout.offsets;
  equations.hessian.setZero(equations.size(), equations.size());
  equations.gradient.setZero(equations.size());
  equations.cost =
      VisitProducts(problem,
                    layout,
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
  const BlockPositions positions = PositionsIn(problem, layout);
  for (const GroupTerm& term : problem.group_terms()) {
    AddGroup(term, layout, positions, &equations);
  }
  equations.hessian.triangularView<Eigen::StrictlyUpper>() = equations.hessian.transpose();
  return equations;
}

ArrowheadEquations LineariseArrowhead(const EstimationProblem& problem,
                                      const BlockLayout& layout) {
  ArrowheadEquations equations = EmptyEquations(layout, problem.planar());
  const auto add = [&](const std::vector<int>& columns,
                       const Eigen::MatrixXd& hessian,
                       const Eigen::VectorXd& gradient) {
    equations.hessian.AddBlock(columns, hessian);
    equations.diagonal(columns) += hessian.diagonal();
    equations.gradient(columns) += gradient;
  };
  equations.cost = VisitProducts(problem, layout, add);
  const BlockPositions positions = PositionsIn(problem, layout);
  const std::vector<GroupTerm>& groups = problem.group_terms();
  struct Item {
    const GroupTerm* term = nullptr;
    LinearisedGroup::Model model;
  };
  size_t next = 0;
  std::vector<int> rows;
  std::vector<int> columns;
  const auto take = [&](Item* item) {
    const LinearisedGroup::Model& model = item->model;
    equations.cost += model.cost;
    rows.clear();
    columns.clear();
    for (const RowRange& range : RowRangesOf(*item->term, layout, positions)) {
      for (int i = 0; i < range.size; ++i) {
        rows.push_back(range.row + i);
        columns.push_back(range.column + i);
      }
    }
    if (static_cast<Eigen::Index>(rows.size()) == model.gradient.size()) {
      add(columns, model.hessian, model.gradient);
    } else {
      add(columns, model.hessian(rows, rows), model.gradient(rows));
    }
  };
  RunOrderedPipeline<Item>(
      [&](Item* item) {
        if (next == groups.size()) return false;
        item->term = &groups[next++];
        return true;
      },
      [](Item* item) { item->model = item->term->group->ModelAt(item->term->blocks.data()); },
      take);
  return equations;
}

}  // namespace plumbline
