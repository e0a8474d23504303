#pragma once

namespace plumbline {

// Standard deviations of a position, m, and of an angle, rad, of which nothing is known: no
// pose from one place of a building to another is known worse.
inline constexpr double kUnknownPosition = 10.0;
inline constexpr double kUnknownTurn = 1.0;

}  // namespace plumbline
