#include "core/result/point_buffer.h"

#include <glog/logging.h>

#include <algorithm>
#include <cstring>
#include <limits>

#include "core/result/surface_colour.h"

namespace plumbline {
namespace {

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "points are written as they lie");

// Returns where the next value goes.
template <typename Value>
char* Put(const Value& value, char* at) {
  std::memcpy(at, &value, sizeof(value));
  return at + sizeof(value);
}

char* Put(const Eigen::Vector3f& vector, char* at) {
  std::memcpy(at, vector.data(), 3 * sizeof(float));
  return at + 3 * sizeof(float);
}

// Returns where the next value is.
template <typename Value>
const char* Take(const char* at, Value* value) {
  std::memcpy(value, at, sizeof(*value));
  return at + sizeof(*value);
}

}  // namespace

std::array<uint8_t, 4> PointBuffer::ColourBytes(int plane_id) {
  const std::array<uint8_t, 3> colour = PointColour(plane_id);
  return {colour[0], colour[1], colour[2], 255};
}

void PointBuffer::Add(const MapPoint& point) {
  CHECK_GE(point.scanner, 0);
  CHECK_LE(point.scanner, std::numeric_limits<uint8_t>::max());
  if (num_bytes_ + kPointBytes > bytes_.size()) {
    bytes_.resize(std::max(2 * bytes_.size(), size_t{1000} * kPointBytes));
  }
  if (point.plane_id != colour_plane_id_) {
    colour_plane_id_ = point.plane_id;
    colour_ = ColourBytes(point.plane_id);
  }
  char* at = bytes_.data() + num_bytes_;
  at = Put(point.p_world, at);
  at = Put(point.time_s, at);
  at = Put(static_cast<uint8_t>(point.scanner), at);
  at = Put(static_cast<int32_t>(point.plane_id), at);
  at = Put(point.residual_m, at);
  at = Put(colour_, at);
  Put(point.normal_world, at);
  num_bytes_ += kPointBytes;
}

MapPoint PointBuffer::At(int64_t index) const {
  CHECK_GE(index, 0);
  CHECK_LT(index, num_points());
  MapPoint point;
  std::array<float, 3> vector{};
  uint8_t scanner = 0;
  int32_t plane_id = 0;
  const char* at = bytes_.data() + static_cast<size_t>(index) * kPointBytes;
  at = Take(at, &vector);
  point.p_world = {vector[0], vector[1], vector[2]};
  at = Take(at, &point.time_s);
  at = Take(at, &scanner);
  point.scanner = scanner;
  at = Take(at, &plane_id);
  point.plane_id = plane_id;
  at = Take(at, &point.residual_m);
  Take(at + sizeof(colour_), &vector);
  point.normal_world = {vector[0], vector[1], vector[2]};
  return point;
}

}  // namespace plumbline
