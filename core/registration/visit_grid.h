#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/registration/visit.h"

namespace plumbline {

// VisitGrid says of each place around a visit, in cells, whether a surface was seen there, or
// beams passed, or nothing is known. In the visit's frame.
class VisitGrid {
 public:
  explicit VisitGrid(const Visit& visit);

  static constexpr double kCell = 0.1;  // m
  // Cells by which BoundAt() lets a point move; CoarseBoundAt() by their square.
  static constexpr int kCoarse = 4;

  // Returns the fit of a point: 1 on a surface, less near one, below 0 where beams passed, 0
  // where nothing is known.
  double At(const Eigen::Vector2d& p) const { return ValueOf(values_, p); }
  // Returns an upper bound of the fit of the point, and of all that lie up to kCoarse cells
  // from it towards larger x and y.
  double BoundAt(const Eigen::Vector2d& p) const { return ValueOf(bounds_, p); }
  double CoarseBoundAt(const Eigen::Vector2d& p) const {
    // What lies before the grid may move into it.
    return ValueOf(coarse_bounds_,
                   p.cwiseMax(origin_.cwiseMin(
                       p + Eigen::Vector2d::Constant(kCell * kCoarse * kCoarse))));
  }

 private:
  size_t IndexOf(int x, int y) const {
    return static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x);
  }
  double ValueOf(const std::vector<int8_t>& values, const Eigen::Vector2d& p) const {
    const int x = static_cast<int>(std::floor((p.x() - origin_.x()) / kCell));
    const int y = static_cast<int>(std::floor((p.y() - origin_.y()) / kCell));
    if (x < 0 || y < 0 || x >= width_ || y >= height_) return 0.0;
    return 0.01 * values[IndexOf(x, y)];
  }
  void AddPassing(const Eigen::Vector2d& from, const Eigen::Vector2d& to);
  void AddSurface(const Eigen::Vector2d& point);
  // Returns the largest of the values in a square that reaches this number of steps towards
  // larger x and y.
  std::vector<int8_t> LargestWithin(int num_steps,
                                    int step,
                                    const std::vector<int8_t>& values) const;

  Eigen::Vector2d origin_ = Eigen::Vector2d::Zero();  // the lower corner, m
  int width_ = 0;                                     // cells
  int height_ = 0;
  std::vector<int8_t> values_;  // hundredths
  std::vector<int8_t> bounds_;
  std::vector<int8_t> coarse_bounds_;
};

}  // namespace plumbline
