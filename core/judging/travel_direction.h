#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/judging/sampled_line.h"

namespace plumbline {

// StepMove is how a level scanner moved in a step of half a second, by the traces of walls.
struct StepMove {
  int64_t begin_ns = 0;
  int64_t end_ns = 0;
  Eigen::Vector2d move = Eigen::Vector2d::Zero();  // in its frame at the begin, m
  double turn_rad = 0.0;                           // to the left, about its z
};

// Finds the steps in which walls show both directions of a move that is long enough to have a
// direction: from one scan line to another one half a second later, each wall's distance
// changes by the travelled way along the wall's normal, whatever the turn. lines: of a level
// scanner, in the order of time.
std::vector<StepMove> FindMoves(const std::vector<SampledLine>& lines);

// The direction in which a level scanner travels, in its own frame.
struct TravelDirection {
  double angle_rad = 0.0;   // from the scanner's x axis
  double spread_rad = 0.0;  // median deviation of single steps from it
  int num_steps = 0;        // of half a second, in which the scanner moved straight on
};

// Finds it from a scanner's moves. Nothing where there are too few, or in no clear direction.
std::optional<TravelDirection> FindTravelDirection(const std::vector<StepMove>& moves);

}  // namespace plumbline
