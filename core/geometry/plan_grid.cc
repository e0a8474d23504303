#include "core/geometry/plan_grid.h"

namespace plumbline {

PlanGrid::PlanGrid(const std::vector<Eigen::AlignedBox2d>& boxes) : visited_(boxes.size(), 0) {
  Eigen::AlignedBox2d all;
  for (const Eigen::AlignedBox2d& box : boxes) {
    if (!box.isEmpty()) all.extend(box);
  }
  if (!all.isEmpty()) {
    // In each direction: 2 km. Boxes beyond share the last cells.
    constexpr double kMaxCells = 1000.0;
    origin_ = all.min();
    const Eigen::Array2d count = (all.sizes().array() / kCell).floor().min(kMaxCells) + 1.0;
    num_columns_ = static_cast<int>(count.x());
    num_rows_ = static_cast<int>(count.y());
  }
  cells_.resize(static_cast<size_t>(num_columns_ * num_rows_));
  for (size_t i = 0; i < boxes.size(); ++i) {
    if (boxes[i].isEmpty()) continue;
    const Eigen::Array2d margin = Eigen::Array2d::Constant(kMargin);
    const Eigen::Vector2d low = boxes[i].min().array() - margin - origin_.array();
    const Eigen::Vector2d high = boxes[i].max().array() + margin - origin_.array();
    for (int row = Clamped(low.y(), num_rows_); row <= Clamped(high.y(), num_rows_); ++row) {
      for (int column = Clamped(low.x(), num_columns_);
           column <= Clamped(high.x(), num_columns_);
           ++column) {
        cells_[static_cast<size_t>(row * num_columns_ + column)].push_back(
            static_cast<int>(i));
      }
    }
  }
}

}  // namespace plumbline
