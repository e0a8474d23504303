#pragma once

#include <Eigen/Core>
#include <vector>

namespace plumbline {

struct Face;

// A piece of furniture is made of boxes, which hide what is behind them and are part of the
// truth: a box (cupboard, or a pane where it is of glass), a table on four legs, or a shelf of
// boards that is open in front and behind.
struct Furniture {
  enum class Kind { kBox, kTable, kShelf };

  Kind kind = Kind::kBox;
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  // of its middle, building frame, m
  Eigen::Vector3d size = Eigen::Vector3d::Ones();      // length, width, height, m
  double yaw_rad = 0.0;                                // of its length from the x axis
  double bottom_m = 0.0;                               // above the floor
  bool glass = false;
};

// Adds the faces of all boxes of the piece.
void AddFurniture(const Furniture& piece, double floor_height, std::vector<Face>* faces);

}  // namespace plumbline
