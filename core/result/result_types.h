#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/rigid3.h"

namespace plumbline {

// The mapper hands these on as plain data, to the writers and to whoever evaluates them.

// StampedPose is one line of trajectory.tum.
struct StampedPose {
  int64_t time_ns = 0;
  Rigid3d world_from_body;
};

// StampedCovariance is one line of trajectory_covariance.csv.
struct StampedCovariance {
  int64_t time_ns = 0;
  // Position (m) and rotation (rad, world frame) of the body.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
};

enum class PlaneType { kHorizontal, kVertical, kGeneral, kCylinder };

// What files state of the planes of one type.
struct PlaneTypeFields {
  std::string name;
  std::vector<std::string> parameters;  // see PlaneCovariance
  int num_turns;                        // of the normal, the first ones of the parameters
  bool has_radius;                      // stated with its axis and standard deviation
};
const PlaneTypeFields& FieldsOf(PlaneType type);

// PlanePatch is a plane n.x = d in the world (model) frame with the outline of its part that
// was seen. The normal points to the side that was seen. Of an upright cylinder, normal and
// distance are those of its tangent plane at the centre.
struct PlanePatch {
  int id = 0;
  PlaneType type = PlaneType::kVertical;
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double distance = 0.0;          // m
  double sigma_angle_rad = 0.0;   // of the normal; 0 where the type fixes it
  double sigma_distance_m = 0.0;  // along the normal, at the centre
  // Curvature of a cylinder, 1/m, negative if its axis lies on the side that was seen; else 0.
  double curvature = 0.0;
  double sigma_radius_m = 0.0;  // of a cylinder
  // Correlation of its radius with the turn of its normal at the centre, which a heading
  // shares.
  double radius_turn_correlation = 0.0;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  // Closed polygon, first corner not repeated. Of a cylinder its lower rim from one end to the
  // other, and its upper one back through as many corners.
  std::vector<Eigen::Vector3d> outline;
  int64_t num_points = 0;
  int num_segments = 0;
  int64_t first_time_ns = 0;
  int64_t last_time_ns = 0;

  bool IsCurved() const { return curvature != 0.0; }
  // Radius of a cylinder, and the point of its axis at the height of the centre.
  double Radius() const { return 1.0 / std::abs(curvature); }
  Eigen::Vector3d AxisPoint() const { return centre - normal / curvature; }
  // Area between the surface and its level chord of this length, m2: negative where the arc
  // stands out to the side that was seen, 0 of a plane.
  double AreaBehindChord(double chord_m) const;
  // The unit normal at a point on it.
  Eigen::Vector3d NormalAt(const Eigen::Vector3d& p_world) const;
  double SignedDistance(const Eigen::Vector3d& p_world) const;
};

// Verdict says how far a finished map may be trusted: it agrees with all that was measured;
// parts of it are in doubt; or measurements contradict it, and its stated standard deviations
// mean nothing.
enum class Verdict { kConsistent, kDoubtful, kContradictory };

std::string VerdictName(Verdict verdict);  // "consistent", "doubtful", "contradictory"

// A stretch of the recording whose poses are in doubt, and why, in words. Times in seconds
// since the recording's first scan line.
struct DoubtfulInterval {
  double start_s = 0.0;
  double end_s = 0.0;
  std::string reason;
};

// A stretch of the recording in which a second's measurements leave one direction of the
// position open.
struct DegenerateInterval {
  double start_s = 0.0;
  double end_s = 0.0;
  std::string direction;  // in words
  double stddev_m = 0.0;  // along it, from one second's measurements alone
};

// A stretch of the recording, within a map, in which nothing was mapped, and why, in words.
struct UnmappedInterval {
  double start_s = 0.0;  // since the recording's start
  double end_s = 0.0;
  std::string reason;
};

// Consistency is the judgement on a finished map (core/judging/consistency.h).
struct Consistency {
  Verdict verdict = Verdict::kConsistent;
  // Share of the places seen at several times whose sightings contradict each other.
  double contradicted_share = 0.0;
  std::vector<DoubtfulInterval> doubtful_intervals;
  std::vector<DegenerateInterval> degenerate_intervals;
  // End of a map that ends before the recording does, seconds since the recording's start.
  std::optional<double> ends_at_s;
};

// LoopClosure is one line of loop_closures.json: a surface that was seen again after an
// absence, and how its segments of then agree with those of before.
struct LoopClosure {
  int surface_a = 0;  // plane of before, and of this visit: the same where it was accepted
  int surface_b = 0;
  int64_t time_ns = 0;        // when the surface came back into view
  double difference_m = 0.0;  // of the mean deviations from the plane, this visit minus before
  double statistic = 0.0;     // difference squared over its variance
  double threshold = 0.0;
  double return_statistic = 0.0;  // sum over the surfaces that came back at about that time
  double return_threshold = 0.0;
  bool accepted = true;
};

// Pose of a part in the model frame of the longest one, seen from above:
// p_longest = R(yaw) p_part + (x, y).
struct PlanPose {
  double yaw_deg = 0.0;
  double x_m = 0.0;
  double y_m = 0.0;
  double matched_m = 0.0;  // length of the walls that match
};

// PartSummary is one part of a recording that could not be mapped in one piece.
struct PartSummary {
  std::string folder;    // of its result, relative to that of the summary
  double start_s = 0.0;  // since the recording's start
  double end_s = 0.0;
  int scans = 0;
  int planes = 0;
  Verdict verdict = Verdict::kConsistent;
  std::optional<PlanPose> pose;  // where its walls match those of the longest part
};

// Relation of the wheels' motion to the map: true over stated lengths and turns with standard
// deviations, and the noise that is left, as shares of both.
struct OdometrySummary {
  double length_scale = 1.0;
  double length_scale_stddev = 0.0;
  double turn_scale = 1.0;
  double turn_scale_stddev = 0.0;
  double length_noise = 0.0;
  double turn_noise = 0.0;
  int motions = 0;  // from which this is known
};

// The noise of ranges from one distance or angle of incidence to another.
struct NoiseBin {
  double from = 0.0;
  double to = 0.0;
  double noise_m = 0.0;
};

// Standard deviation of a scanner's ranges: as the rig file states it, and as its beams
// scatter about the map's surfaces. Bins are those with enough beams.
struct ScannerNoise {
  std::string scanner;
  double stated_m = 0.0;
  std::optional<double> noise_m;       // nullopt: too few beams
  std::vector<NoiseBin> by_range;      // m
  std::vector<NoiseBin> by_incidence;  // degrees from the surface's normal
};

// Cause is what most likely went wrong with a map that is not consistent.
struct Cause {
  std::string name;       // in a few words
  std::string scanner;    // by its name, where it is one scanner's; else empty
  std::string evidence;   // what speaks for it, a sentence
  std::string next_step;  // what to do about it, a sentence
};

// One number of a scanner's calibration: what it is off the rig file by.
struct CalibratedParameter {
  std::string name;   // with its unit
  std::string words;  // the same for people
  double value = 0.0;
  double sigma = 0.0;
  double prior_sigma = 0.0;  // of the rig file's statement
  double prior_value = 0.0;  // where the estimation began, as the prior's mean

