#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <deque>
#include <map>
#include <memory>
#include <vector>

#include "core/estimation/block_layout.h"
#include "core/map/rig_calibration.h"
#include "core/surface/landmark.h"
#include "core/trajectory/trajectory.h"
#include "factors/cost/linear_prior_factor.h"

namespace ceres {
class Manifold;
}  // namespace ceres

namespace plumbline {

// Unknowns are the parameter blocks of an estimation problem: control points, landmarks,
// scanners and IMU where their owners have them, each with its manifold, and which of them are
// held.
class Unknowns {
 public:
  // trajectory, landmarks and calibration hold the values and outlive the unknowns.
  // calibration: nullptr where no scanner is estimated.
  Unknowns(bool planar,
           Trajectory* trajectory,
           std::deque<Landmark>* landmarks,
           RigCalibration* calibration);
  Unknowns(Unknowns&&);
  ~Unknowns();

  bool planar() const { return planar_; }
  // Holds all landmarks, or the control points before this one, constant. Called before any
  // block is registered.
  void HoldLandmarks() { landmarks_held_ = true; }
  void HoldControlPointsBefore(int control_point) { first_free_ = control_point; }
  bool landmarks_held() const { return landmarks_held_; }
  int first_free() const { return first_free_; }

  // Takes a block that a term has among the unknowns, unless it is held.
  void Register(const BlockId& block);
  // The registered blocks, in order, and their columns.
  BlockLayout Layout() const;

  int TangentSize(const BlockId& block) const;
  int AmbientSize(const BlockId& block) const;
  LinearPrior::Kind KindOf(const BlockId& block) const;
  double* Data(const BlockId& block) const;
  // The manifold of a registered block; nullptr: its tangent is the block itself.
  const ceres::Manifold* ManifoldOf(const BlockId& block) const;

  static constexpr int kLargestBlock = std::max<int>(kMountedBlockSize, kImuBlockSize);
  // Values of the unknowns, by their position in a layout.
  using Values = std::vector<std::array<double, kLargestBlock>>;
  Values ValuesOf(const BlockLayout& layout) const;
  void SetValues(const BlockLayout& layout, const Values& values) const;
  // Moves the unknowns by their parts of a step, whose rows are the layout's free columns.
  void Move(const BlockLayout& layout, const Eigen::VectorXd& step) const;

 private:
  bool IsHeld(const BlockId& block) const {
    return IsControlPoint(block) ? block.index < first_free_ : landmarks_held_;
  }
  ScannerEstimate& Estimate(const BlockId& scanner) const {
    return calibration_->scanners[static_cast<size_t>(scanner.index)];
  }
  ImuBiases& Biases(const BlockId& bias) const {
    ImuEstimate& imu = *calibration_->imu;
    return imu.biases[static_cast<size_t>(imu.NodeOfLastInterval(bias.index))];
  }
  // Prior standard deviations of a block of which some numbers may be held; nullptr: none are.
  const double* PriorSigmas(const BlockId& block) const;
  const ceres::Manifold* MakeManifold(const BlockId& block);

  bool planar_;
  Trajectory* trajectory_;
  std::deque<Landmark>* landmarks_;
  RigCalibration* calibration_;
  bool landmarks_held_ = false;
  int first_free_ = 0;
  std::unique_ptr<ceres::Manifold> rotation_manifold_;  // shared by all rotations
  std::unique_ptr<ceres::Manifold> planar_position_manifold_;
  std::unique_ptr<ceres::Manifold> fixed_heading_manifold_;
  std::vector<std::unique_ptr<ceres::Manifold>> own_manifolds_;  // of planes and scanners
  std::map<BlockId, const ceres::Manifold*> blocks_;
};

}  // namespace plumbline
