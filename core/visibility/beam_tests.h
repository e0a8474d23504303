#pragma once

#include "core/map/patch_extent.h"

namespace plumbline {

// Limits of the tests whether a beam lies on a plane, in standard deviations of a range.

// Standard deviations beyond which one beam tells two surfaces apart, whatever its noise.
inline constexpr double kFarSigmas = 9.0;
// Standard deviations within which a beam may lie on a plane: hardly one of a plane's beams is
// farther off.
inline constexpr double kOutlierSigmas = 5.0;
// Standard deviations within which a beam lies that only its range puts on a plane, on both
// sides of it: the noise of those that are kept has mean zero, and few beams on something
// close behind are among them.
inline constexpr double kStrictSigmas = 3.0;

// Distance from the seen part of a plane within which it bounds or hides what is there: seen
// parts are known by cells.
inline constexpr double kSeenReach = PatchExtent::kCellSize;  // m

}  // namespace plumbline
