#pragma once

#include "core/surface/patch_extent.h"

namespace plumbline {

// Limits of the tests whether a beam lies on a plane, in an opening of it or behind it.

// Standard deviations of a range beyond which one beam tells two surfaces apart, whatever its
// noise.
inline constexpr double kFarSigmas = 9.0;
// Distance from the seen part of a plane within which it bounds or hides what is there: seen
// parts are known by cells.
inline constexpr double kSeenReach = PatchExtent::kCellSize;  // m
// Distance beside beams, and beside the seen part of a plane, beyond which neither concerns
// the other, m: more than cells and bounds reach.
inline constexpr double kConcernReach = 1.0;
// Half of the thinnest wall, m: what lies farther behind a plane than this does not touch it.
inline constexpr double kMinDepth = 0.05;
// Width of the cells of openings, m; they are as long as the cells of patches.
inline constexpr double kOpeningCell = 0.02;
// Number of beams that are placed with one pose: a few milliseconds' worth.
inline constexpr int kBeamsPerPlacement = 32;

}  // namespace plumbline
