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

  // The cell of a point, on the grid or not.
  Eigen::Vector2i CellOf(const Eigen::Vector2d& p) const {
    return ((p - origin_) / kCell).array().floor().cast<int>();
  }
  // Returns the fit of a point in a cell, in hundredths: 100 on a surface, less near one,
  // below 0 where beams passed, 0 where nothing is known.
  int At(const Eigen::Vector2i& cell) const { return ValueOf(values_, cell); }
  // Returns an upper bound of the fit in the cell, and in all that lie up to kCoarse cells
  // from it towards larger x and y.
  int BoundAt(const Eigen::Vector2i& cell) const { return ValueOf(bounds_, cell); }
  int CoarseBoundAt(const Eigen::Vector2i& cell) const {
    // What lies before the grid may move into it.
    return ValueOf(coarse_bounds_,
                   cell.cwiseMax((cell.array() + kCoarse * kCoarse).matrix().cwiseMin(0)));
  }

 private:
  size_t IndexOf(int x, int y) const {
    return static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x);
  }
  int ValueOf(const std::vector<int8_t>& values, const Eigen::Vector2i& cell) const {
    if (cell.x() < 0 || cell.y() < 0 || cell.x() >= width_ || cell.y() >= height_) return 0;
    return values[IndexOf(cell.x(), cell.y())];
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
