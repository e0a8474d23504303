#pragma once

#include "core/map/patch_extent.h"

namespace plumbline {

// Limits of the tests whether a beam lies on a plane, in standard deviations of a range.

// Beyond so many, one beam tells two surfaces apart, whatever its noise.
inline constexpr double kFarSigmas = 9.0;
// A beam within so many may lie on a plane: of a plane's beams hardly one is farther off.
inline constexpr double kOutlierSigmas = 5.0;
// A beam that nothing but its range puts on a plane lies within so many on both sides: the
// noise of those that are kept has mean zero, and few beams on something close behind are
// among them.
inline constexpr double kStrictSigmas = 3.0;

// The seen part of a plane has to come so near to a point to bound or to hide what is there:
// seen parts are known by cells.
inline constexpr double kSeenReach = PatchExtent::kCellSize;  // m

}  // namespace plumbline
