#include "factors/cost/group_factor.h"

#include <ceres/cost_function.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <utility>

#include "factors/manifold/manifolds.h"

namespace plumbline {
namespace {

// R with R^T R = H, of as many rows, and R^-T g. Directions that the segments do not determine
// have rows of zeros.
struct SquareRoot {
  SquareRoot(const Eigen::MatrixXd& hessian, const Eigen::VectorXd& gradient)
      : root(hessian.rows(), hessian.cols()), scores(gradient.size()) {
    const Eigen::LDLT<Eigen::MatrixXd> ldlt(hessian);  // P^T L D L^T P
    const Eigen::VectorXd& diagonal = ldlt.vectorD();
    const double least = diagonal.maxCoeff() * static_cast<double>(hessian.rows()) *
                         Eigen::NumTraits<double>::epsilon();
    const Eigen::VectorXd scale =
        (diagonal.array() > least).select(diagonal.cwiseMax(0.0).cwiseSqrt(), 0.0);
    Eigen::MatrixXd transposed = ldlt.matrixL();
    transposed = transposed * scale.asDiagonal();
    transposed = ldlt.transpositionsP().transpose() * transposed;
    root = transposed.transpose();
    scores = ldlt.matrixL().solve(ldlt.transpositionsP() * gradient);
    scores = (scale.array() > 0.0).select(scores.cwiseQuotient(scale), 0.0);
  }

  Eigen::MatrixXd root;
  Eigen::VectorXd scores;
};

class GroupFactor final : public ceres::CostFunction {
 public:
  explicit GroupFactor(std::shared_ptr<LinearisedGroup> group) : group_(std::move(group)) {
    const int num_blocks = 2 * group_->group().num_control_points() +
                           static_cast<int>(group_->group().planes().size()) +
                           group_->group().num_estimated_scanners();
    for (int block = 0; block < num_blocks; ++block) {
      mutable_parameter_block_sizes()->push_back(group_->BlockSize(block));
    }
    set_num_residuals(group_->NumRows() + 1);
  }

  bool Evaluate(double const* const* parameters,
                double* residuals,
                double** jacobians) const override {
    const LinearisedGroup::Model model = group_->ModelAt(parameters);
    Eigen::Map<Eigen::VectorXd> r(residuals, num_residuals());
    r.setZero();
    double& rest = r[num_residuals() - 1];
    if (jacobians == nullptr) {
      rest = std::sqrt(2.0 * model.cost);
      return true;
    }
    const SquareRoot square_root(model.hessian, model.gradient);
    r.head(square_root.scores.size()) = square_root.scores;
    rest = std::sqrt(std::max(0.0, 2.0 * model.cost - square_root.scores.squaredNorm()));
    for (int block = 0; block < group_->NumBlocks(); ++block) {
      if (jacobians[block] != nullptr) {
        WriteJacobian(block, square_root.root, parameters[block], jacobians[block]);
      }
    }
    return true;
  }

 private:
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  void WriteJacobian(int block,
                     const Eigen::MatrixXd& root,
                     const double* parameters,
                     double* jacobian) const {
    const int size = group_->BlockSize(block);
    const int row = group_->FirstRow(block);
    Eigen::Map<RowMajor> by_block(jacobian, num_residuals(), size);
    by_block.bottomRows<1>().setZero();
    auto top = by_block.topRows(root.rows());
    if (group_->IsRotation(block)) {
      top.noalias() = root.middleCols<3>(row) * RotationMinusJacobian(parameters);
    } else {
      top = root.middleCols(row, size);
    }
  }

  std::shared_ptr<LinearisedGroup> group_;
};

}  // namespace

std::unique_ptr<ceres::CostFunction> CreateGroupFactor(
    std::shared_ptr<LinearisedGroup> group) {
  return std::make_unique<GroupFactor>(std::move(group));
}

}  // namespace plumbline
