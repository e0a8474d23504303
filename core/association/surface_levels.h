#pragma once

namespace plumbline {

// The levels of the tests that tell surfaces apart: each stands here once, whatever is tested
// with it.

// Largest chi-square of what lies on one surface, over its degrees of freedom. Of several
// surfaces, of a corner that was taken for one line or of an oblique false plane it is larger:
// planes have 0.45 to 1.85, oblique false planes 2 to 9.
inline constexpr double kMaxMeanChi2 = 2.0;
// Standard deviations of a range within which a beam may lie on a surface: hardly one of a
// surface's beams is farther off.
inline constexpr double kOutlierSigmas = 5.0;
// Least sine of the angle at which a scan plane cuts a wall that its beams can hit. A scan
// plane that runs along a wall, as an upright one in a doorway, holds other surfaces'
// segments: all of them would lie on the wall.
inline constexpr double kMinCuttingSine = 0.1;
// Least sine for floors, ceilings and slopes, and for planes whose kind is open: where two of
// them meet at a flat angle, a trace that grazes both lies on either, and would tell the
// height to millimetres.
inline constexpr double kMinCuttingSineOfSlopes = 0.25;
// Least curvature of a cylinder, in its standard deviations, and its radii, m.
inline constexpr double kCurvatureSigmas = 6.0;
inline constexpr double kMinRadius = 0.15;
inline constexpr double kMaxRadius = 200.0;
// Width from which a surface shows whether it is level or bent, m. Narrower walls stay planes,
// or points.
inline constexpr double kShowingWidth = 1.0;
// Number of traces or chords that test a surface, two of which always agree.
inline constexpr int kMinWitnesses = 3;
// Number of segments that a surface is fitted to, spread over all that were seen of it.
inline constexpr int kFittedSegments = 60;

}  // namespace plumbline
