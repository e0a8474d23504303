#include "core/outputs/beam_evidence.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <unordered_map>
#include <unordered_set>

#include "core/outputs/plan_scales.h"
#include "core/util/error.h"

namespace plumbline {
namespace {

void Increase(uint16_t* count) {
  if (*count < std::numeric_limits<uint16_t>::max()) ++*count;
}

// Which face, and which surface of it, a plane of the map belongs to.
struct FaceOfPlane {
  size_t face = 0;
  size_t member = 0;
};

// EvidenceCollector takes one beam after the other.
class EvidenceCollector {
 public:
  EvidenceCollector(const std::vector<PlanePatch>& planes,
                    const StoreyLevel& storey,
                    double margin_m,
                    std::vector<WallFace>* faces)
      : planes_(planes), storey_(storey), margin_m_(margin_m), faces_(*faces) {
    Eigen::AlignedBox2d box;
    for (size_t i = 0; i < faces_.size(); ++i) {
      for (size_t k = 0; k < faces_[i].planes.size(); ++k) {
        by_id_[planes[faces_[i].planes[k]].id] = {i, k};
      }
      const WallFace& face = faces_[i];
      for (double s = face.start_m; s < face.end_m(); s += WallFace::kColumnM) {
        box.extend(face.curve.At(s));
      }
      box.extend(face.curve.At(face.end_m()));
    }
    grid_ = FreeGrid(box);
    for (const PlanePatch& plane : planes) {
      const bool is_above = plane.centre.z() > storey.band_high_m();
      if (plane.normal.z() < 0.0 && is_above && by_id_.count(plane.id) == 0) {
        ceiling_ids_.insert(plane.id);
      }
    }
    for (const WallFace& face : faces_) {
      above_ends_.emplace_back(face.columns.size());
      above_hits_.emplace_back(face.planes.size(),
                               std::vector<uint32_t>(face.columns.size(), 0));
    }
  }

  void Add(const Eigen::Vector3d& origin, const CloudPoint& point) {
    const Eigen::Vector3d end = point.p_world.cast<double>();
    const auto of_plane = by_id_.find(point.plane_id);
    size_t own = faces_.size();
    if (of_plane != by_id_.end()) {
      own = of_plane->second.face;
      AddHit(origin, end, of_plane->second);
    }
    // Where no ceiling was seen at all, beams do not tell what is indoors.
    AddPasses(
        origin, end, own, ceiling_ids_.empty() || ceiling_ids_.count(point.plane_id) > 0);
  }

  // Where only what is above the band was seen of a face, that counts.
  void Finish() {
    for (size_t i = 0; i < faces_.size(); ++i) {
      WallFace& face = faces_[i];
      for (size_t column = 0; column < face.columns.size(); ++column) {
        if (!face.columns[column].IsSeenAboveOnly()) continue;
        face.hit_ends[column] = above_ends_[i][column];
        for (size_t k = 0; k < face.planes.size(); ++k) {
          face.plane_hits[k][column] = above_hits_[i][k][column];
        }
      }
    }
  }

  FreeGrid TakeGrid() { return std::move(grid_); }

 private:
  // The level of a height in the band; kNumLevels or more above it, negative below.
  static int Level(const StoreyHeights& storey, double z) {
    const double height =
        (z - storey.band_low_m()) / (storey.band_high_m() - storey.band_low_m());
    return static_cast<int>(std::floor(height * static_cast<double>(WallColumn::kNumLevels)));
  }

  // Of a height above the band, its level from there up to the ceiling.
  static size_t HighLevel(const StoreyHeights& storey, double z) {
    const double share =
        (z - storey.band_high_m()) / std::max(1e-3, storey.top_m - storey.band_high_m());
    const auto num_levels = static_cast<double>(WallColumn::kNumHigh);
    return static_cast<size_t>(
        std::clamp(std::floor(share * num_levels), 0.0, num_levels - 1.0));
  }

  void AddHit(const Eigen::Vector3d& origin,
              const Eigen::Vector3d& end,
              const FaceOfPlane& of_plane) {
    // Where the beam meets the surface itself: the range's noise would blur the ends of walls.
    const PlanePatch& plane = planes_[faces_[of_plane.face].planes[of_plane.member]];
    const Eigen::Vector3d along = (end - origin).normalized();
    const double approach = plane.NormalAt(end).dot(along);
    constexpr double kMinApproach = 0.02;  // flatter beams say nothing of where
    if (approach > -kMinApproach) return;
    const Eigen::Vector3d hit = end - along * (plane.SignedDistance(end) / approach);
    WallFace& face = faces_[of_plane.face];
    const double s = face.curve.Parameter(hit.head<2>());
    const int at = face.ColumnOf(s);
    const StoreyHeights heights = HeightsBefore(face.curve, hit.head<2>(), storey_);
    const int level = Level(heights, hit.z());
    if (at < 0 || level < 0 || hit.z() > std::max(heights.top_m, heights.band_high_m()))
      return;
    const auto column = static_cast<size_t>(at);
    if (level >= static_cast<int>(WallColumn::kNumLevels)) {
      Increase(&face.columns[column].hits_above);
      Increase(&face.columns[column].high_hits[HighLevel(heights, hit.z())]);
      above_ends_[of_plane.face][column].Extend(s);
      ++above_hits_[of_plane.face][of_plane.member][column];
      AddPassesAbove(origin, hit, of_plane.face);
      return;
    }
    Increase(&face.columns[column].hits[static_cast<size_t>(level)]);
    ++face.plane_hits[of_plane.member][column];
    face.hit_ends[column].Extend(s);
  }

