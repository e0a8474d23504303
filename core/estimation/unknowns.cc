#include "core/estimation/unknowns.h"

#include <ceres/manifold.h>
#include <glog/logging.h>

#include <algorithm>
#include <functional>

#include "factors/manifold/manifolds.h"

namespace plumbline {

Unknowns::Unknowns(bool planar,
                   Trajectory* trajectory,
                   std::deque<Landmark>* landmarks,
                   RigCalibration* calibration)
    : planar_(planar),
      trajectory_(trajectory),
      landmarks_(landmarks),
      calibration_(calibration),
      rotation_manifold_(planar ? CreateYawManifold() : CreateRotationManifold()),
      planar_position_manifold_(
          std::make_unique<ceres::SubsetManifold>(3, std::vector<int>{2})),
      fixed_heading_manifold_(
          std::make_unique<ceres::SubsetManifold>(2, std::vector<int>{0})) {}

Unknowns::Unknowns(Unknowns&&) = default;
Unknowns::~Unknowns() = default;

double* Unknowns::Data(const BlockId& block) const {
  switch (block.kind) {
    case BlockId::Kind::kRotation:
      return trajectory_->control_point(block.index).rotation.data();
    case BlockId::Kind::kPosition:
      return trajectory_->control_point(block.index).position.data();
    case BlockId::Kind::kLandmark:
      return (*landmarks_)[static_cast<size_t>(block.index)].parameters.data();
    case BlockId::Kind::kScanner:
      return Estimate(block).block.data();
    case BlockId::Kind::kImu:
      return calibration_->imu->block.data();
    case BlockId::Kind::kGyroscopeBias:
      return Biases(block).gyroscope.data();
    case BlockId::Kind::kAccelerometerBias:
      return Biases(block).accelerometer.data();
  }
  LOG(FATAL) << "unknown block";
  return nullptr;
}

int Unknowns::AmbientSize(const BlockId& block) const {
  switch (block.kind) {
    case BlockId::Kind::kRotation:
      return 4;
    case BlockId::Kind::kPosition:
      return 3;
    case BlockId::Kind::kLandmark:
      return (*landmarks_)[static_cast<size_t>(block.index)].num_parameters();
    case BlockId::Kind::kScanner:
      return Estimate(block).BlockSize();
    case BlockId::Kind::kImu:
      return kImuBlockSize;
    case BlockId::Kind::kGyroscopeBias:
    case BlockId::Kind::kAccelerometerBias:
      return kImuBiasSize;
  }
  LOG(FATAL) << "unknown block";
  return 0;
}

LinearPrior::Kind Unknowns::KindOf(const BlockId& block) const {
  if (block.kind != BlockId::Kind::kRotation && !IsLandmark(block)) {
    return LinearPrior::Kind::kEuclidean;
  }
  if (block.kind == BlockId::Kind::kLandmark) {
    const Landmark& landmark = (*landmarks_)[static_cast<size_t>(block.index)];
    return TraitsOf(landmark).has_heading ? LinearPrior::Kind::kVerticalPlane
                                          : LinearPrior::Kind::kEuclidean;
  }
  return planar_ ? LinearPrior::Kind::kYawRotation : LinearPrior::Kind::kRotation;
}

int Unknowns::TangentSize(const BlockId& block) const {
  if (block.kind == BlockId::Kind::kRotation) return planar_ ? 1 : 3;
  return AmbientSize(block);
}

const ceres::Manifold* Unknowns::ManifoldOf(const BlockId& block) const {
  return blocks_.at(block);
}

void Unknowns::Register(const BlockId& block) {
  if (IsHeld(block) || blocks_.count(block) > 0) return;
  blocks_.emplace(block, MakeManifold(block));
}

const double* Unknowns::PriorSigmas(const BlockId& block) const {
  if (IsScanner(block)) return Estimate(block).prior_sigma.data();
  return IsImu(block) ? calibration_->imu->prior_sigma.data() : nullptr;
}

const ceres::Manifold* Unknowns::MakeManifold(const BlockId& block) {
  if (block.kind == BlockId::Kind::kRotation) return rotation_manifold_.get();
  if (block.kind == BlockId::Kind::kPosition) {
    return planar_ ? planar_position_manifold_.get() : nullptr;
  }
  if (IsBias(block)) return nullptr;
  if (!IsLandmark(block)) {
    const double* const sigmas = PriorSigmas(block);
    const int size = AmbientSize(block);
    std::vector<int> held;
    for (int i = 0; sigmas != nullptr && i < size; ++i) {
      if (sigmas[i] == 0.0) held.push_back(i);
    }
    if (held.empty()) return nullptr;
    own_manifolds_.push_back(std::make_unique<ceres::SubsetManifold>(size, held));
    return own_manifolds_.back().get();
  }
  const Landmark& landmark = (*landmarks_)[static_cast<size_t>(block.index)];
  if (KindOf(block) != LinearPrior::Kind::kVerticalPlane) return nullptr;
  if (landmark.heading_fixed) return fixed_heading_manifold_.get();
  const PatchExtent& extent = landmark.extent;
  const Eigen::Vector3d centre = extent.empty() ? extent.axes().anchor : extent.Centre();
  own_manifolds_.push_back(CreateVerticalPlaneManifold(centre.head<2>()));
  return own_manifolds_.back().get();
}

BlockLayout Unknowns::Layout() const {
  BlockLayout layout;
  layout.offsets.assign(1, 0);
  for (const auto& [block, manifold] : blocks_) {
    const int size = TangentSize(block);
    const int free_size = manifold == nullptr ? size : manifold->TangentSize();
    // A landmark that is held in part is held in its heading, a position in its height.
    const bool heading_held = IsLandmark(block) && free_size < size;
    const double* const sigmas = PriorSigmas(block);
    for (int i = 0; i < size; ++i) {
      if (sigmas != nullptr) {
        layout.is_free.push_back(sigmas[i] > 0.0);
      } else {
        layout.is_free.push_back(heading_held ? i > 0 : i < free_size);
      }
    }
    layout.blocks.push_back(block);
    layout.offsets.push_back(layout.offsets.back() + size);
  }
  return layout;
}

Unknowns::Values Unknowns::ValuesOf(const BlockLayout& layout) const {
  Values values(layout.blocks.size());
  for (size_t i = 0; i < layout.blocks.size(); ++i) {
    std::copy_n(Data(layout.blocks[i]), AmbientSize(layout.blocks[i]), values[i].begin());
  }
  return values;
}

void Unknowns::SetValues(const BlockLayout& layout, const Values& values) const {
  for (size_t i = 0; i < layout.blocks.size(); ++i) {
    std::copy_n(values[i].begin(), AmbientSize(layout.blocks[i]), Data(layout.blocks[i]));
  }
}

void Unknowns::Move(const BlockLayout& layout, const Eigen::VectorXd& step) const {
  const double* next = step.data();
  for (const BlockId& block : layout.blocks) {
    double* data = Data(block);
    const int size = AmbientSize(block);
    Values::value_type moved;
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

}  // namespace plumbline
