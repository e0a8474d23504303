#include "core/registration/visit_surface.h"

#include <Eigen/Eigenvalues>
#include <utility>
#include <vector>

namespace plumbline {
namespace {

constexpr int kMinPoints = 5;       // of a line
constexpr double kMaxRatio = 0.15;  // of a line's variance across to that along it

// Of the line that the spots around a point lie on; zero where they lie on none.
Eigen::Vector2d NormalAt(const Eigen::Vector2d& p, const SpotGrid& grid) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  Eigen::Matrix2d products = Eigen::Matrix2d::Zero();
  int num_points = 0;
  grid.ForEachNear(p, [&](const WallSpot& spot) {
    const Eigen::Vector2d from_p = spot.position - p;
    if (from_p.norm() > VisitSurface::kReach) return;
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

SpotGrid WithNormals(const Visit& visit) {
  std::vector<WallSpot> points;
  for (const Eigen::Vector2d& point : visit.points) {
    points.push_back({point, Eigen::Vector2d::Zero()});
  }
  const SpotGrid without(std::move(points), VisitSurface::kReach);
  std::vector<WallSpot> spots = without.spots();
  for (WallSpot& spot : spots) spot.normal = NormalAt(spot.position, without);
  return SpotGrid(std::move(spots), VisitSurface::kReach);
}

}  // namespace

VisitSurface::VisitSurface(const Visit& visit) : grid_(WithNormals(visit)) {}

const WallSpot* VisitSurface::Nearest(const Eigen::Vector2d& p) const {
  const WallSpot* nearest = nullptr;
  double least_m = kReach;
  grid_.ForEachNear(p, [&](const WallSpot& spot) {
    const double distance_m = (spot.position - p).norm();
    if (distance_m >= least_m || spot.normal.isZero()) return;
    least_m = distance_m;
    nearest = &spot;
  });
  return nearest;
}

}  // namespace plumbline
