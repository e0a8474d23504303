#pragma once

#include <Eigen/Core>
#include <optional>

#include "core/geometry/planar_pose.h"
#include "core/revisits/visit.h"
#include "core/revisits/visit_grid.h"
#include "core/revisits/visit_surface.h"

namespace plumbline {

// How far from a guess a visit may lie: drift.
struct MatchWindow {
  double position_m = 3.0;  // in x and in y
  double heading_rad = 0.26;
};

// Pose of a later visit in the frame of an earlier one.
struct VisitMatch {
  PlanarPose earlier_from_later;
  // Information on x, y (m, earlier frame) and heading (rad) from the lines that both saw.
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
};

// Finds where the later visit lies: by all poses of a window on a grid (correlative matching,
// Olson 2009, "Real-time correlative scan matching", with bounds from a coarser grid), then by
// Gauss-Newton steps on distances from lines. Nothing where the two visits have little in
// common, where beams of one pass through what the other saw, or where the same fits nearly as
// well elsewhere in the window: along a corridor without doors no place is known again.
std::optional<VisitMatch> MatchVisits(const VisitGrid& earlier_grid,
                                      const VisitSurface& earlier_surface,
                                      const Visit& later,
                                      const PlanarPose& guess,
                                      const MatchWindow& window);

}  // namespace plumbline
