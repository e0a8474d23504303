#include "simulation/sensing/recording_writer.h"

#include <glog/logging.h>
#include <nav_msgs/Odometry.h>
#include <rosbag/bag.h>
#include <sensor_msgs/Imu.h>
#include <sensor_msgs/JointState.h>
#include <sensor_msgs/LaserScan.h>

#include <cmath>
#include <exception>
#include <memory>
#include <utility>

#include "core/util/atomic_file.h"
#include "core/util/error.h"

namespace plumbline {

namespace {

// Takes a bag that can not be closed, for want of space: its destructor would try again,
// throw, and so end the program. The list keeps it reachable.
void Abandon(std::unique_ptr<rosbag::Bag> bag) {
  static auto* abandoned = new std::vector<rosbag::Bag*>();
  abandoned->push_back(bag.release());
}

}  // namespace

struct RecordingWriter::Impl {
  Impl(const std::string& path, const Rig& rig)
      : rig(rig), file(path), sequence(rig.scanners.size(), 0) {}

  Rig rig;
  AtomicFile file;
  std::unique_ptr<rosbag::Bag> bag;
  std::vector<uint32_t> sequence;  // by scanner: number of its next message
  sensor_msgs::LaserScan message;
  nav_msgs::Odometry odometry;
  sensor_msgs::Imu imu;
  sensor_msgs::JointState joints;

  [[noreturn]] void Fail(const std::exception& exception) {
    throw Error(file.path() + ": can not be written: " + exception.what());
  }
};

RecordingWriter::RecordingWriter(const std::string& path, const Rig& rig)
    : impl_(std::make_unique<Impl>(path, rig)) {
  console_bridge::setLogLevel(console_bridge::CONSOLE_BRIDGE_LOG_NONE);
  impl_->bag = std::make_unique<rosbag::Bag>();
  try {
    impl_->bag->open(impl_->file.temporary_path(), rosbag::bagmode::Write);
    impl_->bag->setCompression(rosbag::compression::Uncompressed);
  } catch (const std::exception& exception) {
    impl_->Fail(exception);
  }
}

RecordingWriter::~RecordingWriter() {
  if (impl_->bag == nullptr) return;
  try {
    impl_->bag->close();
  } catch (const std::exception&) {
    Abandon(std::move(impl_->bag));
  }
}

void RecordingWriter::Write(const ScanLine& scan_line) {
  CHECK(impl_->bag != nullptr) << "Write() after Close()";
  CHECK_GT(scan_line.stamp_ns, 0) << "ROS stamps begin after 0";
  const size_t scanner_index = static_cast<size_t>(scan_line.scanner_index);
  CHECK_LT(scanner_index, impl_->rig.scanners.size());
  const Scanner& scanner = impl_->rig.scanners[scanner_index];

  sensor_msgs::LaserScan& message = impl_->message;
  ros::Time stamp;
  stamp.fromNSec(static_cast<uint64_t>(scan_line.stamp_ns));
  message.header.seq = impl_->sequence[scanner_index]++;
  message.header.stamp = stamp;
  message.header.frame_id = scanner.name;
  message.angle_min = static_cast<float>(scan_line.angle_min);
  message.angle_max = static_cast<float>(scan_line.BeamAngle(scan_line.num_beams() - 1));
  message.angle_increment = static_cast<float>(scan_line.angle_increment);
  message.time_increment = static_cast<float>(scan_line.time_increment_s);
  message.scan_time = static_cast<float>(1.0 / scanner.scan_rate_hz);
  message.range_min = static_cast<float>(scanner.min_range_m);
  message.range_max = static_cast<float>(scanner.max_range_m);
  message.ranges.assign(scan_line.ranges.begin(), scan_line.ranges.end());
  try {
    impl_->bag->write(scanner.topic, stamp, message);
  } catch (const std::exception& exception) {
    impl_->Fail(exception);
  }
}

void RecordingWriter::Write(const OdometrySample& sample) {
  CHECK(impl_->bag != nullptr) << "Write() after Close()";
  CHECK_GT(sample.time_ns, 0) << "ROS stamps begin after 0";
  CHECK(!impl_->rig.odometry_topic.empty()) << "the rig has no odometry";
  nav_msgs::Odometry& message = impl_->odometry;
  ros::Time stamp;
  stamp.fromNSec(static_cast<uint64_t>(sample.time_ns));
  message.header.stamp = stamp;
  message.header.frame_id = "odom";
  message.child_frame_id = "base_link";
  message.pose.pose.position.x = sample.position.x();
  message.pose.pose.position.y = sample.position.y();
  message.pose.pose.orientation.z = std::sin(sample.heading / 2.0);
  message.pose.pose.orientation.w = std::cos(sample.heading / 2.0);
  try {
    impl_->bag->write(impl_->rig.odometry_topic, stamp, message);
  } catch (const std::exception& exception) {
    impl_->Fail(exception);
  }
  ++message.header.seq;
}

void RecordingWriter::Write(const ImuSample& sample) {
  CHECK(impl_->bag != nullptr) << "Write() after Close()";
  CHECK_GT(sample.time_ns, 0) << "ROS stamps begin after 0";
  CHECK(impl_->rig.imu) << "the rig has no IMU";
  sensor_msgs::Imu& message = impl_->imu;
  ros::Time stamp;
  stamp.fromNSec(static_cast<uint64_t>(sample.time_ns));
  message.header.stamp = stamp;
  message.header.frame_id = "imu";
  message.orientation_covariance[0] = -1.0;  // there is none
  message.angular_velocity.x = sample.angular_rate.x();
  message.angular_velocity.y = sample.angular_rate.y();
  message.angular_velocity.z = sample.angular_rate.z();
  message.linear_acceleration.x = sample.specific_force.x();
  message.linear_acceleration.y = sample.specific_force.y();
  message.linear_acceleration.z = sample.specific_force.z();
  try {
    impl_->bag->write(impl_->rig.imu->topic, stamp, message);
  } catch (const std::exception& exception) {
    impl_->Fail(exception);
  }
  ++message.header.seq;
}

void RecordingWriter::Write(const MountReading& reading) {
  CHECK(impl_->bag != nullptr) << "Write() after Close()";
  CHECK_GT(reading.stamp_ns, 0) << "ROS stamps begin after 0";
  const auto& mount = impl_->rig.scanners.at(reading.scanner).mount;
  CHECK(mount && mount->IsRead()) << "nothing tells the mount's angle";
  sensor_msgs::JointState& message = impl_->joints;
  ros::Time stamp;
  stamp.fromNSec(static_cast<uint64_t>(reading.stamp_ns));
  message.header.stamp = stamp;
  message.name.assign(1, mount->joint.empty() ? "mount" : mount->joint);
  message.position.assign(1, reading.angle_rad);
  try {
    impl_->bag->write(mount->joint_topic, stamp, message);
  } catch (const std::exception& exception) {
    impl_->Fail(exception);
  }
  ++message.header.seq;
}

void RecordingWriter::Close() {
  CHECK(impl_->bag != nullptr) << "Close() twice";
  try {
    impl_->bag->close();
  } catch (const std::exception& exception) {
    impl_->Fail(exception);
  }
  impl_->bag.reset();
  impl_->file.Commit();
}

}  // namespace plumbline
