#pragma once

#include <memory>
#include <vector>

#include "core/estimation/arrowhead_cholesky.h"
#include "core/estimation/arrowhead_equations.h"
#include "core/estimation/correlated_errors.h"
#include "core/estimation/estimation_problem.h"
#include "core/estimation/map_covariance.h"
#include "core/estimation/segment_groups.h"
#include "core/estimation/solver.h"
#include "core/map/map_state.h"
#include "core/options/mapper_options.h"
#include "core/sensor/rig.h"
#include "core/trajectory/motion_noise.h"
#include "core/util/stopwatch.h"

namespace plumbline {

// FinalEstimate is what the last estimation gives besides the values in the state.
struct FinalEstimate {
  MotionNoise motion_noise;      // usual one of the recording, which the estimate assumes
  double variance_factor = 0.0;  // weighted sum of squares / redundancy
  MapCovariance covariance;
  Stopwatch covariance_watch;  // the time that the covariance took, part of the estimation's
};

// The least squares of the batch: all control points and landmarks of a state, from all of its
// observations and sub-minimum segments that have a landmark.
class BatchEstimator {
 public:
  // The state outlives the estimator, and its associations may change between the estimations.
  // rig: the rig file's, with clocks that stay; gets the scanners' poses as they are
  // estimated.
  BatchEstimator(bool planar, const MapperOptions& options, MapState* state, Rig* rig);

  // Estimates with a robust loss, for associations that may still be wrong.
  void EstimateRobustly();
  // Gives back the memory of what is kept from one estimation to the next.
  void ForgetLinearisations();
  // Takes one Gauss-Newton step with the robust loss, whichever solver the options name.
  // Between rounds little changes: what one step leaves is less than the next associations
  // will move.
  void StepRobustly();
  // The covariance of the poses where surfaces are as they are estimated.
  MapCovariance PosesOnSurfaces();
  // Estimates by plain least squares, and gives landmarks and scanners their covariances
  // (absolute, in the model frame).
  FinalEstimate EstimateFinally();

 private:
  // Groups of two take more memory, of six hardly less; see also kTileControlPoints.
  static constexpr int kIntervalsPerGroup = 4;

  // All residuals; huber_width 0: plain least squares.
  std::unique_ptr<EstimationProblem> BuildProblem(FactorKind factor, double huber_width);
  // Estimates, and takes the motion's noise from the estimate. Returns the largest relative
  // change of a usual density.
  double EstimateWithNoise(double huber_width, const SolverOptions& options);
  // Weighted sum of the scans' squared residuals over their redundancy.
  double VarianceFactor(const EstimationProblem& problem,
                        double cost,
                        const MotionEvidence& motion) const;
  // What the residuals say of errors that repeat from scan to scan.
  CorrelatedErrors FindCorrelatedErrors(const EstimationProblem& problem,
                                        const ArrowheadCholesky& factor) const;
  // Takes the motion's noise from the evidence of an estimate. Returns the largest relative
  // change of a usual density.
  double TakeNoise(const std::vector<MotionEvidence>& evidence);
  // The covariance of the estimate where the problem stands; gives the landmarks their parts
  // of it.
  MapCovariance SetCovariances(const EstimationProblem& problem);

  Rig* rig_;
  bool planar_;
  const MapperOptions& options_;
  MapState* state_;
  MotionProfile motion_noise_;  // that the estimates assume
  SegmentGroupCache groups_;
};

}  // namespace plumbline
