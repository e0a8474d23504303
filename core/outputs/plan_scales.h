#pragma once

namespace plumbline {

// The scales of a floor plan: each stands here once, whatever is measured with it.

// Least number of beams, or of columns of a face, that show something: one may be a stray.
inline constexpr int kMinBeams = 2;
// Shares of a stretch, or of its beams, from which a property is that of the whole, and up to
// which it is an exception.
inline constexpr double kMostly = 0.5;
inline constexpr double kHardly = 0.15;
// Cosines of the angles up to which walls are parallel (8 degrees), and surfaces are level
// rather than upright (26 degrees).
inline constexpr double kParallelCosine = 0.99;
inline constexpr double kLevelCosine = 0.9;
// Places that are nearer to each other than this are one, m; the side of a square of floor.
inline constexpr double kSameM = 0.1;
// Distance from a surface beyond which points do not lie on it, whatever their noise, m.
inline constexpr double kBesideM = 0.15;
// Stretches of a face that are shorter than this are pillars or posts, and no walls, m.
inline constexpr double kMinWallM = 0.3;
// Length from which a wall is one of a room's, and not the jamb of a window, and distance by
// which lines are drawn beyond what was seen, m.
inline constexpr double kLongWallM = 1.0;
// Largest thickness of a wall, m.
inline constexpr double kMaxThicknessM = 0.6;
// Least clear height of a room, and usual one where no ceiling was seen, m.
inline constexpr double kMinClearM = 1.8;
inline constexpr double kUsualClearM = 2.5;
// Largest clear height of a room and width of an opening, m.
inline constexpr double kMaxClearM = 8.0;
// Standard deviation of a jamb, m. Beams that hit the jamb's own side are taken for hits of
// the face where they end within its noise, and those at the face's end for none of it.
inline constexpr double kJambStddevM = 0.015;

}  // namespace plumbline
