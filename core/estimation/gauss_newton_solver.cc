#include "core/estimation/gauss_newton_solver.h"

#include <glog/logging.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/estimation/arrowhead_cholesky.h"
#include "core/estimation/linearisation.h"
#include "core/util/error.h"

namespace plumbline {
namespace {

// The two shapes of normal equations: how they are made, and the step that they give, in all
// columns of the layout. A step may take the Hessian away.

struct Dense {
  static constexpr bool kStepKeepsHessian = true;
  static NormalEquations Linearise(const EstimationProblem& problem,
                                   const BlockLayout& layout) {
    return LineariseDense(problem, layout);
  }
  static Eigen::VectorXd Step(const BlockLayout& layout, NormalEquations* equations) {
    const std::vector<int> free = layout.FreeColumns();
    const Eigen::LLT<Eigen::MatrixXd> cholesky(
        Eigen::MatrixXd(equations->hessian(free, free)));
    if (cholesky.info() != Eigen::Success) {
      throw Error("the scans do not determine all poses and planes");
    }
    const Eigen::VectorXd gradient = equations->gradient(free);
    Eigen::VectorXd step = Eigen::VectorXd::Zero(layout.size());
    step(free) = -cholesky.solve(gradient);
    return step;
  }
};

struct Arrowhead {
  static constexpr bool kStepKeepsHessian = false;  // in a long recording it takes most memory
  static ArrowheadEquations Linearise(const EstimationProblem& problem,
                                      const BlockLayout& layout) {
    return LineariseArrowhead(problem, layout);
  }
  static Eigen::VectorXd Step(const BlockLayout&, ArrowheadEquations* equations) {
    return -ArrowheadCholesky(std::move(equations->hessian), BorderElimination::kNested)
                .Solve(equations->gradient);
  }
};

template <typename Equations>
struct ShapeOf;
template <>
struct ShapeOf<NormalEquations> {
  using Type = Dense;
};
template <>
struct ShapeOf<ArrowheadEquations> {
  using Type = Arrowhead;
};

// Moves the problem by a step, halved for as long as it would raise the cost, and gives the
// equations there. Returns what was taken of the step: 0, and all as it was, where a sixteenth
// of it would still raise the cost.
template <typename Equations>
double MoveDown(const BlockLayout& layout,
                Eigen::VectorXd step,
                EstimationProblem* problem,
                Equations* now) {
  using Shape = typename ShapeOf<Equations>::Type;
  constexpr double kRounding = 1e-12;  // of a cost
  const std::vector<int> free = layout.FreeColumns();
  const double cost = now->cost;
  const Unknowns::Values values = problem->unknowns().ValuesOf(layout);
  double share = 1.0;
  for (int halvings = 0; halvings <= kMaxShortenings; ++halvings) {
    problem->unknowns().Move(layout, step(free));
    *now = Shape::Linearise(*problem, layout);
    if (now->cost <= (1.0 + kRounding) * cost) return share;
    problem->unknowns().SetValues(layout, values);
    step *= 0.5;
    share *= 0.5;
  }
  *now = Shape::Linearise(*problem, layout);
  return 0.0;
}

}  // namespace

template <typename Equations>
Equations GaussNewtonSolver<Equations>::Solve(EstimationProblem* problem) const {
  using Shape = typename ShapeOf<Equations>::Type;
  const BlockLayout layout = problem->Layout();
  Equations now = Shape::Linearise(*problem, layout);
  for (int iteration = 0; iteration < options_.max_iterations; ++iteration) {
    const int num_linearisations = NumGroupLinearisations(*problem);
    const double cost = now.cost;
    const double limit = std::max(options_.cost_tolerance, options_.share_tolerance * cost);
    const Eigen::VectorXd step = Shape::Step(layout, &now);
    const double slope = step.dot(now.gradient);
    if (Shape::kStepKeepsHessian && -0.5 * slope <= limit) {  // too small to fail
      problem->unknowns().Move(layout, step(layout.FreeColumns()));
      break;
    }
    const double share = MoveDown(layout, step, problem, &now);
    if (share == 0.0) break;
    const double decrease = cost - now.cost;
    // What the cost differs from its quadratic model by is several times what another step
    // would find.
    const double expected = -share * (1.0 - 0.5 * share) * slope;
    VLOG(2) << "step " << iteration + 1 << ": cost " << now.cost << ", " << decrease
            << " less, " << std::abs(decrease - expected) << " off the model, "
            << NumGroupLinearisations(*problem) - num_linearisations
            << " groups linearised anew";
    const bool is_linear = !problem->group_terms().empty() &&
                           NumGroupLinearisations(*problem) == num_linearisations;
    if (decrease <= limit || is_linear ||
        (share == 1.0 && std::abs(decrease - expected) <= limit)) {
      break;
    }
  }
  return now;
}

void TakeGaussNewtonStep(EstimationProblem* problem) {
  // Of a control point, in rad or m: what such a rotation moves in second order over 10 m is
  // less than the noise of a range.
  constexpr double kSmallStep = 0.05;
  const BlockLayout layout = problem->Layout();
  ArrowheadEquations now = LineariseArrowhead(*problem, layout);
  const Eigen::VectorXd step = Arrowhead::Step(layout, &now);
  double largest = 0.0;
  for (size_t i = 0; i < layout.blocks.size() && IsOfTime(layout.blocks[i]); ++i) {
    if (!IsControlPoint(layout.blocks[i])) continue;
    const int size = layout.offsets[i + 1] - layout.offsets[i];
    largest =
        std::max(largest, step.segment(layout.offsets[i], size).lpNorm<Eigen::Infinity>());
  }
  if (largest > kSmallStep) {
    MoveDown(layout, step, problem, &now);
  } else {
    problem->unknowns().Move(layout, step(layout.FreeColumns()));
  }
}

template class GaussNewtonSolver<NormalEquations>;
template class GaussNewtonSolver<ArrowheadEquations>;

}  // namespace plumbline
