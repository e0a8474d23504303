#pragma once

#include <string>
#include <vector>

#include "core/result/plane_covariance.h"
#include "core/result/result_types.h"

namespace plumbline {

// The functions below make the text files of a result (docs/outputs.md). The same input gives
// the same bytes.

// Makes trajectory.tum, one line "t x y z qx qy qz qw" per pose; t in seconds with 9 decimals,
// exact to the nanosecond; unit quaternions with qw >= 0.
std::string FormatTrajectory(const std::vector<StampedPose>& poses);

// Makes trajectory_covariance.csv, a head line and one line per pose: t and the upper
// triangle, row by row, of the covariance of (px, py, pz, rx, ry, rz).
std::string FormatTrajectoryCovariance(const std::vector<StampedCovariance>& poses);

// Makes planes.json, a JSON array with one object per line; times in seconds with 9 decimals,
// exact to the nanosecond. Values that are not finite are written as null.
std::string FormatPlanes(const std::vector<PlanePatch>& planes);

// Makes planes.ply, the outlines as triangles of an ASCII PLY file: few programs read polygons
// with more corners. A patch with fewer than three corners is left out. Every plane has a colour
// of its own, which depends on its id only.
std::string FormatPlanePolygons(const std::vector<PlanePatch>& planes);

// Makes summary.json. The seconds of stages with the same name are added up.
std::string FormatSummary(const Summary& summary);

// Makes loop_closures.json, a JSON array with one object per line.
std::string FormatLoopClosures(const std::vector<LoopClosure>& closures);

// Makes plane_covariance.csv: a head line "plane,parameter,<id>:<parameter>,..." and one line
// for each parameter.
std::string FormatPlaneCovariance(const PlaneCovariance& covariance);

}  // namespace plumbline
