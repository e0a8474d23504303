#include "core/registration/visit_grid.h"

#include <algorithm>

#include "core/registration/visit_surface.h"

namespace plumbline {
namespace {

// Spread of points about the surface that they lie on: noise, uneven walls, and half a cell.
constexpr double kStddev = 0.12;  // m
constexpr int8_t kPassed = -30;   // hundredths
constexpr double kMargin = 1.0;   // m, around everything seen

}  // namespace

VisitGrid::VisitGrid(const Visit& visit) {
  if (visit.points.empty()) return;
  Eigen::Vector2d low = visit.points.front();
  Eigen::Vector2d high = low;
  for (const auto* points : {&visit.points, &visit.scanners}) {
    for (const Eigen::Vector2d& point : *points) {
      low = low.cwiseMin(point);
      high = high.cwiseMax(point);
    }
  }
  origin_ = low - Eigen::Vector2d::Constant(kMargin);
  width_ = static_cast<int>((high.x() - low.x() + 2.0 * kMargin) / kCell) + 1;
  height_ = static_cast<int>((high.y() - low.y() + 2.0 * kMargin) / kCell) + 1;
  values_.assign(IndexOf(0, height_), 0);
  for (size_t i = 0; i < visit.points.size(); ++i) {
    AddPassing(visit.scanners[i], visit.points[i]);
  }
  for (const Eigen::Vector2d& point : visit.points) AddSurface(point);
  bounds_ = LargestWithin(kCoarse, 1, values_);
  coarse_bounds_ = LargestWithin(kCoarse - 1, kCoarse, bounds_);
}

void VisitGrid::AddPassing(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  const double length_m = (to - from).norm();
  for (double along_m = 0.0; along_m < length_m - VisitSurface::kReach;
       along_m += 0.7 * kCell) {
    const Eigen::Vector2d p = (from + (to - from) * (along_m / length_m) - origin_) / kCell;
    values_[IndexOf(static_cast<int>(p.x()), static_cast<int>(p.y()))] = kPassed;
  }
}

void VisitGrid::AddSurface(const Eigen::Vector2d& point) {
  const int reach = static_cast<int>(VisitSurface::kReach / kCell) + 1;
  const Eigen::Vector2d p = (point - origin_) / kCell;
  const int at_x = static_cast<int>(p.x());
  const int at_y = static_cast<int>(p.y());
  for (int y = at_y - reach; y <= at_y + reach; ++y) {
    for (int x = at_x - reach; x <= at_x + reach; ++x) {
      const double distance_m = kCell * (Eigen::Vector2d(x + 0.5, y + 0.5) - p).norm();
      if (distance_m > VisitSurface::kReach) continue;
      const double deviation = distance_m / kStddev;
      const auto value =
          static_cast<int8_t>(std::lround(100.0 * std::exp(-0.5 * deviation * deviation)));
      int8_t& cell = values_[IndexOf(x, y)];
      cell = std::max(cell, value);
    }
  }
}

std::vector<int8_t> VisitGrid::LargestWithin(int num_steps,
                                             int step,
                                             const std::vector<int8_t>& values) const {
  std::vector<int8_t> in_rows = values;
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      int8_t& largest = in_rows[IndexOf(x, y)];
      for (int next = 1; next <= num_steps && x + next * step < width_; ++next) {
        largest = std::max(largest, values[IndexOf(x + next * step, y)]);
      }
    }
  }
  std::vector<int8_t> in_squares = in_rows;
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      int8_t& largest = in_squares[IndexOf(x, y)];
      for (int next = 1; next <= num_steps && y + next * step < height_; ++next) {
        largest = std::max(largest, in_rows[IndexOf(x, y + next * step)]);
      }
    }
  }
  return in_squares;
}

}  // namespace plumbline
