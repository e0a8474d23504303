#include "core/geometry/plan_grid.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <set>

namespace plumbline {
namespace {

// Whether the piece from a to b meets the box, by the ranges of its parameter.
bool Meets(const Eigen::Vector2d& a,
           const Eigen::Vector2d& b,
           const Eigen::AlignedBox2d& box) {
  double from = 0.0;
  double to = 1.0;
  for (int i = 0; i < 2; ++i) {
    const double step = b[i] - a[i];
    if (step == 0.0) {
      if (a[i] < box.min()[i] || a[i] > box.max()[i]) return false;
      continue;
    }
    const double t0 = (box.min()[i] - a[i]) / step;
    const double t1 = (box.max()[i] - a[i]) / step;
    from = std::max(from, std::min(t0, t1));
    to = std::min(to, std::max(t0, t1));
  }
  return from <= to;
}

std::vector<int> Near(const Eigen::Vector2d& a, const Eigen::Vector2d& b, PlanGrid* grid) {
  std::vector<int> found;
  grid->ForEachNear(a, b, [&](int index) { found.push_back(index); });
  return found;
}

TEST(PlanGrid, FindsAllThatIsMetOnceAndFewOthers) {
  std::mt19937_64 random(3);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  std::vector<Eigen::AlignedBox2d> boxes(1);  // an empty one
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector2d corner(uniform(-50.0, 50.0), uniform(-30.0, 30.0));
    boxes.emplace_back(corner, corner + Eigen::Vector2d(uniform(0.0, 5.0), uniform(0.0, 0.5)));
  }
  PlanGrid grid(boxes);
  size_t num_found = 0;
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector2d a(uniform(-60.0, 60.0), uniform(-40.0, 40.0));
    Eigen::Vector2d b = a + Eigen::Vector2d(uniform(-10.0, 10.0), uniform(-10.0, 10.0));
    if (i % 10 == 0) b.x() = a.x();
    if (i % 11 == 0) b.y() = a.y();
    const std::vector<int> found = Near(a, b, &grid);
    const std::set<int> distinct(found.begin(), found.end());
    EXPECT_EQ(found.size(), distinct.size());
    EXPECT_EQ(distinct.count(0), 0u);
    for (size_t k = 1; k < boxes.size(); ++k) {
      if (!Meets(a, b, boxes[k])) continue;
      EXPECT_EQ(distinct.count(static_cast<int>(k)), 1u) << k;
    }
    num_found += found.size();
  }
  EXPECT_LT(num_found, 1000 * boxes.size() / 10);
}

TEST(PlanGrid, NoBoxesAndHugeOnes) {
  PlanGrid none({});
  EXPECT_TRUE(Near({0.0, 0.0}, {1.0, 1.0}, &none).empty());
  const double huge = 1e9;
  PlanGrid one(
      {Eigen::AlignedBox2d(Eigen::Vector2d(-huge, -huge), Eigen::Vector2d(huge, huge))});
  EXPECT_EQ(Near({3.0, 4.0}, {5.0, 6.0}, &one).size(), 1u);
}

}  // namespace
}  // namespace plumbline
