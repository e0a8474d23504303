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

// Adds to the normal matrix of an estimate, and its diagonal, what makes the matrix' inverse
// the covariance of the estimate's errors where the motion has other noise than its prior
// assumes. With H the matrix, P the prior's share in it, and a motion of rho times the
// variance assumed, that covariance is
//   H^-1 (H - P + rho P) H^-1 = H^-1 - H^-1 D H^-1,   D = (1 - rho) P
// (White 1982, for a misspecified likelihood), to first order the inverse of H + D. Of a rig
// rougher than assumed D is (1 / rho - 1) P, the same to first order, so that the information
// left never becomes negative.
void CorrectForMotion(const MotionNoise& assumed,
                      const MotionNoise& found,
                      const EstimationProblem& problem,
                      ArrowheadEquations* equations);

}  // namespace plumbline
