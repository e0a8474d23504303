#pragma once

#include <ceres/manifold.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <Eigen/Core>
#include <array>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <tuple>
#include <unordered_map>
#include <vector>

#include "core/estimation/arrowhead_equations.h"
#include "core/estimation/arrowhead_matrix.h"
#include "core/estimation/block_layout.h"
#include "core/estimation/normal_equations.h"
#include "core/estimation/segment_groups.h"
#include "core/map/landmark.h"
#include "core/map/observation.h"
#include "core/options/mapper_options.h"
#include "core/sensor/rig.h"
#include "core/trajectory/motion_noise.h"
#include "core/trajectory/trajectory.h"
#include "factors/cost/linear_prior_factor.h"

namespace plumbline {

class ArrowheadCholesky;

// A Gaussian on some blocks: history that has been marginalised.
struct Prior {
  std::vector<BlockId> blocks;  // in order, parallel to linear.blocks
  LinearPrior linear;

  bool empty() const { return blocks.empty(); }
};

// A Ceres problem over a rig's trajectory and the landmarks: gives every block its manifold,
// and turns observations, motion priors, marginalised history and gauge into residual blocks.
// Window, batch and bound differ only in what they add.
class EstimationProblem {
 public:
  EstimationProblem(const Rig& rig,
                    bool planar,
                    Trajectory* trajectory,
                    std::deque<Landmark>* landmarks);

  // Point-to-plane residuals of segments, one residual block for all that begin in the same
  // knot interval, or in the same of the cache's groups (factors/segment/linearised_group.h).
  // huber_width: in standard deviations of the norm of a segment's residuals, 0 for plain
  // least squares. The observations outlive the problem. cache: groups that stand as they were
  // are taken from it.
  void AddSegments(const std::vector<const Observation*>& observations,
                   double huber_width,
                   ObservationGroupCache* cache);
  void AddSegments(const std::vector<const Observation*>& observations, double huber_width);
  // The same as one residual block for each beam, plain least squares.
  void AddPoints(const Observation& observation);
  // Second differences of control points first, first+1, first+2.
  void AddMotionPrior(int first, const MotionNoise& noise);
  void AddMotionPrior(int first, const TrajectoryOptions& options) {
    AddMotionPrior(first, MotionNoise::Of(options));
  }
  // First differences of the first two control points: unknown velocity at the start.
  void AddStartVelocityPrior(const TrajectoryOptions& options);
  // Gauge: the position at this instant is the origin.
  void AddOrigin(int64_t time_ns);
  // All of these for the whole trajectory: what there is besides observations.
  void AddTrajectoryTerms(const TrajectoryOptions& options,
                          const MotionNoise& noise,
                          int64_t origin_time_ns);
  void AddPrior(const Prior& prior);

  // Blocks that occur in residuals, in order.
  std::vector<BlockId> Blocks() const;

  // Ends early after a step for which no group of segments had to be linearised anew: the
  // problem was linear there, and the step has solved it. Throws Error when the solver fails.
  ceres::Solver::Summary Solve(const ceres::Solver::Options& options);

  // The same by Gauss-Newton on the normal equations, for problems so small that Ceres' own
  // work would be several times that of the factors. An iteration that lowers the cost by no
  // more than this share of it is not taken and is the last one. Returns the normal equations
  // at the solution.
  NormalEquations SolveNormalEquations(int max_iterations, double function_tolerance);

  // By Gauss-Newton as well, on the equations in the batch's shape, which its covariances come
  // from too; a step that would raise the cost is halved. Ends after a step that lowers it by
  // no more than the tolerance, or by what its linear model told to within the tolerance: the
  // next one would lower it no further. Throws Error when the unknowns are not determined.
  struct Tolerance {
    double share = 0.0;  // of the cost
    double cost = 0.0;   // or this, whichever is more
  };
  struct Solution {
    ArrowheadEquations equations;  // at the solution
    int num_unknowns;
  };
  // visit: called with each step's factor, the problem's values still those before the step.
  using CholeskyVisitor = std::function<void(const ArrowheadCholesky&)>;
  Solution SolveArrowhead(
      int max_iterations,
      const Tolerance& tolerance,
      const CholeskyVisitor& visit = [](const ArrowheadCholesky&) {});
  // Its first step alone. Whether that lowers the cost is verified only where it moves a
  // control point far: it takes as long as the step.
  void TakeArrowheadStep();

