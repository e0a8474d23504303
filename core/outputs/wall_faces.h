#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/outputs/map_cloud.h"
#include "core/outputs/plan_scales.h"
#include "core/outputs/storey_levels.h"
#include "core/outputs/wall_curve.h"

namespace plumbline {

// WallColumn holds the beam counts of 5 cm of a wall's face, from the floor up: at each of
// eight heights of the storey's band, how many hit the face and how many passed through it.
struct WallColumn {
  static constexpr size_t kNumLevels = 8;
  static constexpr size_t kNumLow = 3;  // of these, below window sills: up to 0.8 m
  std::array<uint16_t, kNumLevels> hits = {};
  std::array<uint16_t, kNumLevels> passes = {};
  uint16_t hits_above = 0;  // above the band: lintels
  // At four heights from the band up to the ceiling: beams that hit the face, and beams that
  // passed it and hit a wall up to kMaxFurnitureM behind.
  static constexpr size_t kNumHigh = 4;
  static constexpr double kMaxFurnitureM = 0.8;
  std::array<uint16_t, kNumHigh> high_hits = {};
  std::array<uint16_t, kNumHigh> high_passes = {};
  // Number of passes that came from or went more than kMaxThicknessM behind the face.
  uint16_t deep_passes = 0;
  // Number of the deep passes that ended on a ceiling: what lies behind the face is indoors.
  uint16_t ceiling_passes = 0;
  bool rig_passed = false;

  // Whether it ends below the ceiling, before a wall: a cupboard, say. From some height up to
  // the ceiling, more beams pass it than hit it.
  bool EndsBelowCeiling() const {
    int hit = 0;
    int passed = 0;
    for (size_t i = kNumHigh; i-- > 0;) {
      hit += high_hits[i];
      passed += high_passes[i];
      if (passed >= kMinBeams && passed > hit) return true;
    }
    return false;
  }

  // Whether beams say only what is above the band: something stands before it.
  bool IsSeenAboveOnly() const {
    bool in_band = false;
    for (size_t i = 0; i < kNumLevels; ++i) in_band |= hits[i] + passes[i] > 0;
    return !in_band && hits_above >= kMinBeams && !EndsBelowCeiling();
  }

  // Returns whether more beams than strays went deep behind the face: ranges are noisy.
  bool IsDeep() const {
    constexpr int kMinShare = 5;  // passes for each deep one
    int all = 0;
    for (const uint16_t count : passes) all += count;
    return deep_passes > 1 && kMinShare * deep_passes > all;
  }
};

// Stretch is a part of a face, m; empty at first.
struct Stretch {
  float from_m = std::numeric_limits<float>::max();
  float to_m = std::numeric_limits<float>::lowest();

  bool IsEmpty() const { return from_m > to_m; }
  void Extend(double s) {
    from_m = std::min(from_m, static_cast<float>(s));
    to_m = std::max(to_m, static_cast<float>(s));
  }
};

// WallFace is one face of a wall: surfaces of the map that continue each other, as one curve
// in plan, and what beams say of it, column by column.
struct WallFace {
  static constexpr double kColumnM = 0.05;

  WallCurve curve;             // of its strongest surface
  std::vector<size_t> planes;  // positions in the result's planes; the strongest first
  double start_m = 0.0;        // parameter at which the first column begins
  std::vector<WallColumn> columns;
  // Hits of each column of each surface, in the order of `planes`.
  std::vector<std::vector<uint32_t>> plane_hits;
  std::vector<Stretch> hit_ends;   // of each column, the outermost hits
  std::vector<Stretch> pass_ends;  // and the outermost beams that passed

  double end_m() const { return start_m + kColumnM * static_cast<double>(columns.size()); }
  // The column of a parameter; -1 outside.
  int ColumnOf(double s) const {
    const double column = (s - start_m) / kColumnM;
    return column >= 0.0 && column < static_cast<double>(columns.size())
               ? static_cast<int>(column)
               : -1;
  }
};

// The heights of the storey at the foot of a face, on the side from which it was seen.
StoreyHeights HeightsBefore(const WallCurve& curve,
                            const Eigen::Vector2d& p,
                            const StoreyLevel& storey);

// The faces of a storey's walls: upright and leaning surfaces that are hit within the storey's
// band and reach above it, or up to its ceiling, and those that begin higher and reach the
// ceiling: lintels, and walls behind furniture. What ends lower is furniture or a parapet.
// Columns are empty, and reach over the box of all walls.
std::vector<WallFace> FindWallFaces(const std::vector<PlanePatch>& planes,
                                    const std::vector<CloudPoint>& points,
                                    const StoreyLevel& storey);

}  // namespace plumbline
