#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/planar_pose.h"
#include "core/registration/spot_grid.h"

namespace plumbline {

// A beam as seen from above, in the model frame of a part: nothing is between its ends.
struct FreeBeam {
  Eigen::Vector2d from;  // m
  Eigen::Vector2d to;    // m
};

// The compared content of a part, in its model frame: spots evenly spaced on its walls, with
// normals to the side that was seen, and some of its beams.
struct PartView {
  std::vector<WallSpot> spots;
  std::vector<FreeBeam> beams;
};

struct PartMatchingOptions {
  double spacing_m = 0.2;           // of the spots
  double max_distance_m = 0.1;      // between spots of one wall, across it
  double min_length_m = 8.0;        // of walls that match, in all
  int min_surfaces = 5;             // that match: a rectangular room has four
  double max_refuted_share = 0.05;  // of the beams, and twice what their own part refutes
  double max_second_share = 0.75;   // of the best candidate's length that another may reach
};

// The pose of part b in the model frame of part a.
struct PartPose {
  PlanarPose a_from_b;
  double length_m = 0.0;       // of the walls that match
  double refuted_share = 0.0;  // of the beams, those that pass through walls of the other part
};

// Either a pose or, in words, why there is none.
struct PartMatch {
  std::optional<PartPose> pose;
  std::string reason;
};

// Finds the pose of part b in the frame of part a without an initial one. There is none where
// the walls that match are few, leave a direction open or are those of one rectangular room,
// or where another pose matches nearly as well: better two parts than a wrong map.
// is_possible, if given: what else is known of the pose; others do not count.
PartMatch MatchParts(const PartView& a,
                     const PartView& b,
                     const PartMatchingOptions& options,
                     const std::function<bool(const PlanarPose&)>& is_possible = {});

}  // namespace plumbline
