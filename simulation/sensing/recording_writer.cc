#include "simulation/sensing/recording_writer.h"

#include <glog/logging.h>
#include <nav_msgs/Odometry.h>
#include <rosbag/bag.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
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
      : rig(rig),
        file(path),
        sequence(rig.scanners.size(), 0),
        images(rig.depth_cameras.size()) {}

  Rig rig;
  AtomicFile file;
  std::unique_ptr<rosbag::Bag> bag;
  std::vector<uint32_t> sequence;  // by scanner: number of its next message
  sensor_msgs::LaserScan message;
  nav_msgs::Odometry odometry;
  sensor_msgs::Imu imu;
  sensor_msgs::JointState joints;
  std::vector<sensor_msgs::Image> images;  // by camera, of the rows that came last

  void WriteRow(const ScanLine& scan_line, const CameraRow& camera_row);
  void WriteImage(size_t camera);
  [[noreturn]] void Fail(const std::exception& exception) {
    throw Error(file.path() + ": can not be written: " + exception.what());
  }
};

// Rows of an image come one after the other, with the same stamp.
void RecordingWriter::Impl::WriteRow(const ScanLine& scan_line, const CameraRow& camera_row) {
  const auto& [camera, row] = camera_row;
  const PinholeModel& model = rig.depth_cameras[camera].model;
  sensor_msgs::Image& image = images[camera];
  ros::Time stamp;
  stamp.fromNSec(static_cast<uint64_t>(scan_line.stamp_ns));
  if (image.header.stamp != stamp) {
    WriteImage(camera);
    image.header.stamp = stamp;
    image.header.frame_id = rig.depth_cameras[camera].name;
    image.height = static_cast<uint32_t>(model.height);
    image.width = static_cast<uint32_t>(model.width);
    image.encoding = "16UC1";
    image.step = image.width * static_cast<uint32_t>(sizeof(uint16_t));
    image.data.assign(size_t{image.step} * image.height, 0);  // no depths
  }
  for (int beam = 0; beam < scan_line.num_beams(); ++beam) {
    const float range = scan_line.ranges[static_cast<size_t>(beam)];
    if (!std::isfinite(range)) continue;
    const int column = model.width - 1 - beam;  // beams go from the right to the left
    const auto depth_mm = std::lround(1e3 * DepthOf(model, row, column, range));
    CHECK_LE(depth_mm, 0xffff) << "no depth in two bytes";
    uint8_t* pixel = image.data.data() + size_t{image.step} * static_cast<size_t>(row) +
                     sizeof(uint16_t) * static_cast<size_t>(column);
    pixel[0] = static_cast<uint8_t>(depth_mm & 0xff);
    pixel[1] = static_cast<uint8_t>(depth_mm >> 8);
  }
}

// Writes the rows of a camera that have come, if any have, and how it sees.
void RecordingWriter::Impl::WriteImage(size_t camera) {
  sensor_msgs::Image& image = images[camera];
  if (image.data.empty()) return;
  const PinholeModel& model = rig.depth_cameras[camera].model;
  sensor_msgs::CameraInfo info;
  info.header = image.header;
  info.width = image.width;
  info.height = image.height;
  info.distortion_model = "plumb_bob";
  info.D.assign(5, 0.0);
  info.K = {model.focal_x, 0, model.centre_x, 0, model.focal_y, model.centre_y, 0, 0, 1};
  info.R = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  info.P = {
      model.focal_x, 0, model.centre_x, 0, 0, model.focal_y, model.centre_y, 0, 0, 0, 1, 0};
  try {
    bag->write(rig.depth_cameras[camera].info_topic, info.header.stamp, info);
    bag->write(rig.depth_cameras[camera].topic, image.header.stamp, image);
  } catch (const std::exception& exception) {
    Fail(exception);
  }
  ++image.header.seq;
  image.data.clear();
}

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
  if (scanner.camera_row) return impl_->WriteRow(scan_line, *scanner.camera_row);

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
  for (size_t camera = 0; camera < impl_->images.size(); ++camera) impl_->WriteImage(camera);
  try {
    impl_->bag->close();
  } catch (const std::exception& exception) {
    impl_->Fail(exception);
  }
  impl_->bag.reset();
  impl_->file.Commit();
}

}  // namespace plumbline
