#pragma once

#include <Eigen/Core>
#include <optional>

#include "core/association/plane_through_lines.h"
#include "core/geometry/angles.h"
#include "core/surface/landmark.h"

namespace plumbline {

// A plane's kind is open while its normal is not known to this, rad.
inline constexpr double kDecidedSigma = 1.0 * kRadiansPerDegree;

// The landmark of the kind that the fit leaves, facing the side of `seen_from_world`: vertical
// or horizontal while the fit does not contradict it, since so are most surfaces of buildings,
// otherwise general. Nothing while the kind is open.
std::optional<Landmark> DecideKind(const PlaneThroughLines::Fit& fit,
                                   const Eigen::Vector3d& seen_from_world);

}  // namespace plumbline
