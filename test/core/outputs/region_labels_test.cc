#include "core/outputs/region_labels.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace plumbline {
namespace {

double CostOf(const std::vector<CellCost>& cells,
              const std::vector<BorderCost>& borders,
              const std::vector<bool>& labels) {
  double cost = 0.0;
  for (size_t i = 0; i < cells.size(); ++i) cost += labels[i] ? cells[i].free : cells[i].solid;
  for (const BorderCost& border : borders) {
    if (labels[border.a] != labels[border.b]) cost += border.cost;
  }
  return cost;
}

TEST(RegionLabels, ACellTakesTheCheaperLabel) {
  EXPECT_EQ(LabelRegions({{1.0, 2.0}, {2.0, 1.0}}, {}), (std::vector<bool>{true, false}));
}

TEST(RegionLabels, AnUnknownCellGoesWithItsNeighbour) {
  const std::vector<CellCost> cells = {{0.0, 5.0}, {0.1, 0.0}, {5.0, 0.0}};
  EXPECT_EQ(LabelRegions(cells, {{0, 1, 1.0}, {1, 2, 0.2}}),
            (std::vector<bool>{true, true, false}));
}

TEST(RegionLabels, NoLabelsCostLess) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (int round = 0; round < 20; ++round) {
    constexpr size_t kNumCells = 8;
    std::vector<CellCost> cells;
    std::vector<BorderCost> borders;
    for (size_t i = 0; i < kNumCells; ++i) cells.push_back({uniform(random), uniform(random)});
    for (size_t i = 0; i < kNumCells; ++i) {
      for (size_t k = i + 1; k < kNumCells; k += 2) borders.push_back({i, k, uniform(random)});
    }
    double least = std::numeric_limits<double>::max();
    for (unsigned all = 0; all < 1u << kNumCells; ++all) {
      std::vector<bool> labels;
      for (size_t i = 0; i < kNumCells; ++i) labels.push_back((all >> i & 1u) != 0);
      least = std::min(least, CostOf(cells, borders, labels));
    }
    EXPECT_NEAR(CostOf(cells, borders, LabelRegions(cells, borders)), least, 1e-4);
  }
}

}  // namespace
}  // namespace plumbline
