#include "core/registration/visit_surface.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <iterator>

namespace plumbline {
namespace {

constexpr int kMinPoints = 5;       // of a line
constexpr double kMaxRatio = 0.15;  // of a line's variance across to that along it

uint64_t KeyOf(const Eigen::Vector2d& p, int right, int up) {
  constexpr int64_t kOffset = int64_t{1} << 30;
  const auto cell = [](double value) {
    return static_cast<int64_t>(std::floor(value / VisitSurface::kReach)) + kOffset;
  };
  return (static_cast<uint64_t>(cell(p.x()) + right) << 32) |
         static_cast<uint64_t>(cell(p.y()) + up);
}

}  // namespace

VisitSurface::VisitSurface(const Visit& visit) {
  for (const Eigen::Vector2d& point : visit.points) {
    spots_.push_back({point, Eigen::Vector2d::Zero()});
  }
  std::stable_sort(spots_.begin(), spots_.end(), [](const Spot& a, const Spot& b) {
    return KeyOf(a.position, 0, 0) < KeyOf(b.position, 0, 0);
  });
  for (size_t i = 0; i < spots_.size(); ++i) {
    const uint64_t key = KeyOf(spots_[i].position, 0, 0);
    if (cells_.empty() || cells_.back().first != key) cells_.emplace_back(key, i);
  }
  std::vector<Eigen::Vector2d> normals;
  for (const Spot& spot : spots_) normals.push_back(NormalAt(spot.position));
  for (size_t i = 0; i < spots_.size(); ++i) spots_[i].normal = normals[i];
}

template <typename VisitSpot>
void VisitSurface::ForEachNear(const Eigen::Vector2d& p, const VisitSpot& visit) const {
  for (int up = -1; up <= 1; ++up) {
    for (int right = -1; right <= 1; ++right) {
      const uint64_t key = KeyOf(p, right, up);
      const auto cell =
          std::lower_bound(cells_.begin(), cells_.end(), std::make_pair(key, size_t{0}));
      if (cell == cells_.end() || cell->first != key) continue;
      const auto next = std::next(cell);
      const size_t end = next == cells_.end() ? spots_.size() : next->second;
      for (size_t i = cell->second; i < end; ++i) visit(spots_[i]);
    }
  }
}

Eigen::Vector2d VisitSurface::NormalAt(const Eigen::Vector2d& p) const {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  Eigen::Matrix2d products = Eigen::Matrix2d::Zero();
  int num_points = 0;
  ForEachNear(p, [&](const Spot& spot) {
    const Eigen::Vector2d from_p = spot.position - p;
    if (from_p.norm() > kReach) return;
    sum += from_p;
    products += from_p * from_p.transpose();
    ++num_points;
  });
  if (num_points < kMinPoints) return Eigen::Vector2d::Zero();
  const Eigen::Vector2d mean = sum / num_points;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver;
  solver.computeDirect(products / num_points - mean * mean.transpose());
  const bool is_line = solver.eigenvalues()[0] < kMaxRatio * solver.eigenvalues()[1];
  return is_line ? Eigen::Vector2d(solver.eigenvectors().col(0)) : Eigen::Vector2d::Zero();
}

const VisitSurface::Spot* VisitSurface::Nearest(const Eigen::Vector2d& p) const {
  const Spot* nearest = nullptr;
  double least_m = kReach;
  ForEachNear(p, [&](const Spot& spot) {
    const double distance_m = (spot.position - p).norm();
    if (distance_m >= least_m || spot.normal.isZero()) return;
    least_m = distance_m;
    nearest = &spot;
  });
  return nearest;
}

}  // namespace plumbline
