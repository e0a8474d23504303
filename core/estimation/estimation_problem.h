#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <vector>

#include "core/estimation/block_layout.h"
#include "core/estimation/segment_groups.h"
#include "core/estimation/unknowns.h"
#include "core/map/observation.h"
#include "core/map/rig_calibration.h"
#include "core/options/mapper_options.h"
#include "core/sensor/rig.h"
#include "core/surface/landmark.h"
#include "core/trajectory/motion_noise.h"
#include "core/trajectory/pose_constraint.h"
#include "core/trajectory/trajectory.h"
#include "factors/cost/linear_prior_factor.h"
#include "factors/cost/odometry_factor.h"

namespace ceres {
class CostFunction;
}  // namespace ceres

namespace plumbline {

// A Gaussian on some blocks: the marginal prior of a window, or what the tracker knows.
struct Prior {
  std::vector<BlockId> blocks;  // in order, parallel to linear.blocks
  LinearPrior linear;

  bool empty() const { return blocks.empty(); }
};

// A cost function and the parameter blocks that it takes, in its order.
struct FactorTerm {
  enum class Kind { kOther, kRotationAcceleration, kPositionAcceleration, kImu };

  std::shared_ptr<const ceres::CostFunction> factor;
  std::vector<double*> blocks;
  Kind kind = Kind::kOther;
  double huber_width = 0.0;  // of a robust loss, in standard deviations; 0: none
};

// Segments that begin near each other in time, as one quadratic term, and its blocks:
// rotations, positions, landmarks.
struct GroupTerm {
  std::shared_ptr<LinearisedGroup> group;
  std::vector<double*> blocks;
};

// A least squares problem over a rig's trajectory and its landmarks: the unknowns, each with
// its manifold, and the terms of the cost. Tracker, window, batch and bound differ in what
// they add and in what they hold constant; solvers (core/estimation/solver.h) move the
// unknowns.
//
// Segments are kept twice: as quadratic terms of many (factors/segment/linearised_group.h),
// which our own solver and all covariances use, and as observations, of which CeresSolver
// makes one cost function each.
class EstimationProblem {
 public:
  // trajectory, landmarks and calibration hold the unknowns' values and outlive the problem.
  // calibration: its estimated scanners are unknowns, where segments are added and landmarks
  // are not held; nullptr: none is. Single points have their scanners where the rig has them.
  EstimationProblem(const Rig& rig,
                    bool planar,
                    Trajectory* trajectory,
                    std::deque<Landmark>* landmarks,
                    RigCalibration* calibration = nullptr);
  EstimationProblem(EstimationProblem&&);
  ~EstimationProblem();

  // Holds all landmarks, or the control points before this one, constant. Called before any
  // term is added.
  void HoldLandmarks() { unknowns_.HoldLandmarks(); }
  void HoldControlPointsBefore(int control_point) {
    unknowns_.HoldControlPointsBefore(control_point);
  }
  // Adds the point-to-plane residuals of segments that have a landmark. huber_width: of the
  // loss on the norm of a segment's residuals, in standard deviations; 0: least squares. The
  // observations outlive the problem. Groups that stand as they were are taken from the cache.
  void AddSegments(const std::vector<const Observation*>& observations,
                   double huber_width,
                   SegmentGroupCache* cache);
  void AddSegments(const std::vector<const Observation*>& observations, double huber_width);
  // Adds the same residuals beam by beam, each a cost function of its own (CreatePointFactor).
  void AddPoints(const Observation& observation);
  // Adds the prior on the acceleration of control points first .. first + 2, given the one
  // before; where that reaches back to control points that are held or before the first one, on
  // the acceleration alone.
  void AddMotionPrior(int first, const MotionNoise& noise);
  // Adds the prior on the first differences of the first two control points: the velocity at
  // the start is unknown.
  void AddStartVelocityPrior(const TrajectoryOptions& options);
  // Adds the gauge: the position at this instant is the origin.
  void AddOrigin(int64_t time_ns);
  // Adds these three for the whole trajectory: everything besides observations.
  void AddTrajectoryTerms(const TrajectoryOptions& options,
                          const MotionProfile& noise,
                          int64_t origin_time_ns);
  void AddPrior(const Prior& prior);
  void AddPoseConstraint(const PoseConstraint& constraint);
  // Adds what wheels say of the motion between two instants, a few knot intervals at most.
  void AddOdometry(int64_t begin_ns, int64_t end_ns, const OdometryMeasurement& measurement);
  // Adds any other cost function over these blocks, in its order.
  void AddFactor(std::unique_ptr<ceres::CostFunction> factor,
                 const std::vector<BlockId>& blocks,
                 FactorTerm::Kind kind = FactorTerm::Kind::kOther);

  // The unknowns of the terms.
  const Unknowns& unknowns() const { return unknowns_; }
  // The unknowns that occur in terms, in order, and their columns.
  BlockLayout Layout() const { return unknowns_.Layout(); }
  const std::vector<FactorTerm>& factor_terms() const { return factor_terms_; }
  const std::vector<GroupTerm>& group_terms() const { return group_terms_; }
  // The segments as cost functions, one each (CreateSegmentFactor), weighted for the unknowns
  // as they stand.
  std::vector<FactorTerm> MakeSegmentTerms() const;
  bool planar() const { return unknowns_.planar(); }

 private:
  struct Segments {
    std::vector<const Observation*> observations;
    double huber_width;
  };

  std::vector<BlockId> EstimatedScanners() const;
  std::vector<double*> ControlPointBlocks(int first, int count);
  void Add(std::unique_ptr<ceres::CostFunction> factor,
           const std::vector<double*>& blocks,
           FactorTerm::Kind kind = FactorTerm::Kind::kOther);
  FactorTerm MakeSegmentTerm(const Observation& observation, double huber_width) const;

  const Rig& rig_;
  Trajectory* trajectory_;
  std::deque<Landmark>* landmarks_;
  RigCalibration* calibration_;
  Unknowns unknowns_;
  // The extrinsics are parameter blocks that no layout has, constant: the factors can estimate
  // them.
  std::vector<std::array<double, 4>> extrinsic_rotations_;
  std::vector<std::array<double, 3>> extrinsic_translations_;
  std::vector<GroupTerm> group_terms_;
  std::vector<FactorTerm> factor_terms_;
  std::vector<Segments> segments_;
};

}  // namespace plumbline