  // Notes what a beam that hit a face above the band passed over before it: faces that look
  // the same way, such as the front of a cupboard, and the backs of walls whose line goes on
  // there.
  void AddPassesAbove(const Eigen::Vector3d& origin,
                      const Eigen::Vector3d& hit,
                      size_t of_face) {
    const Eigen::Vector2d normal = faces_[of_face].curve.NormalAt(hit.head<2>());
    for (size_t i = 0; i < faces_.size(); ++i) {
      WallFace& face = faces_[i];
      const double away_m = std::abs(face.curve.SignedDistance(hit.head<2>()));
      if (away_m < kSameM || away_m > WallColumn::kMaxFurnitureM || i == of_face ||
          std::abs(face.curve.NormalAt(hit.head<2>()).dot(normal)) < kParallelCosine) {
        continue;
      }
      face.curve.ForEachCrossing(origin.head<2>(), hit.head<2>(), [&](double share, double s) {
        const int column = face.ColumnOf(s);
        const double z = origin.z() + share * (hit.z() - origin.z());
        const StoreyHeights heights = HeightsBefore(face.curve, face.curve.At(s), storey_);
        if (column < 0 || z < heights.band_high_m()) return;
        Increase(
            &face.columns[static_cast<size_t>(column)].high_passes[HighLevel(heights, z)]);
      });
    }
  }

  void AddPasses(const Eigen::Vector3d& origin,
                 const Eigen::Vector3d& end,
                 size_t own,
                 bool ends_on_ceiling) {
    const double length = (end - origin).norm();
    if (length <= margin_m_) return;
    const Eigen::Vector3d last = origin + (end - origin) * (1.0 - margin_m_ / length);
    // The part of the beam within the band, that of the lowest floor to that of the highest.
    StoreyHeights lowest = storey_;
    StoreyHeights highest = storey_;
    if (storey_.floors != nullptr) {
      lowest.floor_m = storey_.floors->lowest_m();
      highest.floor_m = storey_.floors->highest_m();
    }
    const double rise = last.z() - origin.z();
    double from = 0.0;
    double to = 1.0;
    if (std::abs(rise) > 1e-9) {
      const double a = (lowest.band_low_m() - origin.z()) / rise;
      const double b = (highest.band_high_m() - origin.z()) / rise;
      from = std::max(from, std::min(a, b));
      to = std::min(to, std::max(a, b));
    } else if (Level(lowest, origin.z()) < 0 ||
               Level(highest, origin.z()) >= static_cast<int>(WallColumn::kNumLevels)) {
      return;
    }
    if (from >= to) return;
    const Eigen::Vector3d first_in = origin + from * (last - origin);
    const Eigen::Vector3d last_in = origin + to * (last - origin);
    const Eigen::Vector2d a = first_in.head<2>();
    const Eigen::Vector2d b = last_in.head<2>();
    AddFree(first_in, last_in);
    for (size_t i = 0; i < faces_.size(); ++i) {
      if (i == own) continue;
      WallFace& face = faces_[i];
      const auto is_deep = [&face](const Eigen::Vector3d& p) {
        return face.curve.SignedDistance(p.head<2>()) < -kMaxThicknessM;
      };
      face.curve.ForEachCrossing(a, b, [&](double share, double s) {
        const int column = face.ColumnOf(s);
        const int level = Level(HeightsBefore(face.curve, face.curve.At(s), storey_),
                                first_in.z() + share * (last_in.z() - first_in.z()));
        if (column < 0 || level < 0 || level >= static_cast<int>(WallColumn::kNumLevels))
          return;
        Increase(
            &face.columns[static_cast<size_t>(column)].passes[static_cast<size_t>(level)]);
        face.pass_ends[static_cast<size_t>(column)].Extend(s);
        if (is_deep(origin) || is_deep(end)) {
          Increase(&face.columns[static_cast<size_t>(column)].deep_passes);
        }
        if (ends_on_ceiling && is_deep(end)) {
          Increase(&face.columns[static_cast<size_t>(column)].ceiling_passes);
        }
      });
    }
  }

