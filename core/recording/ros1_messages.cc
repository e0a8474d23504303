#include "core/recording/ros1_messages.h"

#include <cstring>
#include <limits>
#include <string>
#include <vector>

namespace plumbline {
namespace {

constexpr size_t kCovarianceBytes = 36 * sizeof(double);

bool TakeFloats(ByteCursor* cursor, uint32_t* count, ByteView* floats) {
  return cursor->Take(count) && cursor->Take(size_t{*count} * sizeof(float), floats);
}

bool TakeText(ByteCursor* cursor, std::string* text) {
  uint32_t length = 0;
  ByteView bytes;
  if (!cursor->Take(&length) || !cursor->Take(length, &bytes)) return false;
  text->assign(reinterpret_cast<const char*>(bytes.data), bytes.size);
  return true;
}

// seq (uint32), stamp (seconds and nanoseconds, uint32 each), frame_id.
bool TakeHeader(ByteCursor* cursor, int64_t* stamp_ns, std::string* frame_id) {
  uint32_t sequence = 0;
  uint32_t seconds = 0;
  uint32_t nanoseconds = 0;
  if (!cursor->Take(&sequence) || !cursor->Take(&seconds) || !cursor->Take(&nanoseconds) ||
      !TakeText(cursor, frame_id)) {
    return false;
  }
  *stamp_ns = int64_t{seconds} * 1'000'000'000 + nanoseconds;
  return true;
}

bool TakeRanges(ByteCursor* cursor, uint32_t* num_beams, std::vector<float>* ranges) {
  ByteView floats;
  if (!TakeFloats(cursor, num_beams, &floats)) return false;
  if (ranges == nullptr) return true;
  ranges->resize(*num_beams);
  if (floats.size > 0) std::memcpy(ranges->data(), floats.data, floats.size);
  return true;
}

// A list of beams, each a list of echoes; the first echo counts.
bool TakeEchoes(ByteCursor* cursor, uint32_t* num_beams, std::vector<float>* ranges) {
  // Every beam takes at least 4 bytes. Tested before anybody allocates memory.
  if (!cursor->Take(num_beams) || *num_beams > cursor->num_left() / 4) return false;
  if (ranges != nullptr) ranges->resize(*num_beams);
  for (uint32_t beam = 0; beam < *num_beams; ++beam) {
    uint32_t num_echoes = 0;
    ByteView echoes;
    if (!TakeFloats(cursor, &num_echoes, &echoes)) return false;
    if (ranges == nullptr) continue;
    float range = std::numeric_limits<float>::quiet_NaN();
    if (num_echoes > 0) ByteCursor(echoes).Take(&range);
    (*ranges)[beam] = range;
  }
  return true;
}

template <size_t kCount>
bool TakeNumbers(ByteCursor* cursor, std::array<double, kCount>* numbers) {
  for (double& number : *numbers) {
    if (!cursor->Take(&number)) return false;
  }
  return true;
}

}  // namespace

bool ReadRos1ScanLine(ByteView data,
                      MessageKind kind,
                      bool with_ranges,
                      ScanLineMessage* message) {
  ByteCursor cursor(data);
  float angle_max = 0.0f;
  float scan_time = 0.0f;
  if (!TakeHeader(&cursor, &message->stamp_ns, &message->frame_id) ||
      !cursor.Take(&message->angle_min) || !cursor.Take(&angle_max) ||
      !cursor.Take(&message->angle_increment) || !cursor.Take(&message->time_increment) ||
      !cursor.Take(&scan_time) || !cursor.Take(&message->range_min) ||
      !cursor.Take(&message->range_max)) {
    return false;
  }
  uint32_t num_intensities = 0;
  const auto take = kind == MessageKind::kMultiEchoLaserScan ? TakeEchoes : TakeRanges;
  return take(&cursor, &message->num_beams, with_ranges ? &message->ranges : nullptr) &&
         take(&cursor, &num_intensities, nullptr) && cursor.num_left() == 0;
}

bool ReadRos1Odometry(ByteView data, OdometryMessage* message) {
  ByteCursor cursor(data);
  ByteView covariance;
  return TakeHeader(&cursor, &message->stamp_ns, &message->frame_id) &&
         TakeText(&cursor, &message->child_frame_id) &&
         TakeNumbers(&cursor, &message->position) &&
         TakeNumbers(&cursor, &message->orientation) &&
         cursor.Take(kCovarianceBytes, &covariance) &&
         TakeNumbers(&cursor, &message->linear_velocity) &&
         TakeNumbers(&cursor, &message->angular_velocity) &&
         cursor.Take(kCovarianceBytes, &covariance) && cursor.num_left() == 0;
}

}  // namespace plumbline
