#include "core/outputs/floor_openings.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <unordered_set>

#include "core/outputs/plan_scales.h"
#include "core/outputs/room_outlines.h"

namespace plumbline {
namespace {

using Cell = std::pair<int, int>;

Cell CellOf(const Eigen::Vector2d& p) {
  return {static_cast<int>(std::floor(p.x() / kSameM)),
          static_cast<int>(std::floor(p.y() / kSameM))};
}

// Beams that ended on the floor, and beams that passed its height, by square.
class FloorBeams {
 public:
  explicit FloorBeams(const StoreyLevel& level) : level_(level) {}

  // is_level: of the surface that the beam ended on.
  void Add(const Eigen::Vector3d& origin, const Eigen::Vector3d& end, bool is_level) {
    const double above_end = end.z() - level_.At(end.head<2>()).floor_m;
    if (std::abs(above_end) < kBesideM) {
      if (is_level) ++counts_[KeyOf(CellOf(end.head<2>()))].hits;
      return;
    }
    const double above_origin = origin.z() - level_.At(origin.head<2>()).floor_m;
    const bool goes_down = above_origin > 0.0 && above_end < -2.0 * kBesideM;
    const bool comes_up = above_origin < -2.0 * kBesideM && above_end > 0.0;
    if (!goes_down && !comes_up) return;
    const double share = above_origin / (above_origin - above_end);
    const Eigen::Vector3d p = origin + share * (end - origin);
    ++counts_[KeyOf(CellOf(p.head<2>()))].passes;
  }

  enum class Kind { kUnknown, kFloor, kOpening };
  Kind At(const Cell& cell) const {
    const auto found = counts_.find(KeyOf(cell));
    if (found == counts_.end()) return Kind::kUnknown;
    const auto [hits, passes] = found->second;
    if (passes >= kMinBeams && passes > hits) return Kind::kOpening;
    return hits > 0 ? Kind::kFloor : Kind::kUnknown;
  }
  bool HasPasses() const {
    return std::any_of(counts_.begin(), counts_.end(), [](const auto& count) {
      return count.second.passes > 0;
    });
  }

 private:
  struct Counts {
    int hits = 0;
    int passes = 0;
  };

  static int64_t KeyOf(const Cell& cell) {
    return (static_cast<int64_t>(cell.first) << 32) ^ static_cast<uint32_t>(cell.second);
  }

  const StoreyLevel& level_;
  std::unordered_map<int64_t, Counts> counts_;
};

// The squares of a room, as an array over its box.
class RoomCells {
 public:
  RoomCells(const Room& room, const FloorBeams& beams) {
    Eigen::AlignedBox2d box;
    for (const RoomEdge& edge : room.loops.front()) box.extend(edge.from);
    first_ = CellOf(box.min());
    const Cell last = CellOf(box.max());
    columns_ = last.first - first_.first + 1;
    const int rows = last.second - first_.second + 1;
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column < columns_; ++column) {
        const Cell cell(first_.first + column, first_.second + row);
        const bool is_in = IsInside(room.loops, MiddleOf(cell));
        kinds_.push_back(is_in ? beams.At(cell) : FloorBeams::Kind::kUnknown);
        is_in_room_.push_back(is_in);
      }
    }
    is_seen_.assign(kinds_.size(), false);
    for (size_t i = 0; i < kinds_.size(); ++i) {
      is_seen_[i] = kinds_[i] != FloorBeams::Kind::kUnknown;
    }
    FillFromNearest();
  }

  std::vector<RoomFloorOpening> Openings() const {
    constexpr double kMinAreaM2 = 0.5;
    std::vector<RoomFloorOpening> openings;
    std::vector<bool> done(kinds_.size(), false);
    for (size_t i = 0; i < kinds_.size(); ++i) {
      if (done[i] || !IsOpening(i)) continue;
      const RoomFloorOpening opening = OpeningFrom(i, &done);
      if (opening.area_m2 >= kMinAreaM2) openings.push_back(opening);
    }
    return openings;
  }

