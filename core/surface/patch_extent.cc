#include "core/surface/patch_extent.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace plumbline {

namespace {

constexpr double kCellSize = PatchExtent::kCellSize;

// Calls visit(point) along the piece from a to b, at most half a cell apart, until it is true.
template <typename Visit>
bool AnyAlong(const Eigen::Vector2d& a, const Eigen::Vector2d& b, Visit visit) {
  const int steps = static_cast<int>(std::ceil((b - a).norm() / (0.5 * kCellSize)));
  if (visit(a)) return true;
  const Eigen::Vector2d step = (b - a) / std::max(1, steps);
  for (int i = 1; i <= steps; ++i) {
    if (visit(Eigen::Vector2d(a + i * step))) return true;
  }
  return false;
}

// Calls visit(cell) for the cells along the piece from a to b, each as often as it comes to
// it.
template <typename Visit>
void ForEachCell(const Eigen::Vector2d& a, const Eigen::Vector2d& b, Visit visit) {
  PatchExtent::Cell previous = PatchExtent::CellAt(a);
  visit(previous);
  AnyAlong(a, b, [&](const Eigen::Vector2d& p) {
    const PatchExtent::Cell cell = PatchExtent::CellAt(p);
    if (cell != previous) visit(cell);
    previous = cell;
    return false;
  });
}

double Cross(const Eigen::Vector2d& o, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return (a - o).x() * (b - o).y() - (a - o).y() * (b - o).x();
}

// Andrew's monotone chain; counter-clockwise, without collinear points.
std::vector<Eigen::Vector2d> HullOf(std::vector<Eigen::Vector2d> points) {
  std::sort(points.begin(), points.end(), [](const auto& a, const auto& b) {
    return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
  });
  if (points.size() < 3) return points;
  std::vector<Eigen::Vector2d> hull;
  for (int pass = 0; pass < 2; ++pass) {
    const size_t base = hull.size();
    for (const Eigen::Vector2d& p : points) {
      while (hull.size() >= base + 2 && Cross(hull[hull.size() - 2], hull.back(), p) <= 0.0) {
        hull.pop_back();
      }
      hull.push_back(p);
    }
    hull.pop_back();
    std::reverse(points.begin(), points.end());
  }
  return hull;
}

}  // namespace

void PatchExtent::AddSegment(const Eigen::Vector3d& a_world, const Eigen::Vector3d& b_world) {
  const auto [a, b] = ProjectPiece(a_world, b_world);
  ForEachCell(a, b, [&](const Cell& cell) { cells_.Add(cell, 1); });
  AddCorner(a);
  AddCorner(b);
  constexpr size_t kReduceAt = 512;
  if (hull_points_.size() > kReduceAt) hull_points_ = HullOf(std::move(hull_points_));
}

std::pair<Eigen::Vector2d, Eigen::Vector2d> PatchExtent::ProjectPiece(
    const Eigen::Vector3d& a_world, const Eigen::Vector3d& b_world) const {
  const Eigen::Vector2d a = axes_.Project(a_world);
  Eigen::Vector2d b = axes_.Project(b_world);
  if (axes_.curvature != 0.0) {
    b.x() = a.x() + std::remainder(b.x() - a.x(), axes_.Circumference());
  }
  return {a, b};
}

PatchExtent::Bounds PatchExtent::BoundsAboutCentre() const {
  if (axes_.curvature != 0.0) {
    Bounds ball;
    ball.ball_m = radius_m();
    return ball;
  }
  return {0.5 * (max_ - min_).x() * axes_.u, 0.5 * (max_ - min_).y() * axes_.v, 0.0};
}

void PatchExtent::AddCorner(const Eigen::Vector2d& p) {
  min_ = min_.cwiseMin(p);
  max_ = max_.cwiseMax(p);
  if (!is_upright()) hull_points_.push_back(p);
}

bool PatchExtent::IsNear(const Eigen::Vector3d& a_world,
                         const Eigen::Vector3d& b_world,
                         double max_gap_m) const {
  const auto [a, b] = ProjectPiece(a_world, b_world);
  const Eigen::Array2d gap = Eigen::Array2d::Constant(max_gap_m);
  if ((a.cwiseMax(b).array() + gap < min_.array()).any() ||
      (a.cwiseMin(b).array() - gap > max_.array()).any()) {
    return false;
  }
  const int reach = static_cast<int>(std::ceil(max_gap_m / kCellSize));
  return AnyAlong(
      a, b, [&](const Eigen::Vector2d& p) { return cells_.IsNear(CellAt(p), reach); });
}

bool PatchExtent::IsSeenAt(const Eigen::Vector3d& p_world, double margin_m) const {
  const Eigen::Vector2d uv = Project(p_world);
  return Contains(uv, margin_m) && cells_.Count(CellAt(uv.cwiseMax(min_).cwiseMin(max_))) > 0;
}

