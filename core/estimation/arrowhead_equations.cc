#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/estimation/aitken_extrapolation.h"
#include "core/estimation/arrowhead_cholesky.h"
#include "core/estimation/block_layout.h"
#include "core/estimation/estimation_problem.h"
#include "core/util/ordered_pipeline.h"

namespace plumbline {
namespace {

// A residual's control points lie in two adjacent tiles of so many: a group of the batch has
// nine at most and begins at every fourth.
constexpr int kTileControlPoints = 8;

// Nothing but the unit diagonal of what is held.
ArrowheadEquations EmptyEquations(const BlockLayout& layout, bool planar) {
  const int num_band = layout.NumControlPointColumns();
  ArrowheadEquations equations{
      ArrowheadMatrix(
          num_band, kTileControlPoints * (planar ? 4 : 6), layout.size() - num_band),
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

ArrowheadEquations EstimationProblem::LineariseArrowhead(const BlockLayout& layout) const {
  ArrowheadEquations equations = EmptyEquations(layout, planar_);
  const auto add = [&](const std::vector<int>& columns,
                       const Eigen::MatrixXd& hessian,
                       const Eigen::VectorXd& gradient) {
    equations.hessian.AddBlock(columns, hessian);
    equations.diagonal(columns) += hessian.diagonal();
    equations.gradient(columns) += gradient;
  };
  equations.cost = VisitProducts(layout, add);
  const BlockPositions positions = PositionsIn(layout);
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
        if (next == groups_.size()) return false;
        item->term = &groups_[next++];
        return true;
      },
      [](Item* item) { item->model = item->term->group->ModelAt(item->term->blocks.data()); },
      take);
  return equations;
}

bool EstimationProblem::MoveDown(const BlockLayout& layout,
                                 Eigen::VectorXd step,
                                 ArrowheadEquations* now,
                                 double* share) {
  constexpr int kMaxHalvings = 4;
  constexpr double kRounding = 1e-12;  // of a cost
  const std::vector<int> free = layout.FreeColumns();
  const double cost = now->cost;
  const Values values = ValuesOf(layout);
  for (int halvings = 0; halvings <= kMaxHalvings; ++halvings) {
    Move(layout, step(free));
    *now = LineariseArrowhead(layout);
    if (now->cost <= (1.0 + kRounding) * cost) return true;
    SetValues(layout, values);
    step *= 0.5;
    *share *= 0.5;
  }
  *now = LineariseArrowhead(layout);
  return false;
}

EstimationProblem::Solution EstimationProblem::SolveArrowhead(int max_iterations,
                                                              const Tolerance& tolerance,
                                                              const CholeskyVisitor& visit) {
  const BlockLayout layout = Layout();
  ArrowheadEquations now = LineariseArrowhead(layout);
  Eigen::VectorXd last_step;
  double lengthening = 1.0;
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    const int num_linearisations = NumLinearisations();
    const double cost = now.cost;
    Eigen::VectorXd step;
    {
      const ArrowheadCholesky factor(std::move(now.hessian));
      visit(factor);
      step = -factor.Solve(now.gradient);
    }
    const double slope = step.dot(now.gradient);
    lengthening =
        iteration == 0 ? 1.0 : AitkenRelaxation(step, last_step, lengthening, now.diagonal);
    last_step = step;
    if (!MoveDown(layout, lengthening * step, &now, &lengthening)) break;
    const double decrease = cost - now.cost;
    // Of the quadratic model. What the cost differs from it by is several times what another
    // step would find.
    const double expected = -lengthening * (1.0 - 0.5 * lengthening) * slope;
    const double limit = std::max(tolerance.cost, tolerance.share * cost);
    VLOG(1) << "step " << iteration + 1 << ": cost " << now.cost << ", " << decrease
            << " less, " << std::abs(decrease - expected) << " off the model, "
            << NumLinearisations() - num_linearisations << " groups linearised anew";
    const bool is_halved = lengthening < 1.0;
    if (decrease <= limit || (!is_halved && std::abs(decrease - expected) <= limit) ||
        NumLinearisations() == num_linearisations) {
      break;  // or the problem was linear
    }
  }
  return {std::move(now), static_cast<int>(layout.FreeColumns().size())};
}

void EstimationProblem::TakeArrowheadStep() {
  // Of a control point, in rad or m: what such a rotation moves in second order over 10 m is
  // less than the noise of a range.
  constexpr double kSmallStep = 0.05;
  const BlockLayout layout = Layout();
  ArrowheadEquations now = LineariseArrowhead(layout);
  const Eigen::VectorXd step = -ArrowheadCholesky(std::move(now.hessian)).Solve(now.gradient);
  const auto of_poses = step.head(layout.NumControlPointColumns());
  if (of_poses.size() > 0 && of_poses.lpNorm<Eigen::Infinity>() > kSmallStep) {
    double share = 1.0;
    MoveDown(layout, step, &now, &share);
  } else {
    Move(layout, step(layout.FreeColumns()));
  }
}

}  // namespace plumbline
