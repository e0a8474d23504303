#include "core/estimation/motion_noise_estimation.h"

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/estimation/arrowhead_cholesky.h"
#include "core/estimation/block_layout.h"
#include "core/estimation/estimation_problem.h"
#include "core/estimation/linearisation.h"
#include "core/trajectory/motion_noise.h"

namespace plumbline {
namespace {

// Random combinations of all accelerations.
constexpr int kNumProbes = 8;

// Calls visit(knot, whether of rotations, columns, dense Jacobian, residuals) for the motion
// priors, whose residuals are accelerations over their standard deviations.
using PriorVisitor = std::function<void(
    size_t, bool, const std::vector<int>&, const Eigen::MatrixXd&, const Eigen::VectorXd&)>;
void ForEachPrior(const EstimationProblem& problem, const PriorVisitor& visit) {
  const BlockLayout layout = problem.Layout();
  for (const bool of_rotations : {true, false}) {
    size_t knot = 0;  // the priors are in the order of the knots
    VisitFactors(problem,
                 layout,
                 of_rotations ? FactorTerm::Kind::kRotationAcceleration
                              : FactorTerm::Kind::kPositionAcceleration,
                 [&](const std::vector<int>& columns,
                     const Eigen::MatrixXd& jacobian,
                     const Eigen::VectorXd& residuals) {
                   visit(knot++, of_rotations, columns, jacobian, residuals);
                 });
  }
}

// Signs that the same seed repeats.
class RandomSigns {
 public:
  Eigen::Matrix<double, 3, kNumProbes> Next() {
    Eigen::Matrix<double, 3, kNumProbes> signs;
    for (double& sign : signs.reshaped()) {
      state_ = state_ * 6364136223846793005u + 1442695040888963407u;
      sign = (state_ >> 63) != 0 ? 1.0 : -1.0;
    }
    return signs;
  }

 private:
  uint64_t state_ = 1;
};

}  // namespace

std::vector<MotionEvidence> FindMotionEvidence(const MotionProfile& assumed,
                                               const EstimationProblem& problem,
                                               const ArrowheadCholesky& factor) {
  Eigen::MatrixXd probes = Eigen::MatrixXd::Zero(factor.size(), kNumProbes);
  RandomSigns signs;
  ForEachPrior(problem,
               [&](size_t,
                   bool,
                   const std::vector<int>& columns,
                   const Eigen::MatrixXd& jacobian,
                   const Eigen::VectorXd&) {
                 probes(columns, Eigen::all) += jacobian.transpose() * signs.Next();
               });
  const Eigen::MatrixXd solved = factor.Solve(probes);
  std::vector<MotionEvidence> evidence(assumed.at.size());
  signs = RandomSigns();
  ForEachPrior(problem,
               [&](size_t knot,
                   bool of_rotations,
                   const std::vector<int>& columns,
                   const Eigen::MatrixXd& jacobian,
                   const Eigen::VectorXd& residuals) {
                 // G z of the random combinations z.
                 const Eigen::Matrix<double, 3, kNumProbes> combined = signs.Next();
                 const Eigen::Matrix<double, 3, kNumProbes> shown =
                     combined - jacobian * solved(columns, Eigen::all);
                 const Eigen::Vector3d g = combined.cwiseProduct(shown).rowwise().mean();
                 const Eigen::Vector3d g2 = shown.rowwise().squaredNorm() / kNumProbes;
                 constexpr MotionKind kKinds[2][3] = {{kHorizontal, kHorizontal, kVertical},
                                                      {kTilt, kTilt, kYaw}};
                 for (int row = 0; row < 3; ++row) {
                   if (jacobian.row(row).isZero()) continue;  // held, in planar motion
                   const MotionKind kind = kKinds[of_rotations ? 1 : 0][row];
                   const double density = assumed.at[knot].density[kind];
                   evidence[knot].squares[kind] +=
                       (residuals[row] * residuals[row] - g[row] + g2[row]) * density *
                       density;
                   evidence[knot].weight[kind] += g2[row];
                   evidence[knot].by_prior += 1.0 - g[row];
                   evidence[knot].prior_cost += 0.5 * residuals[row] * residuals[row];
                 }
               });
  return evidence;
}

}  // namespace plumbline
