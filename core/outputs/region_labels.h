#pragma once

#include <cstddef>
#include <vector>

namespace plumbline {

// Costs of labelling a cell of the plan as free, or not.
struct CellCost {
  double free = 0.0;
  double solid = 0.0;
};

// Cost of two neighbouring cells of which one is labelled free, the other not.
struct BorderCost {
  size_t a = 0;
  size_t b = 0;
  double cost = 0.0;
};

// The labels of least cost, true: free. Exact, by a minimum cut. Costs must not be negative.
std::vector<bool> LabelRegions(const std::vector<CellCost>& cells,
                               const std::vector<BorderCost>& borders);

}  // namespace plumbline
