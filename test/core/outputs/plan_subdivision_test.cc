#include "core/outputs/plan_subdivision.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace plumbline {
namespace {

double LoopArea(const PlanSubdivision& plan, int start) {
  double twice = 0.0;
  int at = start;
  do {
    const auto& edge = plan.half_edges[static_cast<size_t>(at)];
    const Eigen::Vector2d& a = plan.points[static_cast<size_t>(edge.origin)];
    const Eigen::Vector2d& b = plan.points[static_cast<size_t>(edge.target)];
    twice += a.x() * b.y() - a.y() * b.x();
    at = edge.next;
  } while (at != start);
  return 0.5 * twice;
}

std::vector<PlanSegment> Square(double low, double high, int label) {
  return {{{low, low}, {high, low}, label},
          {{high, low}, {high, high}, label},
          {{high, high}, {low, high}, label},
          {{low, high}, {low, low}, label}};
}

TEST(PlanSubdivision, ACrossMakesFourCellsOfASquare) {
  std::vector<PlanSegment> segments = Square(0.0, 4.0, 7);
  segments.push_back({{1.0, -1.0}, {1.0, 5.0}, 1});
  segments.push_back({{-1.0, 1.0}, {5.0, 1.0}, 2});
  const PlanSubdivision plan = Subdivide(segments);
  std::vector<double> areas;
  int num_unbounded = 0;
  for (const PlanSubdivision::Cell& cell : plan.cells) {
    if (cell.is_unbounded) {
      ++num_unbounded;
    } else {
      ASSERT_EQ(cell.loops.size(), 1u);
      areas.push_back(LoopArea(plan, cell.loops[0]));
    }
  }
  std::sort(areas.begin(), areas.end());
  ASSERT_EQ(areas.size(), 4u);
  EXPECT_NEAR(areas[0], 1.0, 1e-12);
  EXPECT_NEAR(areas[1], 3.0, 1e-12);
  EXPECT_NEAR(areas[2], 3.0, 1e-12);
  EXPECT_NEAR(areas[3], 9.0, 1e-12);
  EXPECT_EQ(num_unbounded, 1);
}

TEST(PlanSubdivision, HalfEdgesFitTogether) {
  std::vector<PlanSegment> segments = Square(0.0, 4.0, 7);
  segments.push_back({{1.0, 1.0}, {1.0, 5.0}, 1});
  const PlanSubdivision plan = Subdivide(segments);
  for (size_t i = 0; i < plan.half_edges.size(); ++i) {
    const auto& edge = plan.half_edges[i];
    const auto& twin = plan.half_edges[static_cast<size_t>(edge.twin)];
    EXPECT_EQ(static_cast<size_t>(twin.twin), i);
    EXPECT_EQ(twin.origin, edge.target);
    EXPECT_EQ(twin.label, edge.label);
    const auto& next = plan.half_edges[static_cast<size_t>(edge.next)];
    EXPECT_EQ(next.origin, edge.target);
    EXPECT_EQ(next.cell, edge.cell);
    EXPECT_TRUE(edge.label == 7 || edge.label == 1);
  }
}

TEST(PlanSubdivision, ACellMayHaveAHole) {
  std::vector<PlanSegment> segments = Square(0.0, 4.0, 0);
  const std::vector<PlanSegment> inner = Square(1.0, 2.0, 1);
  segments.insert(segments.end(), inner.begin(), inner.end());
  const PlanSubdivision plan = Subdivide(segments);
  double ring = 0.0;
  for (const PlanSubdivision::Cell& cell : plan.cells) {
    if (cell.loops.size() != 2) continue;
    for (const int loop : cell.loops) ring += LoopArea(plan, loop);
  }
  EXPECT_NEAR(ring, 15.0, 1e-12);
}

TEST(PlanSubdivision, FacesAMillimetreApartAreTwo) {
  std::vector<PlanSegment> segments = Square(0.0, 4.0, 0);
  segments.push_back({{2.0, -1.0}, {2.0, 5.0}, 1});
  segments.push_back({{2.001, -1.0}, {2.001, 5.0}, 2});
  EXPECT_EQ(Subdivide(segments).cells.size(), 4u);
}

TEST(PlanSubdivision, SegmentsOnEachOtherHaveTheLeastLabel) {
  const PlanSubdivision plan =
      Subdivide({{{0.0, 0.0}, {2.0, 0.0}, 5}, {{0.0, 0.0}, {2.0, 0.0}, 3}});
  ASSERT_EQ(plan.half_edges.size(), 2u);
  EXPECT_EQ(plan.half_edges[0].label, 3);
}

}  // namespace
}  // namespace plumbline
