#pragma once

#include <string>

#include "core/segmentation/segmentation.h"

namespace plumbline {

// Every setting of the mapper, with its default. ReadMapperOptions (core/options/config.h)
// knows the YAML names and the allowed ranges.

struct TrajectoryOptions {
  // Knot interval of the spline: the larger of the two, so that slow scanners still determine
  // every control point.
  double knot_interval_s = 0.125;
  double min_scans_per_knot = 1.5;
  // Weak motion prior on the control points' second differences (white acceleration). It only
  // matters where the scans leave a direction of motion open.
  double acceleration_stddev_m_s2 = 3.0;
  double angular_acceleration_stddev_deg_s2 = 600.0;
  // Prior on the unknown velocity at the start.
  double initial_speed_stddev_m_s = 2.0;
  double initial_turn_rate_stddev_deg_s = 60.0;
};

struct AssociationOptions {
  // Probability with which a segment of a plane is refused, of each test.
  double significance = 1e-4;
  // How far from what has been seen of a plane a segment may lie on it and still belong to it.
  double max_gap_m = 1.0;
  // Unevenness of real surfaces, added to every test's variance.
  double surface_flatness_m = 0.004;
};

struct PlaneOptions {
  int min_points = 8;                    // of a segment that starts a plane
  double max_direction_sigma_deg = 3.0;  // of a segment that starts a plane
  int min_scans = 4;                     // that must agree before a new plane is trusted
  double max_tentative_age_s = 1.0;      // a candidate not seen for so long is dropped
};

// Who solves: our Gauss-Newton, or ceres::Solve on one residual block a segment.
enum class SolverKind { kGaussNewton, kCeres };

struct WindowOptions {
  SolverKind solver = SolverKind::kGaussNewton;  // of the window and the tracker
  int num_scans = 10;  // estimated together; what is older is marginalised
  // While the tracker alone follows the rig well; else one.
  int knot_intervals_per_step = 2;
  bool resegment = true;  // cut segments where the planes known so far meet
  // Whether what it states, pose by pose, is kept for the result: what one knows on the way.
  bool keep_estimates = false;
};

struct LoopClosureOptions {
  bool enabled = true;
  int max_gap_scans = 100;  // when disabled: a plane unseen for longer is not taken up again
};

enum class FactorKind { kSegment, kPoint };

struct BatchOptions {
  SolverKind solver = SolverKind::kGaussNewton;
  FactorKind factor =
      FactorKind::kSegment;  // kPoint: one residual per beam, slow; for comparison
  int max_rounds = 6;        // of estimation and renewed association
  bool resegment = true;     // cut segments anew where the estimated planes meet
};

struct MapperOptions {
  TrajectoryOptions trajectory;
  SegmentationOptions segmentation;
  AssociationOptions association;
  PlaneOptions planes;
  WindowOptions window;
  LoopClosureOptions loop_closure;
  BatchOptions batch;
  // Gap in all scanners beyond which the motion can not be bridged: the map ends there.
  double max_gap_s = 1.0;
};

}  // namespace plumbline
