#pragma once

#include <Eigen/Core>
#include <optional>
#include <set>
#include <vector>

#include "core/estimation_problem.h"
#include "core/map_state.h"
#include "core/mapper_options.h"
#include "core/rig.h"
#include "core/tracker.h"
#include "factors/elimination.h"

namespace plumbline {

// The full step of the estimation while scans come in, once per knot interval (paper, section
// 4.6, with marginalised history in place of frozen planes): all control points and planes of
// the window. What leaves it is marginalised into a history of all the planes met so far and
// the oldest control points that remain.
class Window {
 public:
  Window(const Rig& rig, bool planar, const MapperOptions& options, MapState* state);

  // An observation that has been given a landmark: takes part from now on, unless it is older
  // than the window.
  void Add(int observation_index);

  // Estimates the window's control points and all planes, and leaves the planes' covariances,
  // the newest pose given. Returns what is then known of the newest control points, the planes
  // given. Throws Error when the scans do not determine the poses and planes.
  PoseGaussian Solve(int64_t now_ns, double window_s);

  // Makes landmark `from` part of landmark `into` in the history.
  void MergeLandmarks(int into, int from);

 private:
  // A quadratic cost on some blocks about the values they had.
  struct History {
    NormalEquations equations;
    std::vector<Eigen::VectorXd> at;  // parallel to equations.blocks
  };

  // The history's planes that are not in view, eliminated: they take no part in the window's
  // iterations and follow what the other blocks do. Positions in history_.equations.blocks.
  struct Dormant {
    std::vector<size_t> blocks;
    std::vector<size_t> active_blocks;  // the others
    std::optional<Elimination> elimination;
  };

  Dormant EliminateDormant() const;
  // What the history says of the active blocks, as a square-root prior.
  void AddHistory(const Dormant& dormant, EstimationProblem* problem) const;
  // Estimates and covariances of the dormant planes from the solution of the others, whose
  // covariance is in the rows of `equations`.
  void MoveDormant(const Dormant& dormant,
                   const EstimationProblem& problem,
                   const NormalEquations& equations,
                   const Eigen::MatrixXd& covariance);
  void AddStart(EstimationProblem* problem) const;
  void AddMotionPriors(EstimationProblem* problem, int first, int last) const;
  std::set<int> LandmarksInWindow() const;
  // How far a block has moved since the history was written, in its tangent.
  Eigen::VectorXd Moved(const EstimationProblem& problem, size_t block) const;
  PoseGaussian NewestPoses(const NormalEquations& equations, int newest) const;
  void Marginalise(int new_start);

  const Rig& rig_;
  bool planar_;
  const MapperOptions& options_;
  MapState* state_;
  int start_ = 0;            // first control point of the window
  History history_;          // on control points from start_ and landmarks
  std::vector<int> window_;  // observations not yet marginalised
  ObservationGroupCache groups_{LinearisedGroup::kCoarse};
};

}  // namespace plumbline
