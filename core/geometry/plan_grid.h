#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

namespace plumbline {

// PlanGrid finds the boxes on the floor plan that a line may cross: a grid of square cells,
// each with the boxes that touch it.
class PlanGrid {
 public:
  // boxes: world x, y (m). A box is known by its index; empty boxes are never found.
  explicit PlanGrid(const std::vector<Eigen::AlignedBox2d>& boxes);

  // Calls visit(index) once for each box near the straight piece from a to b: for all boxes
  // that the piece meets, and for some more.
  template <typename Visit>
  void ForEachNear(const Eigen::Vector2d& a, const Eigen::Vector2d& b, Visit visit) {
    ++round_;
    const Eigen::Vector2d& low = a.y() < b.y() ? a : b;
    const Eigen::Vector2d& high = a.y() < b.y() ? b : a;
    const double slope = (high.x() - low.x()) / (high.y() - low.y());
    const int first_row = Clamped(low.y() - origin_.y(), num_rows_);
    const int last_row = Clamped(high.y() - origin_.y(), num_rows_);
    for (int row = first_row; row <= last_row; ++row) {
      // The piece's part in this row of cells; the outermost rows stand for all beyond the
      // grid.
      const double row_y = origin_.y() + kCell * row;
      const double from_x = row == first_row ? low.x() : low.x() + slope * (row_y - low.y());
      const double to_x =
          row == last_row ? high.x() : low.x() + slope * (row_y + kCell - low.y());
      const int first = Clamped(std::min(from_x, to_x) - kMargin - origin_.x(), num_columns_);
      const int last = Clamped(std::max(from_x, to_x) + kMargin - origin_.x(), num_columns_);
      for (int column = first; column <= last; ++column) {
        for (const int index : cells_[static_cast<size_t>(row * num_columns_ + column)]) {
          int& visited = visited_[static_cast<size_t>(index)];
          if (visited == round_) continue;
          visited = round_;
          visit(index);
        }
      }
    }
  }

 private:
  static constexpr double kCell = 2.0;     // m, about a wall of an office
  static constexpr double kMargin = 1e-6;  // m, far above rounding errors

  static int Clamped(double from_origin, int count) {
    return static_cast<int>(std::clamp(from_origin / kCell, 0.0, count - 1.0));
  }

  Eigen::Vector2d origin_ = Eigen::Vector2d::Zero();
  int num_columns_ = 1;
  int num_rows_ = 1;
  std::vector<std::vector<int>> cells_;  // row by row
  std::vector<int> visited_;             // round in which each box was visited last
  int round_ = 0;
};

}  // namespace plumbline
