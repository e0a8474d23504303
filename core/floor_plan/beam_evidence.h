#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "core/floor_plan/map_cloud.h"
#include "core/floor_plan/storey_levels.h"
#include "core/floor_plan/wall_faces.h"

namespace plumbline {

// FreeGrid counts the beams that passed each square of the plan, at any height of the storey's
// band.
class FreeGrid {
 public:
  static constexpr double kCellM = 0.05;

  FreeGrid() = default;
  explicit FreeGrid(const Eigen::AlignedBox2d& box);

  // Counts a beam's level way from a to b, once in each square, about.
  void AddBeam(const Eigen::Vector2d& a, const Eigen::Vector2d& b);
  // Whether at least two beams passed the square of a point.
  bool IsFree(const Eigen::Vector2d& p) const;
  const Eigen::AlignedBox2d& box() const { return box_; }

 private:
  int Index(const Eigen::Vector2d& p) const;  // -1 outside

  Eigen::AlignedBox2d box_;
  int num_columns_ = 0;
  int num_rows_ = 0;
  std::vector<uint16_t> counts_;
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
