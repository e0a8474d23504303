#include "core/sensor/laser_scan_message.h"

#include <cmath>
#include <cstring>
#include <limits>

namespace plumbline {
namespace {

const char kLaserScanMd5[] = "90c7ef2dc6895d81024acba2ac42f369";
const char kMultiEchoMd5[] = "6fefb0c6da89d7c8abe4b339f5c2f8fb";

// No scanner takes longer for a scan line. Infinity and NaN fail the comparison too.
constexpr float kMaxScanSeconds = 2.0f;

// Lists are serialised as their length (uint32) and their elements.
bool TakeFloats(ByteCursor* cursor, uint32_t* count, ByteView* floats) {
  return cursor->Take(count) && cursor->Take(size_t{*count} * sizeof(float), floats);
}

// seq (uint32), stamp (seconds and nanoseconds, uint32 each), frame_id (length and text).
bool TakeHeader(ByteCursor* cursor, int64_t* stamp_ns) {
  uint32_t sequence = 0;
  uint32_t seconds = 0;
  uint32_t nanoseconds = 0;
  uint32_t frame_length = 0;
  ByteView frame;
  if (!cursor->Take(&sequence) || !cursor->Take(&seconds) || !cursor->Take(&nanoseconds) ||
      !cursor->Take(&frame_length) || !cursor->Take(frame_length, &frame)) {
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

}  // namespace

bool LaserScanMessage::IsUsable() const {
  return num_beams > 0 && std::isfinite(angle_min) && std::isfinite(angle_increment) &&
         angle_increment != 0.0f && time_increment >= 0.0f &&
         time_increment * static_cast<float>(num_beams) <= kMaxScanSeconds;
}

bool IsMultiEchoLaserScan(const BagConnection& connection) {
  return connection.type == "sensor_msgs/MultiEchoLaserScan" &&
         connection.md5sum == kMultiEchoMd5;
}

bool IsLaserScan(const BagConnection& connection) {
  return IsMultiEchoLaserScan(connection) ||
         (connection.type == "sensor_msgs/LaserScan" && connection.md5sum == kLaserScanMd5);
}

bool ReadLaserScan(ByteView data,
                   bool multi_echo,
                   LaserScanMessage* message,
                   std::vector<float>* ranges) {
  ByteCursor cursor(data);
  float angle_max = 0.0f;
  float scan_time = 0.0f;
  float range_min = 0.0f;
  float range_max = 0.0f;
  if (!TakeHeader(&cursor, &message->stamp_ns) || !cursor.Take(&message->angle_min) ||
      !cursor.Take(&angle_max) || !cursor.Take(&message->angle_increment) ||
      !cursor.Take(&message->time_increment) || !cursor.Take(&scan_time) ||
      !cursor.Take(&range_min) || !cursor.Take(&range_max)) {
    return false;
  }
  uint32_t num_intensities = 0;
  const auto take = multi_echo ? TakeEchoes : TakeRanges;
  return take(&cursor, &message->num_beams, ranges) &&
         take(&cursor, &num_intensities, nullptr) && cursor.num_left() == 0;
}

}  // namespace plumbline
