#pragma once

namespace plumbline {

// What two visits, or two parts of a recording, see as one.

// Largest distance and angle (5 degrees) between surfaces that are one, and gap along them, m:
// the accuracy of places seen again, and of poses matched from above.
inline constexpr double kSameSurfaceDistance = 0.15;
inline constexpr double kSameNormalCosine = 0.996;
inline constexpr double kSameSurfaceGap = 0.5;
// Time within which what is seen belongs to one visit, s.
inline constexpr double kVisitTime = 5.0;

}  // namespace plumbline
