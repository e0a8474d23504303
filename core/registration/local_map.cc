#include "core/registration/local_map.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/geometry/cell_key.h"

namespace plumbline {
namespace {

// With fewer points, or those of one scan, a distribution says too little.
constexpr int kMinPoints = 5;
// Number of points after which a cell takes in no more.
constexpr int kEnoughPoints = 60;
// The directions are found anew when a cell has grown by this share.
constexpr double kGrowth = 1.3;
// A direction is determined where the points spread by less than this share of the cell's side
// (standard deviation): of a surface that crosses the cell it is 0.29 along the surface.
constexpr double kMaxThickness = 0.12;
// Across a direction with more spread than this the points cover a patch.
constexpr double kMinSpread = 0.15;
// Least number of points of a scan on a post. Far along a wall a cell gets one point of a
// level scan line, at much the same spot each time: a post that would go along with the rig.
// Scan lines of rigs with level scanners alone are taken to be dense enough.
constexpr double kMinPerScanOfPost = 2.5;
// A scan plane is level where its normal's vertical part is at least this.
constexpr double kLevel = 0.96;

}  // namespace

void LocalCell::Add(const Eigen::Vector3d& p_world,
                    const Eigen::Vector3d& from_world,
                    double scan_normal_z,
                    int scan_index) {
  if (num_points_ == 0) first_scan_ = scan_index;
  if (num_points_ == 0 || scan_index != last_scan_) ++num_scans_;
  const Eigen::Vector3d p = p_world - centre_;
  sum_ += p;
  products_.noalias() += p * p.transpose();
  sum_views_ += (from_world - p_world).normalized();
  sum_scan_normal_z2_ += scan_normal_z * scan_normal_z;
  ++num_points_;
  last_scan_ = scan_index;
}

bool LocalCell::IsOtherSide(const Eigen::Vector3d& p_world,
                            const Eigen::Vector3d& from_world) const {
  if (num_directions_ != 1) return false;  // a post has no sides
  return directions_[0].normal.dot(from_world - p_world) < 0.0;
}

void LocalCell::Determine(bool planar, double cell_m) {
  num_determined_ = num_points_;
  num_directions_ = 0;
  const Eigen::Vector3d mean = sum_ / num_points_;
  Eigen::Matrix3d covariance = products_ / num_points_ - mean * mean.transpose();
  const double max_variance = kMaxThickness * kMaxThickness * cell_m * cell_m;
  const double min_spread = kMinSpread * kMinSpread * cell_m * cell_m;
  const bool is_thin = !planar && num_points_ < kMinPerScanOfPost * num_scans_;
  const int max_directions = is_thin ? 1 : 2;
  const auto take = [&](const Eigen::Vector3d& axis, double variance) {
    if (variance > max_variance || num_directions_ == max_directions) return;
    const double side = axis.dot(sum_views_) < 0.0 ? -1.0 : 1.0;
    directions_[static_cast<size_t>(num_directions_++)] = {side * axis, variance};
  };
  const bool level = planar || sum_scan_normal_z2_ > kLevel * kLevel * num_points_;
  if (level) {
    // Upright surfaces: only the plan counts.
    const Eigen::Matrix2d in_plan = covariance.topLeftCorner<2, 2>();
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver;
    solver.computeDirect(in_plan);
    for (int i = 0; i < 2; ++i) {
      const Eigen::Vector2d axis = solver.eigenvectors().col(i);
      take({axis.x(), axis.y(), 0.0}, std::max(0.0, solver.eigenvalues()[i]));
    }
    return;
  }
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(covariance);
  const Eigen::Vector3d& spread = solver.eigenvalues();
  if (spread[1] < min_spread) return;  // a line: no sweep has covered what lies across it
  take(solver.eigenvectors().col(0), std::max(0.0, spread[0]));
}

LocalMap::LocalMap(double cell_m, bool planar, int min_age_scans)
    : cell_m_(cell_m), planar_(planar), min_age_scans_(min_age_scans) {}

LocalMap::Key LocalMap::KeyOf(const Eigen::Vector3d& p_world) const {
  const auto index = [&](int axis) {
    return static_cast<int64_t>(std::floor(p_world[axis] / cell_m_));
  };
  return CellKey({index(0), index(1), index(2)});
}

Eigen::Vector3d LocalMap::CentreOf(Key key) const {
  const std::array<int64_t, 3> cell = CellOfKey(key);
  Eigen::Vector3d centre;
  for (int axis = 0; axis < 3; ++axis) {
    centre[axis] = (static_cast<double>(cell[static_cast<size_t>(axis)]) + 0.5) * cell_m_;
  }
  return centre;
}

LocalCell* LocalMap::CellIn(std::unordered_map<Key, LocalCell>* cells,
                            Key key,
                            bool may_found) const {
  if (may_found) return &cells->try_emplace(key, CentreOf(key)).first->second;
  const auto it = cells->find(key);
  return it == cells->end() ? nullptr : &it->second;
}

void LocalMap::Add(const Eigen::Vector3d& p_world,
                   const Eigen::Vector3d& from_world,
                   const Eigen::Vector3d& scan_normal,
                   int scan_index,
                   bool may_found) {
  const Key key = KeyOf(p_world);
  if (last_.Get(key) == nullptr) last_.Set(key, CellIn(&cells_, key, may_found));
  LocalCell* found = last_.Get(key);
  if (found != nullptr && found->IsOtherSide(p_world, from_world)) {
    found = CellIn(&other_sides_, key, may_found);
  }
  if (found == nullptr) return;
  LocalCell& cell = *found;
  if (cell.num_points_ >= kEnoughPoints && cell.num_determined_ > 0) {
    cell.Touch(scan_index);
    return;
  }
  cell.Add(p_world, from_world, scan_normal.z(), scan_index);
  if (cell.num_points_ < kMinPoints || scan_index <= cell.first_scan_) return;
  if (cell.num_points_ < kGrowth * cell.num_determined_ && cell.num_points_ < kEnoughPoints) {
    return;
  }
  cell.Determine(planar_, cell_m_);
}

const LocalCell* LocalMap::Find(const Eigen::Vector3d& p_world,
                                const Eigen::Vector3d& from_world) const {
  const Key key = KeyOf(p_world);
  auto it = cells_.find(key);
  if (it == cells_.end()) return nullptr;
  if (it->second.IsOtherSide(p_world, from_world)) {
    it = other_sides_.find(key);
    if (it == other_sides_.end()) return nullptr;
  }
  const LocalCell& cell = it->second;
  return cell.num_determined_ > 0 && cell.age_scans() >= min_age_scans_ ? &cell : nullptr;
}

void LocalMap::ForgetBefore(int scan_index) {
  last_.Forget();
  for (auto* cells : {&cells_, &other_sides_}) {
    for (auto it = cells->begin(); it != cells->end();) {
      it = it->second.last_scan() < scan_index ? cells->erase(it) : std::next(it);
    }
  }
}

}  // namespace plumbline