  // Normal equations of all the residuals.
  ArrowheadEquations LineariseArrowhead(const BlockLayout& layout) const;
  NormalEquations Linearise() const { return Linearise(Layout()); }
  BlockLayout Layout() const;
  // (columns, ascending; dense Jacobian on them; residuals) of a residual block.
  using ResidualVisitor = std::function<void(
      const std::vector<int>&, const Eigen::MatrixXd&, const Eigen::VectorXd&)>;
  // Visits the residual blocks at the problem's current values, one at a time: all of them
  // together would take more memory than anything else.
  void ForEachResidualBlock(const BlockLayout& layout, const ResidualVisitor& visit) const;
  // The same for the motion priors alone: of the rotations, or of the positions.
  void ForEachMotionPrior(bool of_rotations,
                          const BlockLayout& layout,
                          const ResidualVisitor& visit) const;
  bool planar() const { return planar_; }
  ceres::Problem* ceres_problem() { return &problem_; }
  int TangentSize(const BlockId& block) const;
  int AmbientSize(const BlockId& block) const;
  LinearPrior::Kind KindOf(const BlockId& block) const;
  double* Data(const BlockId& block) const;

 private:
  // A group of segments and its parameters.
  struct GroupTerm {
    std::shared_ptr<LinearisedGroup> group;
    std::vector<double*> blocks;
  };
  // Rows of a group that are consecutive columns of a layout, too.
  struct RowRange {
    int row;
    int column;
    int size;
  };
  // What the blocks hold, by the position in a layout.
  using Values = std::vector<std::array<double, 4>>;
  using BlockPositions = std::unordered_map<const double*, size_t>;

  // Of a block that occurs; nullptr: its tangent is the block itself.
  const ceres::Manifold* ManifoldOf(const BlockId& block) const;
  void Register(const BlockId& block);
  void SetLandmarkManifold(const Landmark& landmark);
  std::vector<double*> ControlPointBlocks(int first, int count);
  // A residual block that is no group of segments.
  ceres::ResidualBlockId AddFactor(std::unique_ptr<ceres::CostFunction> factor,
                                   const std::vector<double*>& blocks);
  BlockPositions PositionsIn(const BlockLayout& layout) const;
  void VisitResidualBlocks(const std::vector<ceres::ResidualBlockId>& residual_blocks,
                           const BlockLayout& layout,
                           const ResidualVisitor& visit) const;
  // Visits (columns, ascending; J^T J; J^T r) of the residual blocks that are no groups;
  // returns their cost.
  using ProductVisitor = ResidualVisitor;
  double VisitProducts(const BlockLayout& layout, const ProductVisitor& visit) const;
  NormalEquations Linearise(const BlockLayout& layout) const;
  // A group's rows that are not held, ascending in the layout as in the group.
  std::vector<RowRange> RowRangesOf(const GroupTerm& term,
                                    const BlockLayout& layout,
                                    const BlockPositions& positions) const;
  // Adds its cost, gradient and the lower triangle of its Hessian.
  void AddGroup(const GroupTerm& term,
                const BlockLayout& layout,
                const BlockPositions& positions,
                NormalEquations* equations) const;
  int NumLinearisations() const;
  Values ValuesOf(const BlockLayout& layout) const;
  void SetValues(const BlockLayout& layout, const Values& values);
  // Moves the blocks by their parts of a step in the free columns.
  void Move(const BlockLayout& layout, const Eigen::VectorXd& step);
  // Likewise by a step in all columns, halved for as long as it would raise the cost of `now`;
  // share: multiplied by what was taken of it. Gives the equations there. False, and all as it
  // was, where a sixteenth of it would still raise the cost.
  bool MoveDown(const BlockLayout& layout,
                Eigen::VectorXd step,
                ArrowheadEquations* now,
                double* share);

  const Rig& rig_;
  bool planar_;
  Trajectory* trajectory_;
  std::deque<Landmark>* landmarks_;
  // Extrinsics as parameter blocks, constant: the factors can estimate them.
  std::vector<std::array<double, 4>> extrinsic_rotations_;
  std::vector<std::array<double, 3>> extrinsic_translations_;
  // Shared by all blocks; declared before the problem that refers to them.
  std::unique_ptr<ceres::Manifold> rotation_manifold_;
  std::unique_ptr<ceres::Manifold> planar_position_manifold_;
  std::unique_ptr<ceres::Manifold> fixed_heading_manifold_;
  std::vector<std::unique_ptr<ceres::Manifold>> plane_manifolds_;
  std::map<BlockId, double*> blocks_;
  std::vector<GroupTerm> groups_;
  std::vector<ceres::ResidualBlockId> factors_;  // all residual blocks that are no groups
  std::vector<ceres::ResidualBlockId> rotation_priors_;  // on the motion, of the factors
  std::vector<ceres::ResidualBlockId> position_priors_;
  ceres::Problem problem_;
};

}  // namespace plumbline
