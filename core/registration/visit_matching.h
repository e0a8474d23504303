#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/geometry/planar_pose.h"
#include "core/registration/visit.h"
#include "core/registration/visit_grid.h"
#include "core/registration/visit_surface.h"

namespace plumbline {

// MatchWindow is the space around a guess in which a visit is looked for: the drift.
struct MatchWindow {
  double position_m = 3.0;                        // in x and in y
  std::vector<double> turns = TurnsWithin(0.26);  // rad, from the guess, that are tried
  double min_score = 0.2;  // of the mean fit of the points: below it nothing is in common

  // All turns up to one, as close together as matching needs them.
  static std::vector<double> TurnsWithin(double heading_rad);
};

// The window of a visit of which nothing is known but that its middle lies within a distance:
// the turns under which the lines of both have the same directions.
MatchWindow WindowByDirections(const VisitSurface& earlier,
                               const VisitSurface& later,
                               double position_m);

// Pose of a later visit in the frame of an earlier one.
struct VisitMatch {
  PlanarPose earlier_from_later;
  // Information on x, y (m, earlier frame) and heading (rad) from the lines that both saw.
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
};

// Finds where the later visit lies: by all poses of a window on a grid (correlative matching,
// Olson 2009, "Real-time correlative scan matching", with bounds from coarser grids), then by
// Gauss-Newton steps on distances from lines. Nothing where the two visits have little in
// common, where beams of one pass through what the other saw, or where the same fits nearly as
// well elsewhere in the window: along a corridor without doors no place is known again.
std::optional<VisitMatch> MatchVisits(const VisitGrid& earlier_grid,
                                      const VisitSurface& earlier_surface,
                                      const Visit& later,
                                      const PlanarPose& guess,
                                      const MatchWindow& window);

}  // namespace plumbline
