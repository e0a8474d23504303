#pragma once

#include <cstddef>
#include <vector>

namespace plumbline {

// What it costs to call a cell of the plan free, or not.
struct CellCost {
  double free = 0.0;
  double solid = 0.0;
};

// What it costs where of two neighbouring cells one is called free, the other not.
struct BorderCost {
  size_t a = 0;
  size_t b = 0;
  double cost = 0.0;
};

// The labels of least cost, true: free. Exact, by a minimum cut. Costs must not be negative.
std::vector<bool> LabelRegions(const std::vector<CellCost>& cells,
                               const std::vector<BorderCost>& borders);

}  // namespace plumbline
