#include "core/sensor/scan_header.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "core/util/time.h"

namespace plumbline {
namespace {

constexpr float kAtLimit = 1e-6f;  // of the limit: rounding

void Reverse(ScanLineMessage* message) {
  const uint32_t num_steps = std::max(1u, message->num_beams) - 1;
  const double last_s = static_cast<double>(num_steps) * message->time_increment;
  message->stamp_ns += NanosecondsFromSeconds(last_s);
  message->time_increment = -message->time_increment;
  message->angle_min += static_cast<float>(num_steps) * message->angle_increment;
  message->angle_increment = -message->angle_increment;
  std::reverse(message->ranges.begin(), message->ranges.end());
  if (message->angles.empty()) return;
  std::reverse(message->angles.begin(), message->angles.end());
  message->angle_min = message->angles.front();
}

}  // namespace

void CorrectHeader(const Scanner* scanner, ScanLineMessage* message) {
  if (scanner != nullptr) {
    if (scanner->time_increment_s) {
      message->time_increment = static_cast<float>(*scanner->time_increment_s);
    }
    if (message->angles.empty()) {
      if (scanner->angle_min_rad)
        message->angle_min = static_cast<float>(*scanner->angle_min_rad);
      if (scanner->angle_increment_rad) {
        message->angle_increment = static_cast<float>(*scanner->angle_increment_rad);
      }
    }
  }
  // Times that make no sense are left for IsUsable() to tell.
  ScanLineMessage turned;
  turned.num_beams = message->num_beams;
  turned.angle_min = message->angle_min;
  turned.angle_increment = message->angle_increment;
  turned.time_increment = -message->time_increment;
  if (message->time_increment < 0.0f && turned.IsUsable()) Reverse(message);
}

std::string WhyUnusable(const ScanLineMessage& message) {
  if (message.num_beams == 0) return "no beams";
  if (!std::isfinite(message.angle_min) || !std::isfinite(message.angle_increment)) {
    return "angle_min or angle_increment are no numbers";
  }
  if (message.angle_increment == 0.0f) return "angle_increment is 0";
  char text[160];
  const double line_s = message.num_beams * static_cast<double>(message.time_increment);
  std::snprintf(text,
                sizeof(text),
                "time_increment is %g s, so that a scan line would take %g s",
                message.time_increment,
                line_s);
  const std::string reason = text;
  // The unit in which a line takes less than the longest that there is.
  for (const auto& [unit, factor] :
       {std::make_pair("milliseconds", 1e-3), {"microseconds", 1e-6}, {"nanoseconds", 1e-9}}) {
    if (!(factor * line_s > 0.0 && factor * line_s < kMaxScanSeconds)) continue;
    std::snprintf(text,
                  sizeof(text),
                  "; in %s it would take %g ms (time_increment_s: %g)",
                  unit,
                  1e3 * factor * line_s,
                  factor * message.time_increment);
    return reason + text;
  }
  return reason;
}

bool IsStatedLimit(const ScanLineMessage& message, float range) {
  return message.range_max > message.range_min &&
         std::abs(range - message.range_max) <= kAtLimit * message.range_max;
}

}  // namespace plumbline
