#include "core/result/point_buffer.h"

#include <glog/logging.h>

#include <algorithm>
#include <cstring>
#include <limits>

namespace plumbline {
namespace {

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "points are written as they lie");

// Returns where the next value goes.
template <typename Value>
char* Put(Value value, char* at) {
  std::memcpy(at, &value, sizeof(value));
  return at + sizeof(value);
}

}  // namespace

void PointBuffer::Add(const MapPoint& point) {
  CHECK_GE(point.scanner, 0);
  CHECK_LE(point.scanner, std::numeric_limits<uint8_t>::max());
  if (num_bytes_ + kPointBytes > bytes_.size()) {
    bytes_.resize(std::max(2 * bytes_.size(), size_t{1000} * kPointBytes));
  }
  char* at = bytes_.data() + num_bytes_;
  at = Put(point.p_world.x(), at);
  at = Put(point.p_world.y(), at);
  at = Put(point.p_world.z(), at);
  at = Put(point.time_s, at);
  at = Put(static_cast<uint8_t>(point.scanner), at);
  at = Put(static_cast<int32_t>(point.plane_id), at);
  Put(point.residual_m, at);
  num_bytes_ += kPointBytes;
}

}  // namespace plumbline
