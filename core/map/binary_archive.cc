#include "core/map/binary_archive.h"

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "core/util/error.h"

namespace plumbline {

BinaryArchive::BinaryArchive(const std::string& path, Mode mode)
    : path_(path),
      mode_(mode),
      stream_(path,
              std::ios::binary | (mode == Mode::kRead ? std::ios::in | std::ios::ate
                                                      : std::ios::out | std::ios::trunc)) {
  if (!stream_) {
    throw Error(path_ + ": can not be " + (is_reading() ? "read: " : "written: ") +
                std::strerror(errno));
  }
  if (!is_reading()) return;
  CheckWhole();
}

void BinaryArchive::CheckWhole() {
  num_left_ = static_cast<int64_t>(stream_.tellg()) - static_cast<int64_t>(sizeof(uint64_t));
  if (num_left_ < 0) FailAsDamaged();
  stream_.seekg(0);
  Checksum checksum;
  std::vector<char> buffer(1 << 20);
  for (int64_t left = num_left_; left > 0;) {
    const auto size = std::min(left, static_cast<int64_t>(buffer.size()));
    if (!stream_.read(buffer.data(), size)) FailAsDamaged();
    checksum.Add(buffer.data(), static_cast<size_t>(size));
    left -= size;
  }
  uint64_t stored = 0;
  stream_.read(reinterpret_cast<char*>(&stored), sizeof(stored));
  if (!stream_ || stored != checksum.value()) FailAsDamaged();
  stream_.seekg(0);
}

void BinaryArchive::Finish() {
  if (is_reading()) {
    if (num_left_ != 0) FailAsDamaged();
    return;
  }
  errno = 0;
  const uint64_t checksum = checksum_.value();
  stream_.write(reinterpret_cast<const char*>(&checksum), sizeof(checksum));
  stream_.close();
  if (!stream_) {
    throw Error(path_ + ": can not be written: " + std::strerror(errno != 0 ? errno : EIO));
  }
}

void BinaryArchive::FailAsDamaged() const {
  throw Error(path_ + ": is damaged or incomplete");
}

void BinaryArchive::Bytes(void* data, size_t size) {
  const auto length = static_cast<std::streamsize>(size);
  if (!is_reading()) {
    stream_.write(static_cast<const char*>(data), length);
    checksum_.Add(data, size);
  } else {
    if (length > num_left_ || !stream_.read(static_cast<char*>(data), length)) FailAsDamaged();
    num_left_ -= length;
  }
}

void BinaryArchive::CheckSize(int64_t num_elements, int64_t bytes_each) const {
  if (num_elements < 0 || bytes_each < 0 ||
      (bytes_each > 0 && num_elements > num_left_ / bytes_each)) {
    FailAsDamaged();
  }
}

// The structured bindings below do not compile where a struct gets another member.

void BinaryArchive::operator()(Rigid3d& pose) {
  (*this)(pose.rotation);
  (*this)(pose.translation);
}

void BinaryArchive::operator()(ControlPoint& point) {
  auto& [rotation, position] = point;
  (*this)(rotation);
  (*this)(position);
}

void BinaryArchive::operator()(ObservedPoint& point) {
  auto& [position, time_ns, whitening, offset] = point;
  (*this)(position);
  (*this)(time_ns);
  (*this)(whitening);
  (*this)(offset);
}

void BinaryArchive::operator()(Observation& observation) {
  auto& [measurement,
         first_point,
         last_point,
         start_ns,
         end_ns,
         scan_index,
         scan_line_index,
         scanner_index,
         first_beam,
         last_beam,
         num_points,
         landmark_id,
         revision,
         taken_to,
         sigma_offset_m,
         sigma_direction_rad,
         out_of_plane_ratio,
         excluded_beams,
         points] = observation;
  measurement.VisitMembers(*this);
  (*this)(first_point);
  (*this)(last_point);
  for (int32_t* value : {&start_ns, &end_ns}) (*this)(*value);
  for (int* value : {&scan_index,
                     &scan_line_index,
                     &scanner_index,
                     &first_beam,
                     &last_beam,
                     &num_points,
                     &landmark_id,
                     &revision,
                     &taken_to}) {
    (*this)(*value);
  }
  for (float* value : {&sigma_offset_m, &sigma_direction_rad, &out_of_plane_ratio}) {
    (*this)(*value);
  }
  (*this)(excluded_beams);
  (*this)(points);
}

void BinaryArchive::operator()(Landmark& landmark) {
  auto& [id,
         model,
         chart,
         parameters,
         heading_fixed,
         extent,
         covariance,
         first_scan,
         last_scan,
         first_time_ns,
         last_time_ns,
         num_segments,
         num_points,
         sum_deviations,
         num_judged] = landmark;
  (*this)(model);
  (*this)(chart.sign);
  (*this)(chart.axes);
  (*this)(chart.anchor);
  (*this)(parameters);
  (*this)(heading_fixed);
  extent.VisitMembers(*this);
  (*this)(covariance);
  for (int* value : {&id, &first_scan, &last_scan, &num_segments, &num_judged})
    (*this)(*value);
  for (int64_t* value : {&first_time_ns, &last_time_ns, &num_points}) (*this)(*value);
  (*this)(sum_deviations);
}

void BinaryArchive::operator()(MovingBeams& beams) {
  auto& [scan_line_index, first_beam, last_beam] = beams;
  for (int* value : {&scan_line_index, &first_beam, &last_beam}) (*this)(*value);
}

void BinaryArchive::operator()(PoseConstraint& constraint) {
  auto& [time_ns, measurement] = constraint;
  auto& [world_from_body, position, root, offset] = measurement;
  (*this)(time_ns);
  (*this)(world_from_body);
  (*this)(position);
  (*this)(root);
  (*this)(offset);
}

void BinaryArchive::operator()(MapGap& gap) {
  auto& [start_ns, end_ns, reason] = gap;
  (*this)(start_ns);
  (*this)(end_ns);
  (*this)(reason);
}

void BinaryArchive::operator()(ScannerEstimate& scanner) {
  auto& [stated, is_mounted, stated_mount, is_body, block, prior_sigma, covariance] = scanner;
  (*this)(stated);
  (*this)(is_mounted);
  (*this)(stated_mount.axis);
  (*this)(stated_mount.point);
  (*this)(stated_mount.zero_rad);
  (*this)(is_body);
  (*this)(block);
  (*this)(prior_sigma);
  (*this)(covariance);
}

void BinaryArchive::operator()(ImuBiases& biases) {
  auto& [gyroscope, accelerometer, gyroscope_covariance, accelerometer_covariance] = biases;
  (*this)(gyroscope);
  (*this)(accelerometer);
  (*this)(gyroscope_covariance);
  (*this)(accelerometer_covariance);
}

// What is stated stands in the rig file.
void BinaryArchive::operator()(ImuEstimate& imu) {
  auto& [stated, planar, block, prior_sigma, covariance, intervals_per_bias, biases] = imu;
  (*this)(planar);
  (*this)(block);
  (*this)(prior_sigma);
  (*this)(covariance);
  (*this)(intervals_per_bias);
  (*this)(biases);
}

void BinaryArchive::operator()(MapState& state) {
  auto& [trajectory,
         landmarks,
         observations,
         origin_time_ns,
         sub_minimum_segments,
         moving_beams,
         pose_constraints,
         gaps,
         odometry,  // stands in the recording
         odometry_calibration,
         imu,  // stands in the recording
         calibration] = state;
  trajectory.VisitMembers(*this);
  (*this)(landmarks);
  (*this)(observations);
  (*this)(origin_time_ns);
  (*this)(sub_minimum_segments);
  (*this)(moving_beams);
  (*this)(pose_constraints);
  (*this)(gaps);
  odometry_calibration.VisitMembers(*this);
  (*this)(calibration.scanners);
  bool has_imu = calibration.imu.has_value();
  (*this)(has_imu);
  if (!has_imu) return;
  if (!calibration.imu) calibration.imu.emplace();
  (*this)(*calibration.imu);
}

}  // namespace plumbline
