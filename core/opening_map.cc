#include "core/opening_map.h"

namespace plumbline {
namespace {

constexpr double kNarrow = 0.02;  // m
constexpr double kWide = 0.25;
// What is farther than this from a plane's bounding rectangle says nothing of it.
constexpr double kMargin = 1.0;
constexpr int kMinCount = 2;
constexpr double kMinShare = 0.1;
constexpr double kMinShareLevel = 0.5;
// An opening goes on along an upright edge where beams on the plane are fewer than this share
// of those that went through.
constexpr double kContradiction = 0.25;

bool HasHeight(const PatchExtent& extent) {
  return extent.max_corner().y() - extent.min_corner().y() > kWide;
}

CellGrid::Cell CellOf(double u, double v, bool narrow_along_u) {
  return {CellIndex(u / (narrow_along_u ? kNarrow : kWide)),
          CellIndex(v / (narrow_along_u ? kWide : kNarrow))};
}

// Without height there are no level edges: cells that are wide along u would only blur.
bool HasCells(bool has_height, bool narrow_along_u) { return narrow_along_u || has_height; }

size_t Index(bool narrow_along_u) { return narrow_along_u ? 0 : 1; }

}  // namespace

void OpeningMap::Count(const Landmark& landmark,
                       const Eigen::Vector3d& p_world,
                       int num_beams,
                       CellGrid Counts::*grid) {
  const PatchExtent& extent = landmark.extent;
  const Eigen::Vector2d uv = extent.Project(p_world);
  if (!extent.Contains(uv, kMargin)) return;
  const auto id = static_cast<size_t>(landmark.id);
  if (id >= counts_.size()) counts_.resize(id + 1);
  CountsOfPlane& counts = counts_[id];
  (counts[Index(true)].*grid).Add(CellOf(uv.x(), uv.y(), true), num_beams);
  if (HasHeight(extent)) {
    (counts[Index(false)].*grid).Add(CellOf(uv.x(), uv.y(), false), num_beams);
  }
}

void OpeningMap::CountHit(const Landmark& landmark,
                          const Eigen::Vector3d& p_world,
                          int num_beams) {
  Count(landmark, p_world, num_beams, &Counts::hits);
}
void OpeningMap::CountPassage(const Landmark& landmark,
                              const Eigen::Vector3d& p_world,
                              int num_beams) {
  Count(landmark, p_world, num_beams, &Counts::passages);
}
void OpeningMap::CountBlock(const Landmark& landmark, const Eigen::Vector3d& p_world) {
  Count(landmark, p_world, 1, &Counts::blocks);
}

void PlaneOpenings::Open(const CellGrid::Cell& cell, bool narrow_along_u) {
  open_[Index(narrow_along_u)].Add(cell, 1);
  // A narrow cell may lie across the edge of two wide ones.
  const int narrow = narrow_along_u ? cell.first : cell.second;
  const int wide = narrow_along_u ? cell.second : cell.first;
  for (const int edge : {narrow, narrow + 1}) {
    const int near = CellIndex(edge * kNarrow / kWide);
    nearby_.Add(narrow_along_u ? CellGrid::Cell(near, wide) : CellGrid::Cell(wide, near), 1);
  }
}

bool PlaneOpenings::IsAtLocal(const Eigen::Vector2d& uv) const {
  const CellGrid::Cell wide(CellIndex(uv.x() / kWide), CellIndex(uv.y() / kWide));
  if (nearby_.Count(wide) == 0) return false;
  return open_[0].Count(CellOf(uv.x(), uv.y(), true)) > 0 ||
         open_[1].Count(CellOf(uv.x(), uv.y(), false)) > 0;
}

bool PlaneOpenings::MayBeAlong(const Eigen::Vector3d& a_world,
                               const Eigen::Vector3d& b_world) const {
  const Eigen::Vector2d a = Project(a_world) / kWide;
  const Eigen::Vector2d b = Project(b_world) / kWide;
  const int steps = static_cast<int>((b - a).norm()) + 1;  // of one cell at most
  const Eigen::Vector2d step = (b - a) / steps;
  for (int i = 0; i <= steps; ++i) {
    const Eigen::Vector2d p = a + i * step;
    if (nearby_.IsNear({CellIndex(p.x()), CellIndex(p.y())}, 1)) return true;
  }
  return false;
}

PlaneOpenings OpeningMap::OpeningsOf(const Landmark& landmark) const {
  PlaneOpenings openings;
  const auto id = static_cast<size_t>(landmark.id);
  if (id >= counts_.size()) return openings;
  openings.has_height_ = HasHeight(landmark.extent);
  openings.anchor_ = landmark.extent.anchor();
  openings.u_axis_ = landmark.extent.u_axis();
  openings.v_axis_ = landmark.extent.v_axis();
  const double min_share = openings.has_height_ ? kMinShare : kMinShareLevel;
  for (const bool narrow_along_u : {true, false}) {
    if (!HasCells(openings.has_height_, narrow_along_u)) continue;
    const Counts& counts = counts_[id][Index(narrow_along_u)];
    counts.blocks.Any([&](const CellGrid::Cell& cell, int blocked) {
      if (blocked >= kMinCount && blocked > counts.hits.Count(cell)) {
        openings.Open(cell, narrow_along_u);
      }
      return false;
    });
    counts.passages.Any([&](const CellGrid::Cell& cell, int passed) {
      if (passed < kMinCount || !(passed > min_share * (passed + counts.hits.Count(cell)))) {
        return false;
      }
      if (narrow_along_u) {
        for (const int next : {cell.second - 1, cell.second + 1}) {
          const CellGrid::Cell along(cell.first, next);
          if (counts.hits.Count(along) < kContradiction * passed) {
            openings.Open(along, narrow_along_u);
          }
        }
      }
      for (int aside = -1; aside <= 1; ++aside) {
        CellGrid::Cell near = cell;
        (narrow_along_u ? near.first : near.second) += aside;
        openings.Open(near, narrow_along_u);
      }
      return false;
    });
  }
  return openings;
}

std::vector<PlaneOpenings> OpeningMap::OpeningsOf(
    const std::deque<Landmark>& landmarks) const {
  std::vector<PlaneOpenings> of_all;
  of_all.reserve(landmarks.size());
  for (const Landmark& landmark : landmarks) of_all.push_back(OpeningsOf(landmark));
  return of_all;
}

}  // namespace plumbline