bool PatchExtent::GoesOnBeyond(const Eigen::Vector3d& p_world,
                               const Eigen::Vector3d& direction_world) const {
  constexpr double kFrom = 0.3;  // m, past an edge's own cell
  constexpr double kTo = 3.0;    // m, more than a door is wide
  constexpr int kMinShare = 10;  // segments before the point for each that lies beyond it
  const Eigen::Vector2d p = Project(p_world);
  const Eigen::Vector2d direction(axes_.u.dot(direction_world), axes_.v.dot(direction_world));
  const auto count_at = [&](double away_m) {
    return cells_.Count(CellAt(p + away_m * direction));
  };
  const int before = std::max(count_at(-0.5 * kCellSize), count_at(-1.5 * kCellSize));
  for (double away_m = kFrom; away_m < kTo; away_m += kCellSize) {
    if (!Contains(p + away_m * direction, 0.0)) return false;
    if (kMinShare * count_at(away_m) > before) return true;
  }
  return false;
}

bool PatchExtent::OthersAreNear(const Eigen::Vector3d& a_world,
                                const Eigen::Vector3d& b_world,
                                double max_gap_m) const {
  // A straight piece comes to a cell once.
  if (cells_.Count(CellAt(axes_.Project(a_world))) > 1) return true;
  std::vector<Cell> own;
  const auto [a, b] = ProjectPiece(a_world, b_world);
  ForEachCell(a, b, [&](const Cell& cell) { own.push_back(cell); });
  const auto is_others = [&](const Cell& cell) {
    return cells_.Count(cell) > std::count(own.begin(), own.end(), cell);
  };
  if (std::any_of(own.begin(), own.end(), is_others)) return true;
  const int reach = static_cast<int>(std::ceil(max_gap_m / kCellSize));
  for (const Cell& cell : own) {
    for (int i = cell.first - reach; i <= cell.first + reach; ++i) {
      for (int j = cell.second - reach; j <= cell.second + reach; ++j) {
        if (is_others({i, j})) return true;
      }
    }
  }
  return false;
}

PatchExtent::Cell PatchExtent::CellFrom(const PatchExtent& other, const Cell& cell) const {
  const Eigen::Vector2d middle((cell.first + 0.5) * kCellSize,
                               (cell.second + 0.5) * kCellSize);
  return CellAt(Project(other.ToWorld(middle)));
}

bool PatchExtent::MayBeNear(const PatchExtent& other, double max_gap_m) const {
  if (empty() || other.empty()) return false;
  Eigen::Array2d low = Eigen::Array2d::Constant(1e300);
  Eigen::Array2d high = -low;
  for (const double u : {other.min_.x(), other.max_.x()}) {
    for (const double v : {other.min_.y(), other.max_.y()}) {
      const Eigen::Vector2d corner = Project(other.ToWorld({u, v}));
      low = low.min(corner.array());
      high = high.max(corner.array());
    }
  }
  if (axes_.curvature != 0.0 || other.axes_.curvature != 0.0) {
    // The corners do not tell how far an arc goes round.
    low.x() = -1e300;
    high.x() = 1e300;
  }
  // Cells reach beyond the rectangles, and the gap counts in whole cells.
  const double reach = max_gap_m + 5.0 * kCellSize;
  return (low - reach <= max_.array()).all() && (high + reach >= min_.array()).all();
}

bool PatchExtent::IsNear(const PatchExtent& other, double max_gap_m) const {
  if (!MayBeNear(other, max_gap_m)) return false;
  const int reach = static_cast<int>(std::ceil(max_gap_m / kCellSize));
  return other.cells_.Any(
      [&](const Cell& cell, int) { return cells_.IsNear(CellFrom(other, cell), reach); });
}

double PatchExtent::OverlapWith(const PatchExtent& other) const {
  if (empty()) return 0.0;
  int num_shared = 0;
  cells_.Any([&](const Cell& cell, int) {
    if (other.cells_.Count(other.CellFrom(*this, cell)) > 0) ++num_shared;
    return false;
  });
  return static_cast<double>(num_shared) / cells_.num_occupied();
}

void PatchExtent::Merge(const PatchExtent& other) {
  other.cells_.Any([&](const Cell& cell, int count) {
    cells_.Add(CellFrom(other, cell), count);
    return false;
  });
  for (const Eigen::Vector2d& uv : other.Outline()) AddCorner(Project(other.ToWorld(uv)));
}

double PatchExtent::area_m2() const { return cells_.num_occupied() * kCellSize * kCellSize; }

std::vector<Eigen::Vector2d> PatchExtent::Outline() const {
  if (empty()) return {};
  if (!is_upright()) return HullOf(hull_points_);
  return {min_, {max_.x(), min_.y()}, max_, {min_.x(), max_.y()}};
}

std::vector<Eigen::Vector3d> ComparedPoints(const PatchExtent& extent) {
  const Eigen::Vector2d low = extent.min_corner();
  const Eigen::Vector2d high = extent.max_corner();
  const auto at = [&](double share) {
    return extent.ToWorld({low.x() + share * (high - low).x(), 0.5 * (low.y() + high.y())});
  };
  if (extent.axes().curvature == 0.0) return {at(0.5)};
  return {at(0.0), at(0.5), at(1.0)};
}

}  // namespace plumbline
