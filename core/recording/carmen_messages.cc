#include "core/recording/carmen_messages.h"

#include <charconv>
#include <cmath>
#include <string_view>

namespace plumbline {
namespace {

constexpr double kDegree = M_PI / 180.0;

// Takes words from the front of a line.
class WordCursor {
 public:
  explicit WordCursor(ByteView line)
      : left_(reinterpret_cast<const char*>(line.data), line.size) {}

  bool Take(std::string_view* word) {
    const size_t begin = left_.find_first_not_of(kBlanks);
    if (begin == std::string_view::npos) return false;
    left_.remove_prefix(begin);
    *word = left_.substr(0, left_.find_first_of(kBlanks));
    left_.remove_prefix(word->size());
    return true;
  }
  // The number must be the whole word; NaN and infinity are words of numbers, too.
  template <typename Number>
  bool Take(Number* number) {
    std::string_view word;
    if (!Take(&word)) return false;
    const auto [end, error] = std::from_chars(word.begin(), word.end(), *number);
    return error == std::errc() && end == word.end();
  }
  bool Skip(uint32_t count) {
    std::string_view word;
    for (; count > 0; --count) {
      if (!Take(&word)) return false;
    }
    return true;
  }
  size_t num_left() const { return left_.size(); }

 private:
  static constexpr const char* kBlanks = " \t\r\n";
  std::string_view left_;
};

// Seconds with their decimals, without the rounding of a floating point number.
bool ParseTime(std::string_view word, int64_t* time_ns) {
  constexpr int64_t kMaxSeconds = 9'000'000'000;
  int64_t seconds = 0;
  const auto [point, error] = std::from_chars(word.begin(), word.end(), seconds);
  if (error != std::errc() || seconds < 0 || seconds > kMaxSeconds) return false;
  int64_t nanoseconds = 0;
  if (point != word.end()) {
    if (*point != '.') return false;
    int64_t unit = 100'000'000;
    for (const char* at = point + 1; at != word.end(); ++at, unit /= 10) {
      if (*at < '0' || *at > '9') return false;
      nanoseconds += (*at - '0') * unit;
    }
  }
  *time_ns = seconds * 1'000'000'000 + nanoseconds;
  return true;
}

// The fields at the end of every line; nothing may follow.
bool TakeTail(WordCursor* cursor, int64_t* time_ns) {
  std::string_view time;
  std::string_view rest;
  return cursor->Take(&time) && ParseTime(time, time_ns) && cursor->Skip(2) &&
         !cursor->Take(&rest);
}

bool TakeRanges(WordCursor* cursor, uint32_t count, std::vector<float>* ranges) {
  if (ranges == nullptr) return cursor->Skip(count);
  ranges->resize(count);
  for (float& range : *ranges) {
    if (!cursor->Take(&range)) return false;
  }
  return true;
}

void SetUsualAngles(ScanLineMessage* message) {
  const double n = message->num_beams;
  double start = -90.0 * kDegree;
  double increment = 180.0 * kDegree / n;
  switch (message->num_beams) {
    case 180:
    case 181:
      increment = 1.0 * kDegree;
      break;
    case 360:
    case 361:
      increment = 0.5 * kDegree;
      break;
    case 541:
      start = -135.0 * kDegree;
      increment = 0.5 * kDegree;
      break;
    case 1081:
      start = -135.0 * kDegree;
      increment = 0.25 * kDegree;
      break;
    default:
      if (message->num_beams % 2 == 1) increment = 180.0 * kDegree / (n - 1.0);
  }
  message->angle_min = static_cast<float>(start);
  message->angle_increment = static_cast<float>(increment);
}

// The fields on the scanner before the number of ranges.
bool TakeScannerConfig(WordCursor* cursor, ScanLineMessage* message) {
  float field_of_view = 0.0f;
  return cursor->Skip(1) && cursor->Take(&message->angle_min) &&
         cursor->Take(&field_of_view) && cursor->Take(&message->angle_increment) &&
         cursor->Take(&message->range_max) && cursor->Skip(2);
}

bool IsOldScanLine(std::string_view word) { return word == "FLASER" || word == "RLASER"; }

bool IsRobotScanLine(std::string_view word) { return word.substr(0, 10) == "ROBOTLASER"; }

// Every range takes at least two characters. Tested before anybody allocates memory.
bool TakeCount(WordCursor* cursor, uint32_t* count) {
  return cursor->Take(count) && *count <= cursor->num_left() / 2;
}

// Up to the poses of a scan line; with_config: of a kind that has the scanner's, and
// remissions.
bool SkipRanges(bool with_config, WordCursor* cursor) {
  uint32_t count = 0;
  ScanLineMessage unused;
  if (with_config && !TakeScannerConfig(cursor, &unused)) return false;
  if (!TakeCount(cursor, &count) || !cursor->Skip(count)) return false;
  return !with_config || (TakeCount(cursor, &count) && cursor->Skip(count));
}

}  // namespace

MessageKind CarmenKindOf(const std::string& word) {
  for (const char* known : {"FLASER",
                            "RLASER",
                            "RAWLASER1",
                            "RAWLASER2",
                            "RAWLASER3",
                            "RAWLASER4",
                            "RAWLASER5",
                            "ROBOTLASER1",
                            "ROBOTLASER2"}) {
    if (word == known) return MessageKind::kLaserScan;
  }
  return word == "ODOM" ? MessageKind::kOdometry : MessageKind::kOther;
}

bool CarmenScanLineHasOdometry(const std::string& word) {
  return IsOldScanLine(word) || IsRobotScanLine(word);
}

bool ReadCarmenReceipt(ByteView line, int64_t* receipt_ns) {
  const std::string_view text(reinterpret_cast<const char*>(line.data), line.size);
  const size_t last = text.find_last_not_of(" \t\r\n");
  if (last == std::string_view::npos) return false;
  const size_t before = text.find_last_of(" \t", last);
  const size_t begin = before == std::string_view::npos ? 0 : before + 1;
  return ParseTime(text.substr(begin, last + 1 - begin), receipt_ns);
}

bool ReadCarmenScanLine(ByteView line, bool with_ranges, ScanLineMessage* message) {
  WordCursor cursor(line);
  std::string_view word;
  if (!cursor.Take(&word)) return false;
  const bool is_old = IsOldScanLine(word);
  const bool is_robot = IsRobotScanLine(word);
  message->frame_id.clear();
  message->time_increment = 0.0f;
  message->range_min = message->range_max = 0.0f;
  if (!is_old && !TakeScannerConfig(&cursor, message)) return false;
  if (!TakeCount(&cursor, &message->num_beams) ||
      !TakeRanges(&cursor, message->num_beams, with_ranges ? &message->ranges : nullptr)) {
    return false;
  }
  if (is_old) {
    SetUsualAngles(message);
    return cursor.Skip(6) && TakeTail(&cursor, &message->stamp_ns);
  }
  uint32_t num_remissions = 0;
  return TakeCount(&cursor, &num_remissions) && cursor.Skip(num_remissions) &&
         cursor.Skip(is_robot ? 11 : 0) && TakeTail(&cursor, &message->stamp_ns);
}

bool ReadCarmenOdometry(ByteView line, OdometryMessage* message) {
  WordCursor cursor(line);
  double heading = 0.0;
  *message = OdometryMessage();
  std::string_view word;
  if (!cursor.Take(&word)) return false;
  const bool is_old = IsOldScanLine(word);
  const bool is_robot = IsRobotScanLine(word);
  // The pose of the laser comes before that of the robot.
  if ((is_old || is_robot) && !(SkipRanges(is_robot, &cursor) && cursor.Skip(3))) return false;
  if (!cursor.Take(&message->position[0]) || !cursor.Take(&message->position[1]) ||
      !cursor.Take(&heading)) {
    return false;
  }
  if (!is_old &&
      (!cursor.Take(&message->linear_velocity[0]) ||
       !cursor.Take(&message->angular_velocity[2]) || !cursor.Skip(is_robot ? 3 : 1))) {
    return false;
  }
  message->orientation = {0.0, 0.0, std::sin(0.5 * heading), std::cos(0.5 * heading)};
  return TakeTail(&cursor, &message->stamp_ns);
}

}  // namespace plumbline