 private:
  static Eigen::Vector2d MiddleOf(const Cell& cell) {
    return {(cell.first + 0.5) * kSameM, (cell.second + 0.5) * kSameM};
  }
  bool IsOpening(size_t at) const {
    return is_in_room_[at] && kinds_[at] == FloorBeams::Kind::kOpening;
  }
  template <typename Visit>
  void ForEachNeighbour(size_t at, Visit visit) const {
    const auto columns = static_cast<size_t>(columns_);
    if (at % columns > 0) visit(at - 1);
    if (at % columns + 1 < columns) visit(at + 1);
    if (at >= columns) visit(at - columns);
    if (at + columns < kinds_.size()) visit(at + columns);
  }

  void FillFromNearest() {
    std::vector<size_t> waiting;
    for (size_t i = 0; i < kinds_.size(); ++i) {
      if (is_seen_[i]) waiting.push_back(i);
    }
    for (size_t next = 0; next < waiting.size(); ++next) {
      const size_t at = waiting[next];
      ForEachNeighbour(at, [&](size_t other) {
        if (!is_in_room_[other] || kinds_[other] != FloorBeams::Kind::kUnknown) return;
        kinds_[other] = kinds_[at];
        waiting.push_back(other);
      });
    }
  }

  // Half a square along the whole rim, as a uniform error, and what was not seen as one.
  RoomFloorOpening OpeningFrom(size_t start, std::vector<bool>* done) const {
    RoomFloorOpening opening;
    int num_rim = 0;
    int num_unseen = 0;
    std::vector<size_t> waiting = {start};
    (*done)[start] = true;
    int num_cells = 0;
    for (size_t next = 0; next < waiting.size(); ++next) {
      const size_t at = waiting[next];
      ++num_cells;
      if (!is_seen_[at]) ++num_unseen;
      const Cell cell(first_.first + static_cast<int>(at) % columns_,
                      first_.second + static_cast<int>(at) / columns_);
      opening.box.extend(kSameM * Eigen::Vector2d(cell.first, cell.second));
      opening.box.extend(kSameM * Eigen::Vector2d(cell.first + 1, cell.second + 1));
      ForEachNeighbour(at, [&](size_t other) {
        if (!IsOpening(other)) {
          if (is_in_room_[other]) ++num_rim;
          return;
        }
        if ((*done)[other]) return;
        (*done)[other] = true;
        waiting.push_back(other);
      });
    }
    const double square_m2 = kSameM * kSameM;
    opening.area_m2 = square_m2 * num_cells;
    opening.stddev_m2 = std::hypot(square_m2 * num_rim / std::sqrt(12.0),
                                   square_m2 * num_unseen / std::sqrt(12.0));
    return opening;
  }

  Cell first_;
  int columns_ = 0;
  std::vector<FloorBeams::Kind> kinds_;
  std::vector<bool> is_in_room_;
  std::vector<bool> is_seen_;
};

}  // namespace

void FindFloorOpenings(const std::vector<PlanePatch>& planes,
                       const std::vector<CloudPoint>& points,
                       const BeamOrigins& origins,
                       const StoreyLevel& level,
                       std::vector<Room>* rooms) {
  if (!level.has_floor) return;
  std::unordered_set<int> level_ids;
  for (const PlanePatch& plane : planes) {
    if (plane.normal.z() > kLevelCosine) level_ids.insert(plane.id);
  }
  FloorBeams beams(level);
  for (const CloudPoint& point : points) {
    const auto origin = origins.At(point.scanner, point.time_s);
    if (!origin) continue;
    beams.Add(*origin, point.p_world.cast<double>(), level_ids.count(point.plane_id) > 0);
  }
  if (!beams.HasPasses()) return;
  for (Room& room : *rooms) {
    room.floor_openings = RoomCells(room, beams).Openings();
    for (const RoomFloorOpening& opening : room.floor_openings) {
      room.area_m2 -= opening.area_m2;
      room.area_stddev_m2 = std::hypot(room.area_stddev_m2, opening.stddev_m2);
    }
  }
}

}  // namespace plumbline
