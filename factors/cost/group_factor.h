#pragma once

#include <memory>

#include "factors/segment/linearised_group.h"

namespace ceres {
class CostFunction;
}

namespace plumbline {

// The segments of a group as one cost function: residuals whose Gauss-Newton step, cost and
// gradient are those of the segments (CreateSegmentFactor) together, in as many rows as the
// group has unknowns, and one. With the group's cost c, gradient g and Gauss-Newton matrix
// H = R^T R at the parameters,
//   r = [ R^-T g | sqrt(2 c - |R^-T g|^2) ],   dr / d(tangent) = [ R | 0 ]
// so that |r|^2 / 2 = c, J^T r = g and J^T J = H (the square root of Bierman 1977,
// "Factorization Methods for Discrete Sequential Estimation"). Losses are part of the group.
// Where no Jacobian is asked for, r is the last row alone, which holds all of the cost.
//
// Blocks: [ rotations | positions ] of the group's control points, then its planes, which are
// constant where the group holds them. The group serves one thread at a time.
std::unique_ptr<ceres::CostFunction> CreateGroupFactor(std::shared_ptr<LinearisedGroup> group);

}  // namespace plumbline
