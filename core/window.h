#pragma once

#include <Eigen/Core>
#include <deque>
#include <vector>

#include "core/association.h"
#include "core/estimation_problem.h"
#include "core/landmark.h"
#include "core/mapper_options.h"
#include "core/observation.h"
#include "core/rig.h"
#include "core/trajectory.h"

namespace plumbline {

// Everything the mapper estimates, in one place; window, tracking and batch work on it.
struct MapState {
  Trajectory trajectory;
  std::deque<Landmark> landmarks;        // position = id; merged ones stay, without segments
  std::deque<Observation> observations;  // by time
  int64_t origin_time_ns = 0;            // instant whose position is the model frame's origin
};

// Joint covariance of some control points, from which a pose's covariance at any instant on
// them follows.
class PoseUncertainty {
 public:
  PoseUncertainty() = default;
  explicit PoseUncertainty(const NormalEquations& equations);

  // World-frame rotation (rad) and position (m) of the body.
  Matrix6d At(const Trajectory& trajectory, int64_t time_ns) const;
  // Derivative of the pose by the control points, in the columns of covariance().
  Eigen::MatrixXd JacobianAt(const Trajectory& trajectory, int64_t time_ns) const;
  const Eigen::MatrixXd& covariance() const { return covariance_; }

 private:
  std::vector<BlockId> blocks_;
  std::vector<int> offsets_;
  Eigen::MatrixXd covariance_;
};

// The estimation while scans come in (paper, section 4.6, with marginalised history in place
// of frozen planes). Track() is the light step of every scan: newest poses only, planes held.
// Solve() is the full step, once per knot interval: all control points and planes of the
// window; what leaves it is marginalised into a prior on all the planes and the oldest control
// points that remain.
class Window {
 public:
  Window(const Rig& rig, bool planar, const MapperOptions& options, MapState* state);

  // Associates the observations first .. last of the newest scan with the candidates and
  // estimates its poses, in turn until the associations stand.
  void Track(int first_observation,
             int last_observation,
             const std::vector<int>& candidate_ids);

  // An observation that has been given a landmark: takes part from now on, unless it is older
  // than the window. tracked: by Track(), which knows of it already.
  void Add(int observation_index, bool tracked);

  void Solve(int64_t now_ns, double window_s);

  // Uncertainty of the newest poses, the planes given.
  const PoseUncertainty& pose_uncertainty() const { return pose_uncertainty_; }

  // Makes landmark `from` part of landmark `into` in the history.
  void MergeLandmarks(int into, int from);

 private:
  void AddMotionPriors(EstimationProblem* problem, int first, int last) const;
  void AddStart(EstimationProblem* problem) const;
  std::unique_ptr<EstimationProblem> TrackingProblem(int first_observation,
                                                     int last_observation) const;
  // Finds the observations' landmarks; true when any is another one than before.
  bool Associate(int first_observation,
                 int last_observation,
                 const std::vector<int>& candidate_ids);
  void UpdateUncertainty(const NormalEquations& equations);
  // Associates by the prediction: see ChooseJointly. Returns whether any was found.
  bool AssociateJointly(int first_observation,
                        int last_observation,
                        const std::vector<int>& candidate_ids);
  void Marginalise(int new_start);

  const Rig& rig_;
  bool planar_;
  const MapperOptions& options_;
  MapState* state_;
  int start_ = 0;            // first control point of the window
  Prior history_;            // marginalised, on control points from start_ and landmarks
  std::vector<int> window_;  // observations not yet marginalised
  Prior tracking_prior_;    // on the newest control points, from all scans so far, planes held
  int tracking_known_ = 0;  // control points that tracking_prior_ knows of
  std::vector<int> recent_;  // observations that tracking_prior_ does not know of
  PoseUncertainty pose_uncertainty_;
};

}  // namespace plumbline
