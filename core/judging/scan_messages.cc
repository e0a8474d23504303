#include "core/judging/scan_messages.h"

#include <memory>

#include "core/sensor/scan_header.h"

namespace plumbline {

void TakeOver(const MessageRef& where,
              const ScanLineMessage& as_sent,
              const Scanner* scanner,
              ScanMessage* message) {
  ScanLineMessage scan = as_sent;
  CorrectHeader(scanner, &scan);
  message->receipt_ns = static_cast<int64_t>(where.receipt_ns);
  message->frame_id = scan.frame_id;
  message->is_planar = scan.is_planar;
  message->usable = scan.is_planar && scan.IsUsable();
  if (!scan.IsUsable()) message->unusable_reason = WhyUnusable(scan);
  message->stated_min_range_m = scan.range_min;
  message->stated_max_range_m = scan.range_max;
  ScanLine& line = message->line;
  line.stamp_ns = scan.stamp_ns;
  line.angle_min = scan.angle_min;
  line.angle_increment = scan.angle_increment;
  line.time_increment_s = scan.time_increment;
  line.ranges = scan.ranges;
  message->is_at_stated_limit.clear();
  for (size_t beam = 0; beam < scan.ranges.size(); ++beam) {
    if (!IsStatedLimit(scan, scan.ranges[beam])) continue;
    message->is_at_stated_limit.resize(scan.ranges.size(), false);
    message->is_at_stated_limit[beam] = true;
  }
  line.angles = nullptr;
  if (!scan.angles.empty()) {
    line.angles =
        std::make_shared<std::vector<double>>(scan.angles.begin(), scan.angles.end());
  }
}

}  // namespace plumbline
