#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/rigid3.h"
#include "core/sensor/depth_camera.h"
#include "core/sensor/imu.h"
#include "core/sensor/mount.h"

namespace plumbline {

// Uncertainty of a scanner's stated pose, clock and ranges: standard deviations, of each axis;
// 0: known exactly.
struct ScannerUncertainty {
  double rotation_rad = 0.0;  // rotation_deg in the file
  double translation_m = 0.0;
  double time_s = 0.0;
  double range_m = 0.0;      // of range_bias_m
  double range_scale = 0.0;  // of range_scale
};

// Scanner describes one 2D laser scanner of the rig: where it sits, how well it measures. A
// row of a depth camera is one, too.
struct Scanner {
  std::string name;
  std::string topic;  // of its sensor_msgs/LaserScan messages, or of the camera's images
  Rigid3d body_from_scanner;    // at the angle zero of its mount, where it has one
  std::optional<Mount> mount;   // none: it does not move against the body
  std::optional<CameraRow> camera_row;  // none: it is a laser scanner
  // Standard deviation of one range, and what the square of the range adds, times this: the
  // errors of a triangulation. Both are independent of each other.
  double range_noise_m = 0.03;
  double range_noise_per_m2 = 0.0;
  // Whether the noise is to be taken from the recording; `range_noise_m: estimate` in the
  // file.
  bool estimates_noise = false;
  // Standard deviation of a beam's direction; angle_noise_deg in the file, 0.005 deg by
  // default.
  double angle_noise_rad = 0.005 * M_PI / 180.0;
  double min_range_m = 0.1;
  double max_range_m = 30.0;
  double time_offset_s = 0.0;  // beam time = stamp + index * time_increment + time_offset
  // range = (range of the message - range_bias) * range_scale
  double range_bias_m = 0.0;
  double range_scale = 1.0;
  // Estimated delay of the points after their beam times, and estimated excess of the ranges
  // as read, in metres and as a share of them. Measurements stay as they are.
  double delay_s = 0.0;
  double range_excess_m = 0.0;
  double range_excess_share = 0.0;
  // Uncertainty of pose, clock and ranges; a rig file that does not state it has that of a
  // pose measured by hand.
  ScannerUncertainty uncertainty;

  // Instead of what the messages say, where a driver leaves it at 0 or has it wrong
  // (core/sensor/scan_header.h). Of the last two, angle_min_deg and angle_increment_deg in the
  // file. A negative time increment says that beam 0 was taken last.
  std::optional<double> time_increment_s;
  std::optional<double> angle_min_rad;
  std::optional<double> angle_increment_rad;

  // The simulator alone needs these three; in a recording each message carries its own.
  int beams = 270;
  double field_of_view_deg = 270.0;
  double scan_rate_hz = 40.0;

  // The pose at a beam's instant, at its estimated delay after it.
  Rigid3d BodyFromScanner(int64_t time_ns) const {
    return mount ? mount->TurnAt(time_ns, delay_s) * body_from_scanner : body_from_scanner;
  }
  // Variance and standard deviation of the noise of a range, m^2 and m.
  double RangeVariance(double range_m) const {
    const double growth_m = range_noise_per_m2 * range_m * range_m;
    return range_noise_m * range_noise_m + growth_m * growth_m;
  }
  double RangeStddev(double range_m) const { return std::sqrt(RangeVariance(range_m)); }
  // The range without its estimated excess, m.
  double TrueRange(double range_m) const {
    return (range_m - range_excess_m) * (1.0 - range_excess_share);
  }
  bool IsValidRange(double range) const {
    return std::isfinite(range) && range >= min_range_m && range <= max_range_m;
  }
};

// The motion that the mapper estimates. kAutomatic: planar when every scan plane is horizontal
// in the body frame (height, roll and pitch can not be observed then), spatial otherwise.
enum class MotionModel { kAutomatic, kSpatial, kPlanar };

// Rig holds the scanners that move together, and how they can move.
struct Rig {
  MotionModel motion = MotionModel::kAutomatic;
  std::vector<Scanner> scanners;  // the rows of depth cameras are the last of them
  std::vector<DepthCamera> depth_cameras;
  // Topic of the nav_msgs/Odometry messages of the body; empty: there are none. Their time is
  // their stamp plus the offset; where it is not stated, the one at which wheels and scanners
  // turn together.
  std::string odometry_topic;
  std::optional<double> odometry_time_offset_s;
  std::optional<Imu> imu;  // none: the rig has no IMU
};

// Reads a rig file (docs/inputs.md). Throws Error with file and line.
Rig ReadRig(const std::string& path);

// Writes a rig file that ReadRig understands; the rows of depth cameras are left to their
// camera.
void WriteRig(const Rig& rig, const std::string& path);

// True when only planar motion is to be estimated: the rig file says so, or all scan planes
// are horizontal and see no heights.
bool IsPlanar(const Rig& rig);
// True when every scan plane is horizontal in the body frame to within tolerance_rad, at every
// angle of its mount.
bool AllScannersHorizontal(const Rig& rig, double tolerance_rad);

// The scanner whose pose and clock are the body's, one without a mount if there is one: the
// first that is known exactly, else of the steep ones the first; of a rig that moves in the
// plane the first.
size_t BodyScanner(const Rig& rig);
// The first scanner whose pose and clock are known exactly; nullopt: there is none.
std::optional<size_t> ExactlyPlacedScanner(const Rig& rig);
// Whether poses, clocks or ranges of a rig's scanners are to be estimated. A lone scanner has
// no other to be held against: its ranges would show only in how walls look at grazing
// incidence, where those of real scanners depend on the surface.
bool EstimatesScanners(const Rig& rig);

// Gives a depth camera's rows the places that they have in images of this model. Throws Error
// where these have fewer rows.
void PlaceRows(size_t camera, const PinholeModel& model, Rig* rig);
// The rig without the rows of its depth cameras.
Rig WithoutCameraRows(Rig rig);

// Returns the largest range noise of a rig's scanners, that at the end of their reach, m.
double MaxRangeNoise(const Rig& rig);

}  // namespace plumbline
