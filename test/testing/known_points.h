#pragma once

#include <cmath>
#include <limits>

#include "core/result/point_buffer.h"

namespace plumbline {

// The i-th of points of which every field is known, on five surfaces, none and what moves.
inline MapPoint KnownPoint(int i) {
  const float value = static_cast<float>(i);
  MapPoint point;
  point.p_world = {0.01f * value, -0.005f * value, 0.0025f * value};
  point.time_s = 1e-9 * i;
  point.scanner = i % 3;
  point.plane_id = i % 7 - 2;
  point.residual_m = std::numeric_limits<float>::quiet_NaN();
  if (point.plane_id >= 0) {
    point.residual_m = 0.125f * value;
    point.normal_world = {0.0f, 0.6f, point.plane_id % 2 == 0 ? 0.8f : -0.8f};
  }
  return point;
}

inline PointBuffer KnownPoints(int first, int last) {
  PointBuffer points;
  for (int i = first; i < last; ++i) points.Add(KnownPoint(i));
  return points;
}

inline bool AreSame(const MapPoint& a, const MapPoint& b) {
  return a.p_world == b.p_world && a.time_s == b.time_s && a.scanner == b.scanner &&
         a.plane_id == b.plane_id && a.normal_world == b.normal_world &&
         (a.residual_m == b.residual_m ||
          (std::isnan(a.residual_m) && std::isnan(b.residual_m)));
}

}  // namespace plumbline
