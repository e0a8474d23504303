#pragma once

#include "core/geometry/angles.h"

namespace plumbline {

// The levels of the check's tests: each stands here once, whatever is tested with it.

// Shares of beams, lines, places or lengths: of nearly all, of some, of next to none.
inline constexpr double kMost = 0.7;
inline constexpr double kSome = 0.1;
inline constexpr double kHardlyAny = 0.02;
// Least number of steps, turns or lines that show something at all, and of places, lines or
// beams whose shares are known.
inline constexpr int kMinSteps = 3;
inline constexpr int kMinPlaces = 20;
// Number of scan lines of each pair of scanners whose views are compared.
inline constexpr int kComparedLines = 1500;
// Places that two scanners see nearer to each other than this are one, m: what scan lines of
// good scanners show of a surface. Scanners that sit as stated agree to kAgreed, m.
inline constexpr double kOnePlace = 0.015;
inline constexpr double kAgreed = 0.1;
// Distance of a surface that stands for what a scanner sees in a building, m: a turn of 1 rad
// moves the places there by as much.
inline constexpr double kLever = 3.5;
// Change of a range beyond which it is of another surface, m.
inline constexpr double kOtherSurface = 0.3;
// Length of a trace of a wall that shows its direction, m.
inline constexpr double kMinTrace = 0.4;
// Angle up to which scan planes are parallel, and traces level.
inline constexpr double kParallelAngle = 10.0 * kRadiansPerDegree;
// Time between scan lines that are compared for a rig's motion, s, and least rate at which a
// rig turns that is said to turn, rad/s.
inline constexpr double kMotionStep = 0.5;
inline constexpr double kMinTurnRate = 16.0 * kRadiansPerDegree;
// Least noise of a range, m: walls and mountings are hardly better.
inline constexpr double kMinNoise = 0.01;
// Number of spans, sectors or frames that a sentence names.
inline constexpr int kMaxNamed = 6;

}  // namespace plumbline