  // Counts the squares over which a piece of a beam is within the band of the floor below it.
  void AddFree(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
    if (storey_.floors == nullptr) {
      grid_.AddBeam(from.head<2>(), to.head<2>());
      return;
    }
    const int steps = static_cast<int>((to - from).head<2>().norm() / FreeGrid::kCellM) + 1;
    const Eigen::Vector3d step = (to - from) / steps;
    for (int i = 0; i < steps;) {
      const auto is_in_band = [&](int at) {
        const Eigen::Vector3d p = from + (at + 0.5) * step;
        const int level = Level(storey_.At(p.head<2>()), p.z());
        return level >= 0 && level < static_cast<int>(WallColumn::kNumLevels);
      };
      int end = i;
      while (end < steps && is_in_band(end)) ++end;
      if (end > i) {
        grid_.AddBeam((from + i * step).head<2>(), (from + end * step).head<2>());
      }
      i = end + 1;
    }
  }

  const std::vector<PlanePatch>& planes_;
  const StoreyLevel& storey_;
  double margin_m_;
  std::vector<WallFace>& faces_;
  std::unordered_map<int, FaceOfPlane> by_id_;
  std::unordered_set<int> ceiling_ids_;  // surfaces above the band that face down
  FreeGrid grid_;
  // Of each face, what was hit above the band, as hit_ends and plane_hits.
  std::vector<std::vector<Stretch>> above_ends_;
  std::vector<std::vector<std::vector<uint32_t>>> above_hits_;
};

}  // namespace

FreeGrid::FreeGrid(const Eigen::AlignedBox2d& box) : box_(box) {
  constexpr double kMaxSideM = 5000.0;
  const double side_m = box.sizes().maxCoeff();
  if (side_m > kMaxSideM) {
    char text[120];
    std::snprintf(
        text,
        sizeof(text),
        "map.ply: its walls lie up to %.0f m apart, farther than those of any building",
        side_m);
    throw Error(text);
  }
  num_columns_ = static_cast<int>(std::ceil(box.sizes().x() / kCellM)) + 1;
  num_rows_ = static_cast<int>(std::ceil(box.sizes().y() / kCellM)) + 1;
}

void FreeGrid::AddBeam(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const int steps = static_cast<int>((b - a).norm() / kCellM) + 1;
  const Eigen::Vector2d step = (b - a) / steps;
  Eigen::Vector2d p = a + 0.5 * step;
  int last_row = -1;
  int last_column = -1;
  int64_t last_block = -1;
  Block* block = nullptr;
  for (int i = 0; i < steps; ++i, p += step) {
    const double x = (p.x() - box_.min().x()) / kCellM;
    const double y = (p.y() - box_.min().y()) / kCellM;
    if (!(x >= 0.0 && y >= 0.0 && x < num_columns_ && y < num_rows_)) continue;
    const int column = static_cast<int>(x);
    const int row = static_cast<int>(y);
    if (column == last_column && row == last_row) continue;
    last_column = column;
    last_row = row;
    const int64_t at = int64_t{row / kBlock} * num_columns_ + column / kBlock;
    if (at != last_block) {
      block = &blocks_[at];
      last_block = at;
    }
    Increase(&(*block)[static_cast<size_t>(row % kBlock * kBlock + column % kBlock)]);
  }
}

int FreeGrid::CountFree(int row, int from, int to) const {
  int count = 0;
  for (int column = from; column < to;) {
    const int end = std::min(to, (column / kBlock + 1) * kBlock);
    const auto block = blocks_.find(int64_t{row / kBlock} * num_columns_ + column / kBlock);
    for (; column < end; ++column) {
      if (block == blocks_.end()) continue;
      const size_t at = static_cast<size_t>(row % kBlock * kBlock + column % kBlock);
      if (block->second[at] >= kMinBeams) ++count;
    }
  }
  return count;
}

FreeGrid CollectEvidence(const std::vector<PlanePatch>& planes,
                         const std::vector<CloudPoint>& points,
                         const BeamOrigins& origins,
                         const StoreyLevel& storey,
                         double margin_m,
                         std::vector<WallFace>* faces) {
  EvidenceCollector collector(planes, storey, margin_m, faces);
  for (const CloudPoint& point : points) {
    const auto origin = origins.At(point.scanner, point.time_s);
    if (origin) collector.Add(*origin, point);
  }
  collector.Finish();
  return collector.TakeGrid();
}

void NoteWay(const std::vector<Eigen::Vector2d>& way, std::vector<WallFace>* faces) {
  constexpr double kMaxStepM = 0.5;  // farther poses are before and after another storey
  for (size_t i = 1; i < way.size(); ++i) {
    if ((way[i] - way[i - 1]).norm() > kMaxStepM) continue;
    for (WallFace& face : *faces) {
      face.curve.ForEachCrossing(way[i - 1], way[i], [&face](double, double s) {
        const int column = face.ColumnOf(s);
        if (column >= 0) face.columns[static_cast<size_t>(column)].rig_passed = true;
      });
    }
  }
}

}  // namespace plumbline
