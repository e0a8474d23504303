#include "core/outputs/point_statistics.h"

#include <algorithm>
#include <cmath>

namespace plumbline {
namespace {

PointStatistics::Group* GroupAt(size_t index, std::vector<PointStatistics::Group>* groups) {
  if (index >= groups->size()) groups->resize(index + 1);
  return &(*groups)[index];
}

}  // namespace

void PointStatistics::Add(const MapPoint& point) {
  const auto second = static_cast<size_t>(std::max(0.0, point.time_s));
  for (Group* group : {GroupAt(static_cast<size_t>(point.scanner), &by_scanner_),
                       GroupAt(second, &by_second_)}) {
    ++group->points;
    if (point.plane_id < 0) continue;
    const double residual_m = point.residual_m;
    ++group->on_planes;
    group->sum_squares_m2 += residual_m * residual_m;
  }
  if (point.plane_id < 0 || !std::isfinite(point.residual_m)) return;
  const double bin =
      std::floor(point.residual_m / kBinWidth) + static_cast<double>(kBinsPerSide);
  ++histogram_[static_cast<size_t>(std::clamp(bin, 0.0, 2.0 * kBinsPerSide - 1.0))];
}

}  // namespace plumbline
