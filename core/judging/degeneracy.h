#pragma once

#include <string>
#include <vector>

#include "core/geometry/matrix_types.h"
#include "core/map/map_state.h"
#include "core/result/result_types.h"
#include "core/sensor/rig.h"
#include "core/surface/landmark_view.h"

namespace plumbline {

// Standard deviation, in metres, with which a segment on a plane shows the body's distance
// from the plane, rotation and plane being known. 0 where the segment states none.
double DistanceStddev(const Observation& observation,
                      const ObservationPoses& poses,
                      const LandmarkView& plane);

// Walls are wider than this, floors and ceilings both ways, m. Treads and whoever walks are
// not.
inline constexpr double kMaxNarrow = 1.0;
bool IsWide(const Landmark& landmark);

// Adds the information of a segment on its plane on the body's pose at the segment: rotation
// (world frame, about the body's place, 1/rad^2) and position (1/m^2).
void AddInformation(const Observation& observation,
                    const ObservationPoses& poses,
                    const LandmarkView& surface,
                    Matrix6d* information);

// PositionStrength says how well one second's segments determine the rig's position, with the
// planes taken as known, no motion assumed, and the rotation estimated as well.
struct PositionStrength {
  int num_segments = 0;
  double stddev_m = 0.0;                                      // along the weakest direction
  Eigen::Vector3d direction_world = Eigen::Vector3d::Zero();  // unit vector, either sense
};

// One element for each second of the map. In planar motion heights do not count.
std::vector<PositionStrength> StrengthOverTime(const Rig& rig,
                                               bool planar,
                                               const MapState& state,
                                               int64_t start_ns);

// A direction in words: "vertical", or "horizontal, 35 deg from the x axis" of the model
// frame.
std::string DirectionInWords(const Eigen::Vector3d& direction_world);

// The stretches in which a direction is not determined. Intervals of the same direction, less
// than some seconds apart, are one.
std::vector<DegenerateInterval> DegenerateIntervals(
    const std::vector<PositionStrength>& strengths);

}  // namespace plumbline
