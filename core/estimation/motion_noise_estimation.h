#pragma once

#include <vector>

#include "core/trajectory/motion_noise.h"

namespace plumbline {

class ArrowheadCholesky;
class EstimationProblem;

// What an estimate under the noise `assumed` tells of the motion's noise at each knot. With
// G = I - J H^-1 J^T, where J is the motion prior's share of the whitened Jacobian and H the
// normal matrix, accelerations of sigma^2 times the variance assumed are estimated as values
// that have, whitened, the covariance G + (sigma^2 - 1) G^2, so that
//   r^2 - G_kk + (G^2)_kk
// is (G^2)_kk sigma^2 in the mean. MotionProfile::From then takes a step of Fisher's scoring
// (Patterson and Thompson 1971, on the variances of a mixed model): one step is nearly enough,
// where expectation maximisation takes dozens if single accelerations are hardly determined.
// Both diagonals are known from a few random combinations (Hutchinson 1990), always the same.
// problem: the estimate's, with motion priors for the noise assumed on all its knots. factor:
// of its normal matrix.
std::vector<MotionEvidence> FindMotionEvidence(const MotionProfile& assumed,
                                               const EstimationProblem& problem,
                                               const ArrowheadCholesky& factor);

}  // namespace plumbline
