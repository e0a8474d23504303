#pragma once

#include <vector>

#include "core/map/map_state.h"
#include "core/options/mapper_options.h"
#include "core/registration/scan_matching.h"
#include "core/sensor/rig.h"

namespace plumbline {

// A wall of this width is no door and nobody who walks.
inline constexpr double kLongWall = 3.0;  // m
// A direction of the position is open where its standard deviation is larger: the next plane
// may then be a wrong one.
inline constexpr double kOpenStddev = 0.03;  // m

// How far a scan lies on planes, by its observations first .. last.

// The share of its points that are on no plane.
double ShareOnNoPlane(const MapState& state,
                      int first_observation,
                      int last_observation,
                      int num_points);

// Its beams that are on no plane, by scan line.
BeamMask BeamsOnNoPlane(const MapState& state,
                        int first_observation,
                        int last_observation,
                        const ScanMatcher& scan_matcher);

// Whether its walls, vertical planes and cylinders of at least this width, leave the rig's
// position open in some horizontal direction. flatness_m: standard deviation of real surfaces
// from their plane.
bool WallsLeaveOpen(const MapState& state,
                    int first_observation,
                    int last_observation,
                    double min_width_m,
                    double flatness_m);

// The same, or the heading: in a round room, the rig may turn about the axis.
bool WallsLeavePoseOpen(const Rig& rig,
                        const MapState& state,
                        int first_observation,
                        int last_observation,
                        double min_width_m,
                        double flatness_m);

// Whether its floors, ceilings and slopes leave the rig's height open, by a stricter measure.
bool HeightIsOpen(const MapState& state,
                  int first_observation,
                  int last_observation,
                  double flatness_m);

// Whether a landmark is a wall or slope of which less than this width was seen: it may be a
// door, or somebody who walks.
bool IsNarrowWall(const Landmark& landmark, double min_width_m);

// Its observations on such landmarks.
std::vector<int> OnNarrowPlanes(const MapState& state,
                                int first_observation,
                                int last_observation,
                                double min_width_m);

}  // namespace plumbline
