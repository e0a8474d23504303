#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/geometry/planar_pose.h"
#include "core/sensor/recording.h"
#include "core/sensor/rig.h"
#include "core/trajectory/trajectory.h"

namespace plumbline {

// Ends of the beams of one scan line, from above, in the world frame of the trajectory that it
// was placed by.
struct PlacedScan {
  int64_t time_ns = 0;
  double way_m = 0.0;  // of the rig, from the first scan line on
  Eigen::Vector2d scanner = Eigen::Vector2d::Zero();
  std::vector<Eigen::Vector2d> ends;  // m
};

// Reads the scan lines of a recording whose scan planes are level, and places them by a
// trajectory, in the order of time. Left out are scan lines outside of the trajectory and
// those that a scanner took from nearly the same pose as the one before; beams that go so far
// that an error of the heading moves their ends most; and strays. Throws Error as
// RecordingReader::Next() does.
std::vector<PlacedScan> PlaceScans(const Rig& rig,
                                   const Trajectory& trajectory,
                                   RecordingReader* recording);

// A visit is a stretch of the rig's way and what was seen along it, in the frame of the body
// in its middle, from above.
struct Visit {
  int64_t time_ns = 0;  // of the middle
  double way_m = 0.0;   // up to the middle
  PlanarPose world_from_visit;
  std::vector<Eigen::Vector2d> points;    // m, one of those that lie together
  std::vector<Eigen::Vector2d> scanners;  // m, from where each was seen
};

// Cuts the rig's way into visits that overlap: as long as a place takes to show more than the
// walls of a corridor, and short enough not to be bent by drift.
std::vector<Visit> CutIntoVisits(const std::vector<PlacedScan>& scans,
                                 const Trajectory& trajectory);

}  // namespace plumbline
