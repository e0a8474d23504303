#include "factors/segment/linearised_group.h"

#include <ceres/cost_function.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "factors/linear_algebra/square_root_marginalisation.h"
#include "factors/manifold/manifolds.h"
#include "factors/spline/so3.h"

namespace plumbline {
namespace {

// A direction of which less than this share of its variables' information is left belongs to
// rounding.
constexpr double kRankTolerance = 1e-13;

using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

}  // namespace

LinearisedGroup::LinearisedGroup(SegmentGroup group) : group_(std::move(group)) {}

int LinearisedGroup::BlockSize(int block) const {
  const int num_control_points = group_.num_control_points();
  if (block < num_control_points) return 4;
  if (block < 2 * num_control_points) return 3;
  return PlaneModelSize(
      group_.planes()[static_cast<size_t>(block - 2 * num_control_points)].model);
}

int LinearisedGroup::FirstRow(int block) const {
  const int num_control_points = group_.num_control_points();
  if (block < num_control_points) return 6 * block;
  if (block < 2 * num_control_points) return 6 * (block - num_control_points) + 3;
  return group_.plane_offsets()[static_cast<size_t>(block - 2 * num_control_points)];
}

bool LinearisedGroup::Move(double const* const* parameters, Eigen::VectorXd* step) const {
  if (at_.empty()) return false;
  using Quaternion = Eigen::Map<const Eigen::Quaterniond>;
  step->resize(group_.size());
  const int num_control_points = group_.num_control_points();
  const int num_blocks = 2 * num_control_points + static_cast<int>(group_.planes().size());
  const double* at = at_.data();
  for (int i = 0; i < num_blocks; ++i) {
    const int size = BlockSize(i);
    const int row = FirstRow(i);
    if (i < num_control_points) {
      const Eigen::Vector3d turn = Log(Quaternion(parameters[i]) * Quaternion(at).conjugate());
      if (turn.squaredNorm() > validity_.turn_rad * validity_.turn_rad) return false;
      step->segment<3>(row) = turn;
    } else {
      for (int k = 0; k < size; ++k) (*step)[row + k] = parameters[i][k] - at[k];
      // A plane's distance may move freely: the residuals are linear in it.
      const bool is_position = i < 2 * num_control_points;
      const double limit = is_position ? validity_.shift_m : validity_.turn_rad;
      const int num_limited = is_position ? size : size - 1;
      for (int k = 0; k < num_limited; ++k) {
        if (std::abs((*step)[row + k]) > limit) return false;
      }
    }
    at += size;
  }
  return true;
}

SegmentGroup::Quadratic LinearisedGroup::Linearise(double const* const* parameters) {
  at_.clear();
  const int num_blocks =
      2 * group_.num_control_points() + static_cast<int>(group_.planes().size());
  for (int i = 0; i < num_blocks; ++i) {
    at_.insert(at_.end(), parameters[i], parameters[i] + BlockSize(i));
  }
  ++num_linearisations_;
  SegmentGroup::Quadratic quadratic;
  group_.Linearise(parameters, &quadratic);
  has_outliers_ = quadratic.has_outliers;
  packed_hessian_ = std::vector<double>();
  packed_root_ = std::vector<double>();
  return quadratic;
}

void LinearisedGroup::KeepModel(const SegmentGroup::Quadratic& quadratic) {
  cost_ = quadratic.cost;
  gradient_ = quadratic.gradient;
  const Eigen::MatrixXd& hessian = quadratic.hessian;
  const Eigen::Index size = hessian.rows();
  packed_hessian_.reserve(static_cast<size_t>(size * (size + 1) / 2));
  for (Eigen::Index j = 0; j < size; ++j) {
    const double* const column = hessian.col(j).data();
    packed_hessian_.insert(packed_hessian_.end(), column + j, column + size);
  }
}

Eigen::MatrixXd LinearisedGroup::Hessian() const {
  const Eigen::Index size = gradient_.size();
  Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(size, size);
  const double* next = packed_hessian_.data();
  for (Eigen::Index j = 0; j < size; ++j) {
    std::copy(next, next + size - j, hessian.col(j).data() + j);
    next += size - j;
  }
  return hessian;
}

// H = root^T root and g = root^T offset.
void LinearisedGroup::KeepRoot(const SegmentGroup::Quadratic& quadratic) {
  MarginalisedSystem system =
      Marginalise(quadratic.hessian, quadratic.gradient, 0, kRankTolerance);
  rest_ = std::sqrt(std::max(0.0, 2.0 * quadratic.cost - system.offset.squaredNorm()));
  order_ = std::move(system.order);
  packed_root_.reserve(order_.size() * (order_.size() + 1) / 2);
  for (Eigen::Index row = 0; row < system.root.rows(); ++row) {
    for (size_t i = static_cast<size_t>(row); i < order_.size(); ++i) {
      packed_root_.push_back(system.root(row, order_[i]));
    }
  }
  offset_ = std::move(system.offset);
}

LinearisedGroup::Model LinearisedGroup::ModelAt(double const* const* parameters) {
  Eigen::VectorXd step;
  if (packed_hessian_.empty() || !Move(parameters, &step)) {
    SegmentGroup::Quadratic quadratic = Linearise(parameters);
    KeepModel(quadratic);
    return {quadratic.cost, std::move(quadratic.gradient), std::move(quadratic.hessian)};
  }
  Eigen::MatrixXd hessian = Hessian();
  const Eigen::VectorXd change = hessian.selfadjointView<Eigen::Lower>() * step;
  return {cost_ + step.dot(gradient_ + 0.5 * change), gradient_ + change, std::move(hessian)};
}

Eigen::MatrixXd LinearisedGroup::Root() const {
  Eigen::MatrixXd root =
      Eigen::MatrixXd::Zero(offset_.size(), static_cast<Eigen::Index>(order_.size()));
  auto next = packed_root_.begin();
  for (Eigen::Index row = 0; row < root.rows(); ++row) {
    for (size_t i = static_cast<size_t>(row); i < order_.size(); ++i) {
      root(row, order_[i]) = *next++;
    }
  }
  return root;
}

void LinearisedGroup::Evaluate(double const* const* parameters,
                               double* residuals,
                               double** jacobians) {
  Eigen::VectorXd step;
  const bool is_near = !packed_root_.empty() && Move(parameters, &step);
  if (!is_near) KeepRoot(Linearise(parameters));
  const int num_residuals = group_.size() + 1;
  const Eigen::Index rank = offset_.size();
  Eigen::MatrixXd root;
  if (is_near || jacobians != nullptr) root = Root();
  Eigen::Map<Eigen::VectorXd> all(residuals, num_residuals);
  all.setZero();
  all.head(rank) = offset_;
  if (is_near) all.head(rank).noalias() += root * step;
  all[num_residuals - 1] = rest_;
  if (jacobians == nullptr) return;
  const int num_control_points = group_.num_control_points();
  const int num_blocks = 2 * num_control_points + static_cast<int>(group_.planes().size());
  for (int i = 0; i < num_blocks; ++i) {
    if (jacobians[i] == nullptr) continue;
    const int size = BlockSize(i);
    const int column = FirstRow(i);
    Eigen::Map<RowMajorMatrix> jacobian(jacobians[i], num_residuals, size);
    jacobian.bottomRows(num_residuals - rank).setZero();
    if (i < num_control_points) {
      jacobian.topRows(rank) =
          root.middleCols<3>(column).lazyProduct(RotationMinusJacobian(parameters[i]));
    } else {
      jacobian.topRows(rank) = root.middleCols(column, size);
    }
  }
}

namespace {

class SegmentGroupCost final : public ceres::CostFunction {
 public:
  explicit SegmentGroupCost(std::shared_ptr<LinearisedGroup> group)
      : group_(std::move(group)) {
    const SegmentGroup& segments = group_->group();
    std::vector<int>* sizes = mutable_parameter_block_sizes();
    sizes->insert(sizes->end(), static_cast<size_t>(segments.num_control_points()), 4);
    sizes->insert(sizes->end(), static_cast<size_t>(segments.num_control_points()), 3);
    for (const SegmentGroup::Plane& plane : segments.planes()) {
      sizes->push_back(PlaneModelSize(plane.model));
    }
    set_num_residuals(segments.size() + 1);
  }

  bool Evaluate(double const* const* parameters,
                double* residuals,
                double** jacobians) const override {
    group_->Evaluate(parameters, residuals, jacobians);
    return true;
  }

 private:
  std::shared_ptr<LinearisedGroup> group_;
};

}  // namespace

std::unique_ptr<ceres::CostFunction> CreateSegmentGroupFactor(
    std::shared_ptr<LinearisedGroup> group) {
  return std::make_unique<SegmentGroupCost>(std::move(group));
}

}  // namespace plumbline
