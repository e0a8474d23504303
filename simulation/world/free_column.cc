#include "simulation/world/free_column.h"

#include <algorithm>
#include <utility>

#include "simulation/world/building.h"

namespace plumbline {
namespace {

// Compares heights at one place.
class HeightOrder {
 public:
  explicit HeightOrder(const Eigen::Vector2d& place) : place_(place) {}

  bool IsAbove(const HeightPlane& a, const HeightPlane& b) const {
    return a.At(place_) - b.At(place_) > kSamePlane;
  }

 private:
  const Eigen::Vector2d& place_;
};

}  // namespace

HeightPlane HeightPlane::Rising(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::Vector2d way = (to - from).head<2>();
  const Eigen::Vector2d gradient = (to.z() - from.z()) / way.squaredNorm() * way;
  return {from.z() - gradient.dot(from.head<2>()), gradient};
}

void Free(const FreeInterval& interval, const Eigen::Vector2d& place, FreeColumn* column) {
  const HeightOrder order(place);
  if (!order.IsAbove(interval.top, interval.bottom)) return;
  FreeInterval joined = interval;
  FreeColumn result;
  for (const FreeInterval& known : *column) {
    if (order.IsAbove(known.bottom, joined.top) || order.IsAbove(joined.bottom, known.top)) {
      result.push_back(known);
      continue;
    }
    if (!order.IsAbove(known.bottom, joined.bottom)) joined.bottom = known.bottom;
    if (!order.IsAbove(joined.top, known.top)) joined.top = known.top;
  }
  const auto after =
      std::find_if(result.begin(), result.end(), [&](const FreeInterval& known) {
        return order.IsAbove(known.bottom, joined.bottom);
      });
  result.insert(after, joined);
  *column = std::move(result);
}

void Fill(const FreeInterval& interval, const Eigen::Vector2d& place, FreeColumn* column) {
  const HeightOrder order(place);
  if (!order.IsAbove(interval.top, interval.bottom)) return;
  FreeColumn rest;
  for (const FreeInterval& known : *column) {
    if (!order.IsAbove(known.top, interval.bottom) ||
        !order.IsAbove(interval.top, known.bottom)) {
      rest.push_back(known);
      continue;
    }
    if (order.IsAbove(interval.bottom, known.bottom)) {
      rest.push_back({known.bottom, interval.bottom});
    }
    if (order.IsAbove(known.top, interval.top)) rest.push_back({interval.top, known.top});
  }
  *column = std::move(rest);
}

}  // namespace plumbline
