#pragma once

#include <cmath>

#include "core/geometry/angles.h"

namespace plumbline {

// The levels of the verdict's tests: each stands here once, whatever is tested with it.

// Shares of places, beams, points or seconds: of an exception, and of next to none.
inline constexpr double kExceptionShare = 0.1;
inline constexpr double kHardlyAnyShare = 0.05;
// Least number of places whose share is known, and of segments or differences whose mean is.
inline constexpr int kMinComparable = 40;
inline constexpr int kMinAveraged = 30;
// Least number of segments or tiles that show something together.
inline constexpr int kMinAgreeing = 3;
// Distance between two views of a surface within which they are one, m: walls are flat to
// that. In a right map it is some millimetres.
inline constexpr double kSameSurface = 0.03;
// Time over which accelerations are averaged and points are counted, s: those of a slip last
// as long, those of noise average out.
inline constexpr double kSlipTime = 0.125;
// Gap up to which seconds belong to one interval, s.
inline constexpr int kMaxGap = 3;
// Cosine of the angle up to which directions are one.
inline const double kSameDirection = std::cos(8.0 * kRadiansPerDegree);

}  // namespace plumbline
