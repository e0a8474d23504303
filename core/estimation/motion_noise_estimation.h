#pragma once

#include <Eigen/Core>

#include "core/options/mapper_options.h"
#include "core/trajectory/motion_noise.h"

namespace plumbline {

class ArrowheadCholesky;
class EstimationProblem;
struct ArrowheadEquations;

// One step towards the noise that makes the recording likeliest. For the accelerations a_i of
// the estimate under `assumed`, and their posterior variances v_i, of each kind:
//   sigma'^2 = sum a_i^2 / gamma,   gamma = sum (1 - v_i / sigma^2)
// (MacKay 1992, Bayesian Interpolation, section 4). gamma is how many of the
// accelerations the scans determine. Where it stands still, it is the fixed point of EM too,
// sigma^2 = mean(a_i^2 + v_i), which takes several times the steps. A kind that the scans do
// not determine keeps what is assumed. The sum of the variances is known from a few random
// combinations of the accelerations (Hutchinson 1990), always the same ones, to a few per
// cent.
// problem: the estimate's, with motion priors for the noise assumed. factor: of its normal
// matrix.
MotionNoise ReestimateMotionNoise(const MotionNoise& assumed,
                                  const EstimationProblem& problem,
                                  const ArrowheadCholesky& factor);

}  // namespace plumbline
