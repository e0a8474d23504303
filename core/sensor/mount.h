#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/rigid3.h"

namespace plumbline {

// MountAngle is the angle of a mount at an instant, with its derivatives by time.
struct MountAngle {
  double angle_rad = 0.0;
  double rate_rad_s = 0.0;
  double acceleration_rad_s2 = 0.0;
};

// JointSample is the angle of a joint as it was read at an instant.
struct JointSample {
  int64_t time_ns = 0;
  double angle_rad = 0.0;
};

// JointAngles holds the recorded angles of a joint by time. Between two of them the angle is
// the cubic whose rates at both are those of the parabolas through their neighbours: of a
// swing of 30 degrees at 1 Hz that is read at 50 Hz it is off by less than 0.001 degrees.
class JointAngles {
 public:
  // Takes the samples in any order; of several of one instant it keeps the first one. Angles
  // that are not finite are left out; a jump by more than half a turn is taken as one by less.
  explicit JointAngles(std::vector<JointSample> samples);

  bool empty() const { return samples_.empty(); }
  size_t size() const { return samples_.size(); }
  // The angle at an instant; beyond the ends it goes on at the last rate.
  MountAngle At(int64_t time_ns) const;
  // Whether readings tell the angle at an instant: it lies between two that follow each other
  // as closely as readings do as a rule.
  bool Covers(int64_t time_ns) const;
  double longest_gap_s() const { return longest_gap_s_; }
  // Why the readings can not be the angle of a mount that turns, in words; empty: they can.
  std::string Fault() const;

 private:
  std::vector<JointSample> samples_;
  std::vector<double> rates_rad_s_;  // at the samples
  double longest_gap_s_ = 0.0;
  double max_step_s_ = 0.0;  // farther apart readings do not tell the angle between them
};

// Standard deviations of what a rig file states of a mount; 0: known exactly.
struct MountUncertainty {
  double zero_rad = 0.0;  // zero_deg in the file
  double time_s = 0.0;
  double rate = 0.0;      // share of the rate or of a swing's frequency
  double axis_rad = 0.0;  // axis_deg in the file; of each of its two tilts
  double point_m = 0.0;   // across the axis, in each direction
};

// A swing as it is stated: amplitude * sin(2 pi t / period + phase).
struct Swing {
  double amplitude_rad = 0.0;
  double period_s = 1.0;
  double phase_rad = 0.0;
};

// Mount is what turns a scanner about an axis of the rig. Its angle comes from a topic, or
// else from what drives it: a constant rate or a swing, counted from the first scan line.
struct Mount {
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  // of unit length, body frame
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  // on the axis, body frame, m
  std::string joint_topic;  // of sensor_msgs/JointState or std_msgs/Float64; empty: none
  std::string joint;        // name in the JointState; empty: its first
  double rate_rad_s = 0.0;  // rate_deg_s in the file
  std::optional<Swing> swing;
  double zero_rad = 0.0;  // of the mount where the stated angle is 0; zero_deg in the file
  // Time of an angle = its stamp + time_offset.
  double time_offset_s = 0.0;
  MountUncertainty uncertainty;

  // Estimated delay of the angles after their times, and estimated share by which the drive
  // is faster than stated. Zero, axis and point are replaced where they are estimated.
  double delay_s = 0.0;
  double rate_excess = 0.0;

  // Of the recording; without angles the topic's are unknown, and the angle is zero_rad.
  int64_t start_ns = 0;                       // stamp of the first scan line
  std::shared_ptr<const JointAngles> angles;  // their times include the time offset

  // Whether the angle comes from a topic.
  bool IsRead() const { return !joint_topic.empty(); }
  double SinceStart(int64_t time_ns) const;
  // The instant, in seconds after the given one, at which the stated angle is the one at that
  // instant.
  double Earlier(int64_t time_ns) const { return rate_excess * SinceStart(time_ns) - delay_s; }
  // The stated angle at an instant and so many seconds later, without zero.
  MountAngle StatedAt(int64_t time_ns, double later_s) const;
  // The angle at an instant and so many seconds later, as it is estimated.
  double AngleAt(int64_t time_ns, double later_s) const;
  // The turn about the axis from angle zero to that at the instant.
  Rigid3d TurnAt(int64_t time_ns, double later_s) const;
  // The turn by an angle.
  Rigid3d TurnBy(double angle_rad) const;
};

}  // namespace plumbline
