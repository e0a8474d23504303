#pragma once

#include <Eigen/Core>
#include <deque>
#include <vector>

#include "core/result/plane_covariance.h"
#include "core/result/result_types.h"
#include "core/surface/landmark.h"

namespace plumbline {

// Converts the landmarks that have observations to plane patches, with their ids.
std::vector<PlanePatch> PlanePatches(const std::deque<Landmark>& landmarks);

// Converts a joint covariance of the patches' landmarks, of their parameters in the patches'
// order, to that of the parameters that PlaneCovariance states.
PlaneCovariance StatedCovariance(const std::deque<Landmark>& landmarks,
                                 std::vector<PlanePatch> patches,
                                 const Eigen::MatrixXd& covariance);

}  // namespace plumbline
