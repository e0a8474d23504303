#pragma once

#include <string>

#include "core/outputs/floor_plan.h"

namespace plumbline {

// Common parts of the drawings of a plan, SVG and DXF.

// Drawn thickness of a wall of which only one face was seen, m.
inline constexpr double kDrawnThicknessM = 0.12;

// "21.73 m2" with as many digits as the standard deviation allows, and at most two.
std::string AreaText(const Room& room);
// The area's standard deviation with two digits, in square metres.
std::string AreaStddevText(const Room& room);
// "4.150 m", and its standard deviation in millimetres.
std::string DoorWidthText(double width_m);  // "0.92"
std::string LengthText(double length_m);
std::string StddevText(double stddev_m);

// "Map of office.bag, 2026-11-27: consistent. plumbline 0.1.0", as far as it is known, in
// ASCII.
std::string OriginText(const MapOrigin& origin);
// Returns the text across the drawing of a map that is not consistent; empty where it is, or
// where nothing is known.
std::string WarningText(const MapOrigin& origin);

// The four corners of a door's gap in the wall, from the first face to behind the second.
std::vector<Eigen::Vector2d> GapCorners(const PlanDoor& door);

}  // namespace plumbline
