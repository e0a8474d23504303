#pragma once

#include <string>

#include "core/segmentation/segmentation.h"

namespace plumbline {

// The mapper's options, with their defaults; numbers in square brackets are allowed ranges.
// The YAML names are those of the fields (core/options/config.cc).

struct TrajectoryOptions {
  // Knot interval of the spline: the larger of the two, so that slow scanners still determine
  // every control point.
  double knot_interval_s = 0.05;    // [0.01, 10]
  double min_scans_per_knot = 0.5;  // [0.1, 100], in periods of a scanner
  // Accelerations that the motion prior expects of any rig (core/trajectory/motion_noise.h):
  // the amplitude spectral densities of its accelerations at low frequencies, per square root
  // of 1 Hz, and the time over which these are correlated by exp(-1); 0: white noise.
  double acceleration_density_m_s2 = 0.7;             // [0.0001, 1000]
  double angular_acceleration_density_deg_s2 = 35.0;  // [0.001, 100000]
  double acceleration_correlation_s = 0.3;            // [0, 10]
  // The time over which vertical velocities are correlated so, instead of accelerations.
  double vertical_velocity_correlation_s = 0.1;  // [0.01, 1000]
  // Whether the recording's own densities are estimated and used instead.
  bool estimate_densities = true;
  // Largest density of horizontal accelerations where the motion alone bridges a moment in
  // which nothing trustworthy shows how far the rig goes. [0.0001, 1000]
  double bridging_acceleration_density_m_s2 = 0.18;
  // Standard deviations of the unknown velocity at the start.
  double initial_speed_stddev_m_s = 2.0;         // [0.001, 100]
  double initial_turn_rate_stddev_deg_s = 60.0;  // [0.01, 10000]
};

struct AssociationOptions {
  // Probability with which each test refuses a segment that lies on the plane. [1e-12, 0.5]
  double significance = 1e-4;
  // A segment may lie on a plane this far, m, from the part that has been seen. [0, 100]
  double max_gap_m = 1.0;
  // Standard deviation of real surfaces from their plane, added to every test. [0.0001, 1]
  double surface_flatness_m = 0.004;
  // Until the last estimation, a segment whose residuals' norm exceeds this many standard
  // deviations loses influence (Huber's loss). [1, 1000]
  double huber_width = 5.0;
};

struct PlaneOptions {
  // Least number of points of a segment that starts a plane, and the largest standard
  // deviation of its direction.
  int min_points = 8;                    // [3, 10000]
  double max_direction_sigma_deg = 3.0;  // [0.01, 90]
  // Number of scans that have to agree on a tentative plane before it is trusted. [1, 1000]
  int min_scans = 4;
  // A plane of which no more than small_m is seen, of a vertical one no more of its width, may
  // be of somebody who walks: where something has moved of late it is trusted from this age
  // on. [0, 1000] and [0, 1e6]
  double small_m = 1.0;
  double min_age_of_small_s = 0.5;
  // A tentative plane that is unseen for longer is dropped. [0, 1e6]
  double max_tentative_age_s = 1.0;
};

// OdometryOptions count where the rig file names a topic of odometry.
struct OdometryOptions {
  // Whether it holds the motion.
  bool enabled = true;
  // The prior of its noise, as shares of length and turn
  // (core/trajectory/odometry_calibration.h). [0.001, 10] each
  double length_noise = 0.1;
  double turn_noise = 0.1;
};

// Who solves: ceres::Solve on one residual block a group of segments (CreateGroupFactor), or
// our own Gauss-Newton on the same groups.
enum class SolverKind { kGaussNewton, kCeres };

struct WindowOptions {
  // The solver of the window and of the tracker.
  SolverKind solver = SolverKind::kCeres;
  // Number of scans that are estimated together; older ones are marginalised. [2, 10000]
  int num_scans = 10;
  // The window moves on by this time, in whole knot intervals, while the tracker alone follows
  // the rig well, and by half of it otherwise. [0.001, 100]
  double step_s = 0.25;
  // Whether segments are cut anew where the known planes meet.
  bool resegment = true;
  // Whether the result keeps the window's estimates of poses and planes, as they were known
  // during the recording.
  bool keep_estimates = false;
};

struct TrackingOptions {
  // The map begins with a scan that shows the model frame, within this time of the recording's
  // start. [0, 1e6]
  double max_start_search_s = 5.0;
  // The rig is lost where the planes in view leave its pose open by these standard deviations
  // for longer than max_gap_s; of the position the worst direction does not count. [0.001,
  // 100] and [0.01, 180]
  double lost_position_m = 0.5;
  double lost_rotation_deg = 10.0;
  // Longest time for which no planes are founded while walls leave the position open: what is
  // seen may move. [0, 1000]
  double max_undecided_s = 2.0;
  // Parts followed for less than this before the rig was lost are left out. [0, 1e6]
  double min_part_s = 2.0;
};

// Points that lie on no plane: furniture, jambs, people.
struct PointOptions {
  // Whether they hold the rig's pose, by where they lie in a local map of all points.
  bool hold_pose = true;
  // Side of the local map's cells. [0.02, 10]
  double cell_m = 0.25;
  // Standard deviation of the surface of a cell, the same for all beams that meet it:
  // unevenness, and errors of the poses that made the map. [0.0005, 1]
  double surface_stddev_m = 0.02;
  // Age from which a cell counts. [0, 1000]
  double min_age_s = 0.5;
  // Whether points are left out that lie where beams passed before: people, doors.
  bool leave_out_moving = true;
  // The local map forgets what was unseen for longer. [0.1, 1e6]
  double max_age_s = 20.0;
};

// Rules that were made for cases, each of which can be left out to ask whether it still pays
// (scripts/analysis/ablation.py, which names the cases). All are on by default.
struct RuleOptions {
  // While walls leave the position open, a second follower goes on by the motion alone.
  bool second_hypothesis = true;
  // Few short segments do not move the pose by much against the prediction.
  bool thin_evidence = true;
  // Where a scan lies well in the local map and the planes would have it elsewhere, the local
  // map holds it.
  bool points_over_planes = true;
  // The window is solved twice as often where segments hardly find their planes.
  bool half_window_steps = true;
  // Several scans are tried as the map's first.
  bool several_starts = true;
  // Beams that pass behind a wall are taken from its segments while the rig is followed.
  bool beams_behind_walls = true;
  // What the batch takes for no planes: those that repeat another, those that beams pass
  // through, and oblique ones across corners.
  bool redundant_planes = true;
  bool passed_through_planes = true;
  bool oblique_planes = true;
  // What the batch takes for cylinders: walls whose segments bend, rows of narrow walls.
  bool bent_walls = true;
  bool rows_of_chords = true;
};

struct LoopClosureOptions {
  // Whether planes are recognised when they come back into view after any time.
  bool enabled = true;
  // A plane unseen for more scans than this is a new one while recognition is off.
  // [1, 2^31 - 1]
  int max_gap_scans = 100;
};

// kSegment has one cost function a segment, kPoint one a beam: slow, for comparison.
enum class FactorKind { kSegment, kPoint };

// Whether covariances allow for errors that repeat from scan to scan, such as uneven surfaces
// and scanners that are biased or mounted otherwise than the rig file says: kEstimated takes
// their sizes from the residuals, kOff takes all errors as independent.
enum class CorrelatedErrorsKind { kOff, kEstimated };

struct BatchOptions {
  // The solver of the final estimation; the rounds before it are our own single steps.
  SolverKind solver = SolverKind::kCeres;
  FactorKind factor = FactorKind::kSegment;
  // Largest number of rounds of estimation and renewed association. [1, 1000]
  int max_rounds = 6;
  // Whether segments are cut anew where the estimated planes meet.
  bool resegment = true;
  CorrelatedErrorsKind correlated_errors = CorrelatedErrorsKind::kEstimated;
};

struct MapperOptions {
  TrajectoryOptions trajectory;
  SegmentationOptions segmentation;
  AssociationOptions association;
  PlaneOptions planes;
  TrackingOptions tracking;
  WindowOptions window;
  PointOptions points;
  RuleOptions rules;
  OdometryOptions odometry;
  LoopClosureOptions loop_closure;
  BatchOptions batch;
  // The motion can not be bridged over a longer gap in all scanners: the map ends there.
  // `recording: max_gap_s` in YAML. [0.01, 1e6]
  double max_gap_s = 1.0;

  // The defaults for a rig. One that moves in the plane stands on wheels, which accelerate
  // less than hands; its scanners see furniture rather than floor and ceiling, and are slow.
  static MapperOptions DefaultsFor(bool planar);

  // Throws Error naming the first option whose value is outside its range. Options that were
  // read from a file have been checked, with the line.
  void Check() const;
};

}  // namespace plumbline
