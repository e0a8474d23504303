#include "core/result/surface_colour.h"

#include <algorithm>
#include <cmath>

#include "core/result/point_buffer.h"

namespace plumbline {

std::array<uint8_t, 3> SurfaceColour(int plane_id) {
  constexpr double kGoldenRatio = 0.6180339887498949;
  const double hue = 6.0 * std::fmod(static_cast<double>(plane_id) * kGoldenRatio, 1.0);
  const auto channel = [hue](double offset) {
    const double position = std::fmod(hue + offset + 6.0, 6.0);
    const double ramp = std::min(std::max(std::abs(position - 3.0) - 1.0, 0.0), 1.0);
    return static_cast<uint8_t>(std::lround(64.0 + 191.0 * ramp));
  };
  return {channel(0.0), channel(4.0), channel(2.0)};
}

std::array<uint8_t, 3> PointColour(int plane_id) {
  if (plane_id >= 0) return SurfaceColour(plane_id);
  if (plane_id == kMovingPlaneId) return {90, 90, 90};
  return {160, 160, 160};
}

}  // namespace plumbline
