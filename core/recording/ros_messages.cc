#include "core/recording/ros_messages.h"

#include <limits>
#include <utility>
#include <vector>

namespace plumbline {
namespace {

constexpr uint32_t kNumCovariances = 36;

// The first fields of a LaserScan and a MultiEchoLaserScan.
bool TakeScanHead(SerialReader* reader, ScanLineMessage* message) {
  float angle_max = 0.0f;
  float scan_time = 0.0f;
  return reader->TakeHeader(&message->stamp_ns, &message->frame_id) &&
         reader->Take(&message->angle_min) && reader->Take(&angle_max) &&
         reader->Take(&message->angle_increment) && reader->Take(&message->time_increment) &&
         reader->Take(&scan_time) && reader->Take(&message->range_min) &&
         reader->Take(&message->range_max);
}

// A list of numbers of 8 bytes; copied unless values is null.
bool TakeDoubles(SerialReader* reader, std::vector<double>* values) {
  uint32_t count = 0;
  if (!reader->Take(&count) || count > reader->num_left() / sizeof(double)) return false;
  if (values != nullptr) values->clear();
  for (uint32_t i = 0; i < count; ++i) {
    double value = 0.0;
    if (!reader->Take(&value)) return false;
    if (values != nullptr) values->push_back(value);
  }
  return true;
}

// A list of beams, each a list of echoes; the first echo counts.
bool TakeEchoes(SerialReader* reader, uint32_t* num_beams, std::vector<float>* ranges) {
  // Every beam takes at least 4 bytes. Tested before anybody allocates memory.
  if (!reader->Take(num_beams) || *num_beams > reader->num_left() / 4) return false;
  if (ranges != nullptr) ranges->resize(*num_beams);
  for (uint32_t beam = 0; beam < *num_beams; ++beam) {
    uint32_t num_echoes = 0;
    ByteView echoes;
    if (!reader->Take(&num_echoes) ||
        !reader->TakeBytes(size_t{num_echoes} * sizeof(float), &echoes)) {
      return false;
    }
    if (ranges == nullptr) continue;
    (*ranges)[beam] = num_echoes > 0 ? reader->NumberAt<float>(echoes.data)
                                     : std::numeric_limits<float>::quiet_NaN();
  }
  return true;
}

}  // namespace

bool ReadLaserScan(SerialReader reader, bool with_ranges, ScanLineMessage* message) {
  uint32_t num_intensities = 0;
  return TakeScanHead(&reader, message) &&
         reader.TakeFloats(&message->num_beams, with_ranges ? &message->ranges : nullptr) &&
         reader.TakeFloats(&num_intensities, nullptr) && reader.IsAtEnd();
}

bool ReadMultiEchoLaserScan(SerialReader reader, bool with_ranges, ScanLineMessage* message) {
  uint32_t num_intensities = 0;
  return TakeScanHead(&reader, message) &&
         TakeEchoes(&reader, &message->num_beams, with_ranges ? &message->ranges : nullptr) &&
         TakeEchoes(&reader, &num_intensities, nullptr) && reader.IsAtEnd();
}

bool ReadTransforms(SerialReader reader, std::vector<Transform>* transforms) {
  uint32_t num_transforms = 0;
  transforms->clear();
  if (!reader.Take(&num_transforms)) return false;
  for (uint32_t i = 0; i < num_transforms; ++i) {
    int64_t stamp_ns = 0;
    Transform one;
    if (!reader.TakeHeader(&stamp_ns, &one.parent) || !reader.TakeText(&one.child) ||
        !reader.Take(&one.translation) || !reader.Take(&one.rotation)) {
      return false;
    }
    transforms->push_back(std::move(one));
  }
  return reader.IsAtEnd();
}

bool ReadOdometry(SerialReader reader, OdometryMessage* message) {
  std::array<double, kNumCovariances> covariance;
  return reader.TakeHeader(&message->stamp_ns, &message->frame_id) &&
         reader.TakeText(&message->child_frame_id) && reader.Take(&message->position) &&
         reader.Take(&message->orientation) && reader.Take(&covariance) &&
         reader.Take(&message->linear_velocity) && reader.Take(&message->angular_velocity) &&
         reader.Take(&covariance) && reader.IsAtEnd();
}

bool ReadJoints(SerialReader reader, JointMessage* message) {
  std::string frame_id;
  uint32_t num_names = 0;
  if (!reader.TakeHeader(&message->stamp_ns, &frame_id) || !reader.Take(&num_names) ||
      num_names > reader.num_left() / sizeof(uint32_t)) {
    return false;
  }
  message->names.resize(num_names);
  for (std::string& name : message->names) {
    if (!reader.TakeText(&name)) return false;
  }
  return TakeDoubles(&reader, &message->positions) && TakeDoubles(&reader, nullptr) &&
         TakeDoubles(&reader, nullptr) && reader.IsAtEnd();
}

bool ReadNumber(SerialReader reader, JointMessage* message) {
  message->names.assign(1, "");
  message->positions.assign(1, 0.0);
  return reader.Take(&message->positions.front()) && reader.IsAtEnd();
}

bool ReadImage(SerialReader reader, ImageMessage* message) {
  uint8_t is_big_endian = 0;
  uint32_t num_bytes = 0;
  if (!reader.TakeHeader(&message->stamp_ns, &message->frame_id) ||
      !reader.Take(&message->height) || !reader.Take(&message->width) ||
      !reader.TakeText(&message->encoding) || !reader.Take(&is_big_endian) ||
      !reader.Take(&message->row_bytes) || !reader.Take(&num_bytes) ||
      !reader.TakeBytes(num_bytes, &message->data) || !reader.IsAtEnd()) {
    return false;
  }
  message->is_big_endian = is_big_endian != 0;
  return uint64_t{message->height} * message->row_bytes <= num_bytes;
}

bool ReadCameraInfo(SerialReader reader, CameraInfoMessage* message) {
  int64_t stamp_ns = 0;
  std::string frame_id;
  std::string distortion_model;
  std::array<double, 9> rectification;
  std::array<uint32_t, 2> binning;
  std::array<uint32_t, 4> region;
  uint8_t rectifies = 0;
  return reader.TakeHeader(&stamp_ns, &frame_id) && reader.Take(&message->height) &&
         reader.Take(&message->width) && reader.TakeText(&distortion_model) &&
         TakeDoubles(&reader, &message->distortion) && reader.Take(&message->camera) &&
         reader.Take(&rectification) && reader.Take(&message->projection) &&
         reader.Take(&binning) && reader.Take(&region) && reader.Take(&rectifies) &&
         reader.IsAtEnd();
}

bool ReadImu(SerialReader reader, ImuMessage* message) {
  std::array<double, 4> orientation;
  std::array<double, 9> covariance_of_orientation;
  std::array<double, 9> covariance_of_velocity;
  std::array<double, 9> covariance_of_acceleration;
  if (!reader.TakeHeader(&message->stamp_ns, &message->frame_id) ||
      !reader.Take(&orientation) || !reader.Take(&covariance_of_orientation) ||
      !reader.Take(&message->angular_velocity) || !reader.Take(&covariance_of_velocity) ||
      !reader.Take(&message->linear_acceleration) ||
      !reader.Take(&covariance_of_acceleration) || !reader.IsAtEnd()) {
    return false;
  }
  // The message's definition: -1 says that there is no such measurement.
  message->has_angular_velocity = covariance_of_velocity[0] != -1.0;
  message->has_linear_acceleration = covariance_of_acceleration[0] != -1.0;
  return true;
}

}  // namespace plumbline
