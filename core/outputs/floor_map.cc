#include "core/outputs/floor_map.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/outputs/plan_scales.h"

namespace plumbline {

FloorMap::FloorMap(std::vector<FloorArea> areas, const std::vector<Sighting>& sightings)
    : areas_(std::move(areas)) {
  constexpr double kMaxCells = 2000.0;  // along a side: a stray far away costs no memory
  for (const Sighting& sighting : sightings) box_.extend(sighting.p);
  cell_m_ = std::max(kSameM, box_.sizes().maxCoeff() / kMaxCells);
  num_columns_ = static_cast<int>(box_.sizes().x() / cell_m_) + 1;
  num_rows_ = static_cast<int>(box_.sizes().y() / cell_m_) + 1;
  area_of_cell_.assign(static_cast<size_t>(num_columns_) * static_cast<size_t>(num_rows_), -1);
  std::vector<uint32_t> most(area_of_cell_.size(), 0);
  lowest_m_ = std::numeric_limits<double>::max();
  highest_m_ = std::numeric_limits<double>::lowest();
  for (size_t area = 0; area < areas_.size(); ++area) {
    std::vector<uint32_t> counts(area_of_cell_.size(), 0);
    for (const Sighting& sighting : sightings) {
      if (sighting.area != area) continue;
      ++counts[Index(sighting.p)];
      const double height_m = areas_[area].floor.HeightAt(sighting.p);
      lowest_m_ = std::min(lowest_m_, height_m);
      highest_m_ = std::max(highest_m_, height_m);
    }
    for (size_t i = 0; i < counts.size(); ++i) {
      if (counts[i] <= most[i]) continue;
      most[i] = counts[i];
      area_of_cell_[i] = static_cast<int>(area);
    }
  }
  FillFromNearest();
}

// From square to square, at the same pace from all that were seen.
void FloorMap::FillFromNearest() {
  std::vector<size_t> waiting;
  for (size_t i = 0; i < area_of_cell_.size(); ++i) {
    if (area_of_cell_[i] >= 0) waiting.push_back(i);
  }
  const auto columns = static_cast<size_t>(num_columns_);
  for (size_t next = 0; next < waiting.size(); ++next) {
    const size_t at = waiting[next];
    const auto reach = [&](bool is_there, size_t neighbour) {
      if (!is_there || area_of_cell_[neighbour] >= 0) return;
      area_of_cell_[neighbour] = area_of_cell_[at];
      waiting.push_back(neighbour);
    };
    reach(at % columns > 0, at - 1);
    reach(at % columns + 1 < columns, at + 1);
    reach(at >= columns, at - columns);
    reach(at + columns < area_of_cell_.size(), at + columns);
  }
}

size_t FloorMap::Index(const Eigen::Vector2d& p) const {
  const auto place = [this](double from_edge_m, int count) {
    return static_cast<size_t>(
        std::clamp(std::floor(from_edge_m / cell_m_), 0.0, static_cast<double>(count - 1)));
  };
  return place(p.y() - box_.min().y(), num_rows_) * static_cast<size_t>(num_columns_) +
         place(p.x() - box_.min().x(), num_columns_);
}

const FloorArea& FloorMap::At(const Eigen::Vector2d& p) const {
  return areas_[static_cast<size_t>(area_of_cell_[Index(p)])];
}

}  // namespace plumbline
