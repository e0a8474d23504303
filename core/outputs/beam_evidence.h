#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "core/outputs/map_cloud.h"
#include "core/outputs/storey_levels.h"
#include "core/outputs/wall_faces.h"

namespace plumbline {

// FreeGrid counts the beams that passed each square of the plan, at any height of the storey's
// band. Squares lie in rows along x, and are numbered from the lower left corner of the box.
// Memory is taken for blocks of squares that beams reached only: a wall far away costs little.
class FreeGrid {
 public:
  static constexpr double kCellM = 0.05;

  FreeGrid() = default;
  // Throws Error where the box is larger than any building.
  explicit FreeGrid(const Eigen::AlignedBox2d& box);

  // Counts a beam's level way from a to b, once in each square, about.
  void AddBeam(const Eigen::Vector2d& a, const Eigen::Vector2d& b);
  // Number of squares of a row, from column `from` to before column `to`, that at least two
  // beams passed.
  int CountFree(int row, int from, int to) const;
  const Eigen::AlignedBox2d& box() const { return box_; }

 private:
  static constexpr int kBlock = 16;  // squares along a block's side
  using Block = std::array<uint16_t, kBlock * kBlock>;

  Eigen::AlignedBox2d box_;
  int num_columns_ = 0;
  int num_rows_ = 0;
  std::unordered_map<int64_t, Block> blocks_;  // by row of blocks * num_columns_ + column
};

// Fills the columns of the faces, and returns where beams passed. margin_m: how far before its
// end a beam counts as passing no longer; above all noise of the ranges.
FreeGrid CollectEvidence(const std::vector<PlanePatch>& planes,
                         const std::vector<CloudPoint>& points,
                         const BeamOrigins& origins,
                         const StoreyLevel& storey,
                         double margin_m,
                         std::vector<WallFace>* faces);

// Notes in the columns where the rig itself went through a face. way: its positions in the
// storey, in the order of time.
void NoteWay(const std::vector<Eigen::Vector2d>& way, std::vector<WallFace>* faces);

}  // namespace plumbline
