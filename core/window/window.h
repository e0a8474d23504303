#pragma once

#include <Eigen/Core>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "core/estimation/estimation_problem.h"
#include "core/estimation/normal_equations.h"
#include "core/estimation/solver.h"
#include "core/geometry/matrix_types.h"
#include "core/map/map_state.h"
#include "core/options/mapper_options.h"
#include "core/result/result_types.h"
#include "core/sensor/rig.h"
#include "core/trajectory/motion_prior.h"
#include "core/trajectory/pose_gaussian.h"
#include "core/window/inactive_landmarks.h"
#include "core/window/marginal_prior.h"
#include "factors/linear_algebra/elimination.h"

namespace plumbline {

// WindowEstimate is what the window knows after a solution, in the model frame.
struct WindowEstimate {
  StampedPose newest_pose;
  Matrix6d pose_covariance;             // world-frame rotation (rad) and position (m)
  std::vector<int> landmark_ids;        // in view, ascending
  Eigen::MatrixXd landmark_covariance;  // of their parameters together
};

// Window takes the full step of the estimation while scans come in, every
// WindowOptions::step_s or half of it (paper, section 4.6, with a marginal prior in place of
// frozen planes): all control points and planes of the window, and the scanners. What leaves
// it is marginalised into a prior on the planes met, the scanners and the oldest control
// points that remain.
//
// Planes out of view for kInactiveAfter solves are inactive (InactiveLandmarks): they wait
// outside of the marginal prior until they are seen again. Their parameters and covariances in
// the map, for association and loop closure, are renewed every kInactivePeriod solves, and in
// each solve that an inactive landmark comes into view, as when a loop closes; while none
// does, they hardly change. What is in view is estimated as if no plane ever rested.
class Window {
 public:
  Window(const Rig& rig,
         bool planar,
         const MapperOptions& options,
         MotionPrior* motion_prior,
         MapState* state);
  // Goes on from where another one stands, with copies of what it works on.
  Window(const Window& other, const Rig& rig, MotionPrior* motion_prior, MapState* state);

  // Adds an observation that has been given a landmark: it takes part from now on, unless it
  // is older than the window.
  void Add(int observation_index);

  // Takes these landmarks (is_chosen: by id) from the window's observations, and the pose
  // constraints from the window: the next solution does without.
  void TakeBack(const std::vector<bool>& is_chosen);
  // The window's first control point.
  int start() const { return start_; }

  // Estimates the window's control points, all planes and the scanners, and leaves the
  // covariances of planes and scanners, the newest pose given. Returns what is then known of
  // the newest control points, the planes given. Throws Error when the scans do not determine
  // the poses and planes.
  PoseGaussian Solve(int64_t now_ns, double window_s);

  // The window's estimates so far; empty unless the options ask for them. The planes are those
  // of the last estimate only.
  const std::vector<WindowEstimate>& estimates() const { return estimates_; }
  // Forgets them, where the map goes to another frame.
  void ForgetEstimates() { estimates_.clear(); }

  // Makes landmark `from` part of landmark `into` in the marginal prior.
  void MergeLandmarks(int into, int from);

 private:
  static constexpr int kInactiveAfter = 16;
  static constexpr int kInactivePeriod = 8;

  // The marginal prior's blocks that take no part in the window's iterations, eliminated:
  // planes out of view and retained control points. They follow what the other blocks do.
  // Positions in prior_.equations.blocks.
  struct OutOfView {
    std::vector<size_t> blocks;
    std::vector<size_t> active_blocks;  // the others
    std::optional<Elimination> elimination;
  };

  // Brings the landmarks in view back from the inactive ones; true when there was any.
  bool ActivateLandmarks(const std::set<int>& in_view);
  void DeactivateLandmarks();
  OutOfView EliminateOutOfView(const std::set<int>& in_view) const;
  // Adds the marginal prior on the active blocks, as a square-root prior.
  void AddMarginalPrior(const OutOfView& out_of_view, EstimationProblem* problem) const;
  // Sets estimates and covariances of the planes out of view, and of the inactive ones where
  // that is due, from the solution of the others, whose covariance is in the rows of
  // `equations`.
  void MoveOutOfView(const OutOfView& out_of_view,
                     const EstimationProblem& problem,
                     const NormalEquations& equations,
                     Eigen::MatrixXd covariance,
                     bool inactive_too);
  void AddStart(EstimationProblem* problem) const;
  // Adds the pose constraints of the window, those that begin before this control point only.
  void AddPoseConstraints(int end, EstimationProblem* problem) const;
  // Tells the motion prior of the accelerations of the control points that leave the window.
  void LearnMotion(const NormalEquations& equations,
                   const Eigen::MatrixXd& covariance,
                   int new_start);
  // The first motion prior that the marginal prior does not hold: each reaches one control
  // point further back than its own three.
  int FirstMotionPrior() const { return start_ == 0 ? 0 : start_ + 1; }
  void AddMotionPriors(EstimationProblem* problem, int first, int last) const;
  std::set<int> LandmarksInWindow() const;
  // The tangent by which a block has moved since the marginal prior was written.
  Eigen::VectorXd Moved(const EstimationProblem& problem, size_t block) const;
  PoseGaussian NewestPoses(const NormalEquations& equations, int newest) const;
  void KeepEstimate(const NormalEquations& equations, int newest, int64_t now_ns);
  void Marginalise(int new_start);
  // Begins the window with this control point, and leaves behind the constraints before it.
  void MoveStart(int new_start);

  const Rig& rig_;
  bool planar_;
  const MapperOptions& options_;
  MotionPrior* motion_prior_;
  MapState* state_;
  std::unique_ptr<WindowSolver> solver_;
  int start_ = 0;  // first control point of the window
  // The prior on control points from start_, on retained control points before it, and on the
  // planes that are not inactive.
  MarginalPrior prior_;
  InactiveLandmarks inactive_;
  int num_solves_ = 0;
  std::map<int, int> last_in_view_;  // solve in which each plane was in view for the last time
  std::vector<int> window_;          // observations not yet marginalised
  size_t first_constraint_ = 0;      // of the pose constraints not yet marginalised
  SegmentGroupCache groups_{LinearisedGroup::kCoarse, 1};
  std::vector<WindowEstimate> estimates_;
};

}  // namespace plumbline
