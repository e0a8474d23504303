#include "factors/cost/linear_prior_factor.h"

#include <ceres/cost_function.h>
#include <glog/logging.h>

#include <Eigen/Geometry>
#include <utility>

#include "factors/manifold/anchored_plane.h"
#include "factors/manifold/manifolds.h"
#include "factors/spline/so3.h"

namespace plumbline {
namespace {

using ConstQuaternion = Eigen::Map<const Eigen::Quaterniond>;
using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Returns the size of the parameter block of this kind.
int SizeOf(const LinearPrior::Block& block) {
  switch (block.kind) {
    case LinearPrior::Kind::kEuclidean:
      return block.size;  // any
    case LinearPrior::Kind::kVerticalPlane:
      return 2;
    case LinearPrior::Kind::kRotation:
    case LinearPrior::Kind::kYawRotation:
      break;
  }
  return 4;
}

// Tangent that takes the block from x0 to x.
Eigen::VectorXd Difference(const LinearPrior::Block& block, const double* x) {
  const double* x0 = block.x0.data();
  switch (block.kind) {
    case LinearPrior::Kind::kRotation:
      return Log(ConstQuaternion(x) * ConstQuaternion(x0).conjugate());
    case LinearPrior::Kind::kYawRotation:
      return Eigen::VectorXd::Constant(1, YawDifference(x, x0));
    case LinearPrior::Kind::kVerticalPlane:
      return AnchoredFromPlane(Eigen::Vector2d(x[0], x[1]), block.anchor) - block.x0;
    case LinearPrior::Kind::kEuclidean:
      break;
  }
  return Eigen::Map<const Eigen::VectorXd>(x, block.size) - block.x0;
}

// Its derivative with respect to x, tangent size x block size.
Eigen::MatrixXd DifferenceJacobian(const LinearPrior::Block& block, const double* x) {
  const double* x0 = block.x0.data();
  switch (block.kind) {
    case LinearPrior::Kind::kRotation:
      return LeftJacobianInverse(Log(ConstQuaternion(x) * ConstQuaternion(x0).conjugate())) *
             RotationMinusJacobian(x);
    case LinearPrior::Kind::kYawRotation:
      return RotationMinusJacobian(x).row(2);
    case LinearPrior::Kind::kVerticalPlane:
      return PlaneByAnchored(x[0], -block.anchor);
    case LinearPrior::Kind::kEuclidean:
      break;
  }
  return Eigen::MatrixXd::Identity(block.size, block.size);
}

class LinearPriorCost final : public ceres::CostFunction {
 public:
  explicit LinearPriorCost(LinearPrior prior) : prior_(std::move(prior)) {
    Eigen::Index tangent_size = 0;
    for (const LinearPrior::Block& block : prior_.blocks) {
      CHECK_EQ(block.x0.size(), block.size);
      CHECK_EQ(block.size, SizeOf(block));
      mutable_parameter_block_sizes()->push_back(block.size);
      tangent_size += block.tangent_size();
    }
    CHECK_EQ(prior_.root.cols(), tangent_size);
    CHECK_EQ(prior_.root.rows(), prior_.offset.size());
    set_num_residuals(static_cast<int>(prior_.offset.size()));
  }

  bool Evaluate(double const* const* parameters,
                double* residuals,
                double** jacobians) const override {
    Eigen::Map<Eigen::VectorXd> r(residuals, num_residuals());
    r = prior_.offset;
    Eigen::Index column = 0;
    for (size_t i = 0; i < prior_.blocks.size(); ++i) {
      const LinearPrior::Block& block = prior_.blocks[i];
      const auto root = prior_.root.middleCols(column, block.tangent_size());
      r.noalias() += root * Difference(block, parameters[i]);
      if (jacobians != nullptr && jacobians[i] != nullptr) {
        Eigen::Map<RowMajorMatrix>{jacobians[i], num_residuals(), block.size} =
            root * DifferenceJacobian(block, parameters[i]);
      }
      column += block.tangent_size();
    }
    return true;
  }

 private:
  LinearPrior prior_;
};

}  // namespace

std::unique_ptr<ceres::CostFunction> CreateLinearPriorFactor(LinearPrior prior) {
  return std::make_unique<LinearPriorCost>(std::move(prior));
}

}  // namespace plumbline
