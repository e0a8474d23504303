#include "factors/segment/linearised_group.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "factors/spline/so3.h"

namespace plumbline {

LinearisedGroup::LinearisedGroup(SegmentGroup group, bool planes_held)
    : group_(std::move(group)), planes_held_(planes_held) {}

int LinearisedGroup::NumBlocks() const {
  const int num_control_points = group_.num_control_points();
  if (planes_held_) return 2 * num_control_points;
  return 2 * num_control_points + static_cast<int>(group_.planes().size()) +
         group_.num_estimated_scanners();
}

int LinearisedGroup::BlockSize(int block) const {
  const int num_control_points = group_.num_control_points();
  if (block < num_control_points) return 4;
  if (block < 2 * num_control_points) return 3;
  const auto plane = static_cast<size_t>(block - 2 * num_control_points);
  if (plane >= group_.planes().size()) {
    return group_.ScannerSize(static_cast<int>(plane - group_.planes().size()));
  }
  return PlaneModelSize(group_.planes()[plane].model);
}

int LinearisedGroup::FirstRow(int block) const {
  const int num_control_points = group_.num_control_points();
  if (block < num_control_points) return 6 * block;
  if (block < 2 * num_control_points) return 6 * (block - num_control_points) + 3;
  const int plane = block - 2 * num_control_points;
  const auto num_planes = static_cast<int>(group_.planes().size());
  if (plane >= num_planes) return group_.ScannerOffset(plane - num_planes);
  return group_.plane_offsets()[static_cast<size_t>(plane)];
}

bool LinearisedGroup::Move(double const* const* parameters, Eigen::VectorXd* step) const {
  if (at_.empty()) return false;
  using Quaternion = Eigen::Map<const Eigen::Quaterniond>;
  step->resize(gradient_.size());
  const int num_control_points = group_.num_control_points();
  const int num_blocks = NumBlocks();
  const auto num_planes = static_cast<int>(group_.planes().size());
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
      const bool is_plane = !is_position && i < 2 * num_control_points + num_planes;
      for (int k = 0; k < (is_plane ? size - 1 : size); ++k) {
        const bool is_shift =
            is_position ||
            (!is_plane &&
             ((k >= kScannerShiftAt && k < kMountZeroAt && k != kScannerDelayAt) ||
              k >= kMountShiftAt));
        double limit = is_shift ? validity_.shift_m : validity_.turn_rad;
        if (!is_position && !is_plane && (k == kMountDelayAt || k == kMountRateAt)) {
          limit /=
              group_.MountReach(i - 2 * num_control_points - num_planes)[k - kMountDelayAt];
        }
        if (std::abs((*step)[row + k]) > limit) return false;
      }
    }
    at += size;
  }
  return true;
}

SegmentGroup::Quadratic LinearisedGroup::Linearise(double const* const* parameters) {
  at_.clear();
  const int num_blocks = NumBlocks();
  for (int i = 0; i < num_blocks; ++i) {
    at_.insert(at_.end(), parameters[i], parameters[i] + BlockSize(i));
  }
  ++num_linearisations_;
  SegmentGroup::Quadratic quadratic;
  if (planes_held_) {
    group_.LinearisePoses(parameters, &quadratic);
  } else {
    group_.Linearise(parameters, &quadratic);
  }
  has_outliers_ = quadratic.has_outliers;
  packed_hessian_ = std::vector<double>();
  return quadratic;
}

void LinearisedGroup::Keep(const SegmentGroup::Quadratic& quadratic) {
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

LinearisedGroup::Model LinearisedGroup::ModelAt(double const* const* parameters) {
  Eigen::VectorXd step;
  if (packed_hessian_.empty() || !Move(parameters, &step)) {
    SegmentGroup::Quadratic quadratic = Linearise(parameters);
    Keep(quadratic);
    return {quadratic.cost, std::move(quadratic.gradient), std::move(quadratic.hessian)};
  }
  Eigen::MatrixXd hessian = Hessian();
  const Eigen::VectorXd change = hessian.selfadjointView<Eigen::Lower>() * step;
  return {cost_ + step.dot(gradient_ + 0.5 * change), gradient_ + change, std::move(hessian)};
}

}  // namespace plumbline
