#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "core/geometry/matrix_types.h"
#include "core/map/observation.h"
#include "core/map/observation_poses.h"
#include "core/map/rig_calibration.h"
#include "core/sensor/imu.h"
#include "core/sensor/moving_beams.h"
#include "core/sensor/odometry.h"
#include "core/sensor/rig.h"
#include "core/surface/landmark.h"
#include "core/trajectory/odometry_calibration.h"
#include "core/trajectory/pose_constraint.h"
#include "core/trajectory/trajectory.h"

namespace plumbline {

// A stretch of time within the trajectory in which nothing was mapped: what the trajectory
// says there is a guess.
struct MapGap {
  int64_t start_ns = 0;
  int64_t end_ns = 0;  // exclusive
  std::string reason;  // in words
};

// Everything the mapper estimates, in one place; tracker, window and batch work on it.
struct MapState {
  Trajectory trajectory;
  std::deque<Landmark> landmarks;        // position = id; merged ones stay, without segments
  std::deque<Observation> observations;  // by time
  int64_t origin_time_ns = 0;            // instant whose position is the model frame's origin
  // Sub-minimum segments: beams on a plane that no segment on it has, too few for a segment of
  // their own or parts of one on no plane (core/visibility/resegmentation.h). Each has its
  // landmark; they are ordered by scan line and beam.
  std::deque<Observation> sub_minimum_segments = {};
  // Beams that met something that moves, by scan line and beam.
  std::deque<MovingBeams> moving_beams = {};
  // Constraints on the poses by points on no plane, by time.
  std::deque<PoseConstraint> pose_constraints = {};
  std::vector<MapGap> gaps = {};  // by time
  // Odometry and its calibration; nullptr: there is none.
  std::shared_ptr<const Odometry> odometry = nullptr;
  OdometryCalibration odometry_calibration = {};
  // Readings of the IMU, whose parameters are in the calibration; nullptr: there is none.
  std::shared_ptr<const ImuReadings> imu = nullptr;
  // The scanners, where they are estimated, and the IMU.
  RigCalibration calibration = {};

  // Whether the trajectory covers the instant, and it lies in no gap.
  bool IsMapped(int64_t time_ns) const;
};

// The covariance that the scanner of an observation adds to that of the body's pose at the
// observation's middle (world-frame rotation and position): what its estimate may be off, as
// if the body were off; zero where the scanner is not estimated.
Matrix6d ScannerCovariance(const Rig& rig,
                           const MapState& state,
                           const Observation& observation);

// Takes an observation into its landmark's extent, times and counts. Observations come in
// the order of time, or near it.
void CountObservation(const Observation& observation,
                      const ObservationPoses& poses,
                      MapState* state);

// Computes extents, times and counts of all landmarks anew from the associations as they
// stand. An extent gets axes on the plane as it is estimated now.
void RebuildLandmarks(const Rig& rig, MapState* state);
// Computes them anew for the chosen landmarks alone (is_chosen: by id).
void RebuildLandmarks(const Rig& rig, const std::vector<bool>& is_chosen, MapState* state);

// Computes the numbers of the landmarks' segments anew, and nothing else.
void RecountSegments(MapState* state);

// Where the wall that fixes the gauge has lost all of its observations, fixes the heading of
// the wall with most of them in its place.
void KeepHeadingHeld(MapState* state);

// Leaves the observations of the chosen landmarks (is_chosen: by id) without a landmark,
// removes their sub-minimum segments, and leaves these landmarks empty; returns how many
// observations. The wall that fixes the gauge keeps its own: without it nothing would
// determine the heading.
int ReleaseObservations(const std::vector<bool>& is_chosen, MapState* state);

}  // namespace plumbline
