#pragma once

#include <optional>
#include <vector>

#include "core/judging/sampled_line.h"

namespace plumbline {

// The direction in which a level scanner travels, in its own frame.
struct TravelDirection {
  double angle_rad = 0.0;   // from the scanner's x axis
  double spread_rad = 0.0;  // median deviation of single steps from it
  int num_steps = 0;        // of half a second, in which the scanner moved straight on
};

// Finds it from the traces of walls: from one scan line to another one half a second later,
// each wall's distance changes by the travelled way along the wall's normal, whatever the
// turn. Nothing where the scanner did not move enough, or in no clear direction. lines: of a
// level scanner, in the order of time.
std::optional<TravelDirection> FindTravelDirection(const std::vector<SampledLine>& lines);

}  // namespace plumbline
