#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/registration/visit.h"

namespace plumbline {

// VisitSurface holds the lines that a visit's points lie on, as points with normals, in the
// visit's frame.
class VisitSurface {
 public:
  explicit VisitSurface(const Visit& visit);

  struct Spot {
    Eigen::Vector2d position;  // m
    Eigen::Vector2d normal;    // zero where the points around it are no line
  };
  const std::vector<Spot>& spots() const { return spots_; }
  // The nearest spot on a line within kReach; nullptr: there is none.
  const Spot* Nearest(const Eigen::Vector2d& p) const;

  // Distance beyond which a surface says nothing, m.
  static constexpr double kReach = 0.4;

 private:
  // Calls visit(spot) for those in the cells at and around a point: all within kReach, and
  // some beyond.
  template <typename VisitSpot>
  void ForEachNear(const Eigen::Vector2d& p, const VisitSpot& visit) const;
  Eigen::Vector2d NormalAt(const Eigen::Vector2d& p) const;

  std::vector<Spot> spots_;                         // by cell
  std::vector<std::pair<uint64_t, size_t>> cells_;  // key, first spot; ascending
};

}  // namespace plumbline
