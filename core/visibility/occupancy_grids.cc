#include "core/visibility/occupancy_grids.h"

#include <algorithm>
#include <map>
#include <utility>

#include "core/surface/patch_extent.h"
#include "core/visibility/beam_tests.h"

namespace plumbline {
namespace {

// Least number of beams that have to agree: a single one may be wrong.
constexpr int kMinCount = 2;
// An opening lets at least this share of the beams through...
constexpr double kMinShare = 0.1;
// ...and most of them for a plane without height: level scan planes see furniture's gaps.
// Cells where most beams went through are open, whatever the cell of the other grid shows.
constexpr double kMostBeams = 0.5;
// An opening goes on along an upright edge where beams on the plane are fewer than this share
// of those that went through.
constexpr double kContradiction = 0.25;

bool HasHeight(const PatchExtent& extent) {
  return extent.max_corner().y() - extent.min_corner().y() > PatchExtent::kCellSize;
}

CellGrid::Cell CellOf(double u, double v, bool narrow_along_u) {
  return {CellIndex(u / (narrow_along_u ? kOpeningCell : PatchExtent::kCellSize)),
          CellIndex(v / (narrow_along_u ? PatchExtent::kCellSize : kOpeningCell))};
}

// Without height there are no level edges: cells that are wide along u would only blur.
bool HasCells(bool has_height, bool narrow_along_u) { return narrow_along_u || has_height; }

// The level of a cell, of a strip's also where hardly any beam hits: that of a cell beside it.
int LevelAt(const CellGrid::Cell& cell, const std::map<CellGrid::Cell, int>& level_of_cell) {
  const auto own = level_of_cell.find(cell);
  if (own != level_of_cell.end()) return own->second;
  for (int u = cell.first - 1; u <= cell.first + 1; ++u) {
    for (int v = cell.second - 1; v <= cell.second + 1; ++v) {
      const auto beside = level_of_cell.find({u, v});
      if (beside != level_of_cell.end() && beside->second > kOnSurface) return beside->second;
    }
  }
  return kOnSurface;
}

size_t Index(bool narrow_along_u) { return narrow_along_u ? 0 : 1; }

// Returns the cell `aside` cells further along the narrow side.
CellGrid::Cell Beside(const CellGrid::Cell& cell, int aside, bool narrow_along_u) {
  return narrow_along_u ? CellGrid::Cell(cell.first + aside, cell.second)
                        : CellGrid::Cell(cell.first, cell.second + aside);
}

}  // namespace

void OccupancyGrids::Count(const Landmark& landmark,
                           const Eigen::Vector3d& p_world,
                           int num_beams,
                           CellGrid Counts::*grid) {
  const PatchExtent& extent = landmark.extent;
  const Eigen::Vector2d uv = extent.Project(p_world);
  if (!extent.Contains(uv, kConcernReach)) return;
  const auto id = static_cast<size_t>(landmark.id);
  if (id >= counts_.size()) counts_.resize(id + 1);
  CountsOfPlane& counts = counts_[id];
  (counts[Index(true)].*grid).Add(CellOf(uv.x(), uv.y(), true), num_beams);
  if (HasHeight(extent)) {
    (counts[Index(false)].*grid).Add(CellOf(uv.x(), uv.y(), false), num_beams);
  }
}

void OccupancyGrids::CountHit(const Landmark& landmark,
                              const Eigen::Vector3d& p_world,
                              int num_beams) {
  Count(landmark, p_world, num_beams, &Counts::hits);
}
void OccupancyGrids::CountPassage(const Landmark& landmark,
                                  const Eigen::Vector3d& p_world,
                                  int num_beams) {
  Count(landmark, p_world, num_beams, &Counts::passages);
}

void OccupancyGrids::CountDeviation(const Landmark& landmark,
                                    const Eigen::Vector3d& p_world,
                                    double deviation_m,
                                    double stddev_m) {
  const auto id = static_cast<size_t>(landmark.id);
  if (id >= deviations_.size()) deviations_.resize(id + 1);
  deviations_[id].Add(landmark.extent.Project(p_world), deviation_m, stddev_m);
}

void OccupancyGrids::Add(OccupancyGrids other) {
  if (deviations_.size() < other.deviations_.size()) {
    deviations_.resize(other.deviations_.size());
  }
  for (size_t id = 0; id < other.deviations_.size(); ++id) {
    deviations_[id].Add(other.deviations_[id]);
  }
  if (counts_.empty()) {
    counts_ = std::move(other.counts_);
    return;
  }
  if (counts_.size() < other.counts_.size()) counts_.resize(other.counts_.size());
  for (size_t id = 0; id < other.counts_.size(); ++id) {
    for (size_t kind = 0; kind < other.counts_[id].size(); ++kind) {
      for (const auto grid : {&Counts::hits, &Counts::passages}) {
        CellGrid& counts = counts_[id][kind].*grid;
        (other.counts_[id][kind].*grid).Any([&](const CellGrid::Cell& cell, int count) {
          counts.Add(cell, count);
          return false;
        });
      }
    }
  }
}

void PlaneOpenings::Mark(const CellGrid::Cell& cell, bool narrow_along_u, State state) {
  states_[Index(narrow_along_u)].Raise(cell, state);
  if (state == kSolid) return;
  // A narrow cell may lie across the edge of two wide ones.
  const int narrow = narrow_along_u ? cell.first : cell.second;
  const int wide = narrow_along_u ? cell.second : cell.first;
  for (const int edge : {narrow, narrow + 1}) {
    const int near = CellIndex(edge * (kOpeningCell / PatchExtent::kCellSize));
    nearby_.Add(narrow_along_u ? CellGrid::Cell(near, wide) : CellGrid::Cell(wide, near), 1);
  }
}

bool PlaneOpenings::IsNearby(const CellGrid::Cell& cell, bool narrow_along_u) const {
  const int narrow = narrow_along_u ? cell.first : cell.second;
  const int wide = narrow_along_u ? cell.second : cell.first;
  const int near = CellIndex((narrow + 0.5) * (kOpeningCell / PatchExtent::kCellSize));
  return nearby_.IsNear(
      narrow_along_u ? CellGrid::Cell(near, wide) : CellGrid::Cell(wide, near), 1);
}

bool PlaneOpenings::IsAtLocal(const Eigen::Vector2d& uv) const {
  if (nearby_.Count(PatchExtent::CellAt(uv)) == 0) return false;
  const int along_u = states_[Index(true)].Count(CellOf(uv.x(), uv.y(), true));
  const int along_v = states_[Index(false)].Count(CellOf(uv.x(), uv.y(), false));
  return along_u == kOpen || along_v == kOpen || (along_u == kMixed && along_v != kSolid) ||
         (along_v == kMixed && along_u != kSolid);
}

bool PlaneOpenings::MayBeAlong(const Eigen::Vector3d& a_world,
                               const Eigen::Vector3d& b_world) const {
  const Eigen::Vector2d a = axes_.Project(a_world) / PatchExtent::kCellSize;
  const Eigen::Vector2d b = axes_.Project(b_world) / PatchExtent::kCellSize;
  const int steps = static_cast<int>((b - a).norm()) + 1;  // of one cell at most
  const Eigen::Vector2d step = (b - a) / steps;
  for (int i = 0; i <= steps; ++i) {
    const Eigen::Vector2d p = a + i * step;
    if (nearby_.IsNear({CellIndex(p.x()), CellIndex(p.y())}, 1)) return true;
  }
  return false;
}

void OccupancyGrids::MarkOpen(const Counts& counts,
                              bool narrow_along_u,
                              PlaneOpenings* openings) {
  const double min_share = openings->has_height_ ? kMinShare : kMostBeams;
  counts.passages.Any([&](const CellGrid::Cell& cell, int passed) {
    const int num_beams = passed + counts.hits.Count(cell);
    if (passed < kMinCount || !(passed > min_share * num_beams)) return false;
    const auto state =
        passed > kMostBeams * num_beams ? PlaneOpenings::kOpen : PlaneOpenings::kMixed;
    if (narrow_along_u) {
      for (const int next : {cell.second - 1, cell.second + 1}) {
        const CellGrid::Cell along(cell.first, next);
        if (counts.hits.Count(along) < kContradiction * passed) {
          openings->Mark(along, narrow_along_u, state);
        }
      }
    }
    for (int aside = -1; aside <= 1; ++aside) {
      openings->Mark(Beside(cell, aside, narrow_along_u), narrow_along_u, state);
    }
    return false;
  });
}

void OccupancyGrids::MarkSolid(const Counts& counts,
                               bool narrow_along_u,
                               PlaneOpenings* openings) {
  const CellGrid& states = openings->states_[Index(narrow_along_u)];
  counts.hits.Any([&](const CellGrid::Cell& cell, int hits) {
    if (hits < kMinCount || !openings->IsNearby(cell, narrow_along_u)) return false;
    for (int aside = -1; aside <= 1; ++aside) {
      const CellGrid::Cell near = Beside(cell, aside, narrow_along_u);
      if (states.Count(near) > PlaneOpenings::kSolid) return false;
    }
    openings->Mark(cell, narrow_along_u, PlaneOpenings::kSolid);
    return false;
  });
}

PlaneOpenings OccupancyGrids::EmptyOpenings(const Landmark& landmark) {
  PlaneOpenings openings;
  openings.has_height_ = HasHeight(landmark.extent);
  openings.axes_ = landmark.extent.axes();
  return openings;
}

PlaneOpenings OccupancyGrids::OpeningsOf(const Landmark& landmark) const {
  PlaneOpenings openings = EmptyOpenings(landmark);
  const auto id = static_cast<size_t>(landmark.id);
  if (id >= counts_.size()) return openings;
  for (const auto mark : {&MarkOpen, &MarkSolid}) {
    for (const bool narrow_along_u : {true, false}) {
      if (!HasCells(openings.has_height_, narrow_along_u)) continue;
      mark(counts_[id][Index(narrow_along_u)], narrow_along_u, &openings);
    }
  }
  return openings;
}

void OccupancyGrids::MarkOff(const CellGrid::Cell& cell, PlaneOpenings* openings) {
  const auto narrow = [](int wide) {
    return CellIndex(wide * (PatchExtent::kCellSize / kOpeningCell) + 0.5);
  };
  for (int i = narrow(cell.first); i < narrow(cell.first + 1); ++i) {
    openings->Mark({i, cell.second}, true, PlaneOpenings::kOpen);
  }
}

bool OccupancyGrids::MarkElsewhere(const CellGrid& seen, LevelOnSurface* level) {
  const auto is_elsewhere = [&](const CellGrid::Cell& cell) {
    return seen.Count(cell) > 0 &&
           !std::binary_search(level->cells.begin(), level->cells.end(), cell);
  };
  bool has_inner_cells = false;
  seen.Any([&](const CellGrid::Cell& cell, int) {
    const auto& [u, v] = cell;
    if (is_elsewhere(cell) || is_elsewhere({u - 1, v}) || is_elsewhere({u + 1, v}) ||
        is_elsewhere({u, v - 1}) || is_elsewhere({u, v + 1})) {
      MarkOff(cell, &level->elsewhere);
    } else {
      has_inner_cells = true;
    }
    return false;
  });
  return has_inner_cells;
}

std::vector<PlaneOpenings> OccupancyGrids::OpeningsOf(
    const std::deque<Landmark>& landmarks,
    double flatness_m,
    std::vector<LevelOnSurface>* levels) const {
  std::vector<SurfacePlaces> places(landmarks.size());
  for (size_t id = 0; id < std::min(places.size(), deviations_.size()); ++id) {
    places[id] = deviations_[id].PlacesOn(landmarks[id]);
  }
  const double unevenness_m = EstimateUnevenness(places);
  std::vector<PlaneOpenings> of_all;
  of_all.reserve(landmarks.size());
  for (size_t id = 0; id < places.size(); ++id) {
    of_all.push_back(OpeningsOf(landmarks[id]));
    // A floor that rises a little bends the rig with it, which the verdict tells by the places
    // that a finer test would cut.
    const bool is_wall = TraitsOf(landmarks[id]).has_heading;
    const SurfaceLevels found =
        FindLevels(places[id], is_wall ? unevenness_m : std::max(unevenness_m, flatness_m));
    std::vector<LevelOnSurface> of_surface;
    for (const double step_m : found.steps_m) {
      of_surface.push_back({landmarks[id].id, step_m, {}, EmptyOpenings(landmarks[id])});
    }
    std::map<CellGrid::Cell, int> level_of_cell;
    for (size_t i = 0; i < places[id].size(); ++i) {
      level_of_cell[places[id][i].cell] = found.of_place[i];
    }
    landmarks[id].extent.cells().Any([&](const CellGrid::Cell& cell, int) {
      const int level = LevelAt(cell, level_of_cell);
      if (level == kOnSurface) return false;
      MarkOff(cell, &of_all.back());
      if (level != kOffAlone) of_surface[static_cast<size_t>(level) - 1].cells.push_back(cell);
      return false;
    });
    for (LevelOnSurface& level : of_surface) {
      if (!MarkElsewhere(landmarks[id].extent.cells(), &level)) continue;
      levels->push_back(std::move(level));
    }
  }
  return of_all;
}

}  // namespace plumbline
