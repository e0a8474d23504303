#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/registration/spot_grid.h"
#include "core/registration/visit.h"

namespace plumbline {

// VisitSurface holds the lines that a visit's points lie on, as points with normals, in the
// visit's frame.
class VisitSurface {
 public:
  explicit VisitSurface(const Visit& visit);

  // Without a normal where the points around one are no line.
  const std::vector<WallSpot>& spots() const { return grid_.spots(); }
  // The nearest spot on a line within kReach; nullptr: there is none.
  const WallSpot* Nearest(const Eigen::Vector2d& p) const;

  // Distance beyond which a surface says nothing, m.
  static constexpr double kReach = 0.4;

 private:
  SpotGrid grid_;
};

}  // namespace plumbline