  // Whether it is the body's by definition, and so is known.
  bool IsHeld() const { return prior_sigma == 0.0; }
};

struct CalibratedScanner {
  // Index of its first parameter.
  enum At { kTurn = 0, kShift = 3, kTime = 6, kRange = 7, kScale = 8 };

  std::string name;
  // Turns about the body's x, y and z axes, shifts along them, the clock, bias and scale of
  // the ranges.
  std::vector<CalibratedParameter> parameters;
};

// The biases of an IMU at an instant, with standard deviations, along its axes.
struct BiasesAt {
  int64_t time_ns = 0;
  Eigen::Vector3d gyroscope_deg_s;
  Eigen::Vector3d gyroscope_sigma_deg_s;
  Eigen::Vector3d accelerometer_m_s2;
  Eigen::Vector3d accelerometer_sigma_m_s2;
};

struct CalibratedImu {
  // Turns about the body's axes, shifts along them, the clock, scales of the IMU's axes, and
  // the lean of gravity in the map.
  std::vector<CalibratedParameter> parameters;
  std::vector<BiasesAt> biases;  // by time; linear between
};

// The estimated scanners, and the IMU.
struct Calibration {
  std::vector<CalibratedScanner> scanners;
  Eigen::MatrixXd covariance;  // of all their parameters that are not held, in their units

  std::optional<CalibratedImu> imu;

  bool empty() const { return scanners.empty() && !imu; }
};

// Summary holds the figures of summary.json.
struct Summary {
  std::string recording;              // file name, without its directory
  std::string version;                // of the program that made the map
  int64_t start_time_ns = 0;          // of the recording's first scan line
  std::vector<std::string> scanners;  // names, in the order in which points number them
  int scans = 0;
  int64_t points = 0;         // valid ranges in the recording
  int64_t points_used = 0;    // points on segments of planes in the final estimate
  int64_t points_moving = 0;  // on things that were seen to move
  int segments = 0;
  int planes = 0;
  int control_points = 0;
  double residual_rms_m = 0.0;  // root mean square distance of the points from their planes
  double variance_factor = 0.0;
  double duration_s = 0.0;                             // of the recording
  std::vector<std::pair<std::string, double>> stages;  // name, seconds; in order
  double real_time_factor = 0.0;
  double peak_memory_mb = 0.0;
  // Figures of how well the unknowns are determined: a description, and a number.
  std::vector<std::pair<std::string, double>> largest_correlations;  // between planes
  std::vector<std::pair<std::string, double>> weakest_directions;    // smallest eigenvalues
  std::string motion;                                                // "spatial" or "planar"
  // Amplitude spectral densities of the recording's accelerations, which the final estimate
  // assumes: name with its unit (per square root of 1 Hz), and the value.
  std::vector<std::pair<std::string, double>> motion_noise;
  std::vector<ScannerNoise> range_noise;
  std::optional<OdometrySummary> odometry;
  int reference_plane_id = -1;  // the wall whose normal is the x axis of the model frame
  Calibration calibration;      // stands in calibration.json
  Consistency consistency;
  std::optional<Cause> cause;          // none of a consistent map
  std::vector<UnmappedInterval> gaps;  // between parts that were joined, in the order of time
  std::vector<PartSummary> parts;      // in the order of time; empty where there is one only
  std::vector<std::string> warnings;
};

}  // namespace plumbline
