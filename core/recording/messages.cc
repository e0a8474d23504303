#include "core/recording/messages.h"

#include <cmath>

namespace plumbline {

// Infinity and NaN fail the comparison with kMaxScanSeconds too.
bool ScanLineMessage::IsUsable() const {
  return num_beams > 0 && std::isfinite(angle_min) && std::isfinite(angle_increment) &&
         angle_increment != 0.0f && time_increment >= 0.0f &&
         time_increment * static_cast<float>(num_beams) <= kMaxScanSeconds;
}

double OdometryMessage::Yaw() const {
  const auto& [x, y, z, w] = orientation;
  return std::atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z));
}

}  // namespace plumbline
