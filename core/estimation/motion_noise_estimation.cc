
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/estimation/arrowhead_cholesky.h"
#include "core/estimation/arrowhead_equations.h"
#include "core/estimation/block_layout.h"
#include "core/estimation/estimation_problem.h"
#include "core/estimation/linearisation.h"
#include "core/trajectory/motion_noise.h"

namespace plumbline {
namespace {

// Accelerations that the scans have to determine: a standard deviation from so many is right
// to a fifth.
constexpr double kMinDetermined = 12.0;
// Random combinations of the accelerations of one kind. With as many as these, the sum of n
// relative variances is known to sqrt(n / 2) at worst.
constexpr int kNumProbes = 4;

enum Kind { kHorizontal, kVertical, kAngular, kNumKinds };

std::array<double, kNumKinds> StddevsOf(const MotionNoise& noise) {
  return {noise.horizontal_m_s2, noise.vertical_m_s2, noise.angular_rad_s2};
}

// Calls visit(kinds by row, columns, dense Jacobian, residuals) for the motion priors, whose
// residuals are accelerations over their standard deviations.
using PriorVisitor = std::function<void(const std::array<Kind, 3>&,
                                        const std::vector<int>&,
                                        const Eigen::MatrixXd&,
                                        const Eigen::VectorXd&)>;
void ForEachPrior(const EstimationProblem& problem, const PriorVisitor& visit) {
  const BlockLayout layout = problem.Layout();
  for (const bool of_rotations : {true, false}) {
    const auto kinds = of_rotations ? std::array<Kind, 3>{kAngular, kAngular, kAngular}
                                    : std::array<Kind, 3>{kHorizontal, kHorizontal, kVertical};
    VisitFactors(
        problem,
        layout,
        of_rotations ? FactorTerm::Kind::kRotationAcceleration
                     : FactorTerm::Kind::kPositionAcceleration,
        [&](const std::vector<int>& columns,
            const Eigen::MatrixXd& jacobian,
            const Eigen::VectorXd& residuals) { visit(kinds, columns, jacobian, residuals); });
  }
}

}  // namespace

MotionNoise ReestimateMotionNoise(const MotionNoise& assumed,
                                  const EstimationProblem& problem,
                                  const ArrowheadCholesky& factor) {
  std::array<double, kNumKinds> sum_squares = {};
  std::array<int, kNumKinds> count = {};
  Eigen::MatrixXd probes = Eigen::MatrixXd::Zero(factor.size(), kNumKinds * kNumProbes);
  uint64_t state = 1;
  const auto random_sign = [&state] {
    state = state * 6364136223846793005u + 1442695040888963407u;
    return (state >> 63) != 0 ? 1.0 : -1.0;
  };
  ForEachPrior(problem,
               [&](const std::array<Kind, 3>& kinds,
                   const std::vector<int>& columns,
                   const Eigen::MatrixXd& jacobian,
                   const Eigen::VectorXd& residuals) {
                 for (int row = 0; row < 3; ++row) {
                   if (jacobian.row(row).isZero()) continue;  // held, in planar motion
                   const Kind kind = kinds[static_cast<size_t>(row)];
                   sum_squares[kind] += residuals[row] * residuals[row];
                   ++count[kind];
                   for (int k = 0; k < kNumProbes; ++k) {
                     probes(columns, kind * kNumProbes + k) +=
                         random_sign() * jacobian.row(row).transpose();
                   }
                 }
               });
  const Eigen::VectorXd sums =
      probes.cwiseProduct(factor.Solve(probes)).colwise().sum().transpose();
  std::array<double, kNumKinds> found = StddevsOf(assumed);
  for (size_t kind = 0; kind < kNumKinds; ++kind) {
    const double determined =
        count[kind] -
        sums.segment<kNumProbes>(static_cast<Eigen::Index>(kind) * kNumProbes).mean();
    if (determined < kMinDetermined) continue;
    found[kind] *= std::sqrt(sum_squares[kind] / determined);
  }
  return {found[kHorizontal], found[kVertical], found[kAngular]};
}

void CorrectForMotion(const MotionNoise& assumed,
                      const MotionNoise& found,
                      const EstimationProblem& problem,
                      ArrowheadEquations* equations) {
  std::array<double, kNumKinds> weights;
  for (size_t kind = 0; kind < kNumKinds; ++kind) {
    const double rho = std::pow(StddevsOf(found)[kind] / StddevsOf(assumed)[kind], 2);
    weights[kind] = rho < 1.0 ? 1.0 - rho : 1.0 / rho - 1.0;
  }
  ForEachPrior(
      problem,
      [&](const std::array<Kind, 3>& kinds,
          const std::vector<int>& columns,
          const Eigen::MatrixXd& jacobian,
          const Eigen::VectorXd&) {
        const Eigen::Vector3d by_row(weights[kinds[0]], weights[kinds[1]], weights[kinds[2]]);
        const Eigen::MatrixXd product = jacobian.transpose() * by_row.asDiagonal() * jacobian;
        equations->hessian.AddBlock(columns, product);
        equations->diagonal(columns) += product.diagonal();
      });
}

}  // namespace plumbline
