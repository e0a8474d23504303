#include "core/outputs/wall_stretches.h"

#include <algorithm>
#include <cmath>

#include "core/outputs/plan_scales.h"

namespace plumbline {
namespace {

constexpr double kMinDoorM = 0.6;
constexpr double kMaxDoorM = 1.5;
constexpr double kNearM = 0.25;  // of a crossing: a wall's columns there tell of its end
constexpr double kMinCrossingSine = 0.34;  // 20 degrees

// A place on a face at which a gap ends: a run of its own, or a wall that crosses.
struct GapEnd {
  double from_m = 0.0;
  double to_m = 0.0;
  bool is_own = false;

  // Whether it is a stretch of the face that is no pillar.
  bool IsWall() const { return is_own && to_m - from_m >= kMinWallM; }
};

// A wall that crosses, solid at the crossing.
struct CrossingWall {
  double s = 0.0;
  double faces = 0.0;    // the cosine of its normal with the direction of growing s
  bool goes_on = false;  // it is solid well before and well behind the face, not on one side
};

ColumnState Judge(const WallColumn& column, bool* is_window) {
  int solid[2] = {0, 0};  // low, high
  int open[2] = {0, 0};
  for (size_t level = 0; level < WallColumn::kNumLevels; ++level) {
    const int half = level < WallColumn::kNumLow ? 0 : 1;
    const int hits = column.hits[level];
    const int passes = column.passes[level];
    if (hits >= kMinBeams && hits >= passes) ++solid[half];
    if (passes >= kMinBeams && passes > hits) ++open[half];
  }
  *is_window = false;
  if (column.EndsBelowCeiling()) return ColumnState::kOpen;
  if (column.IsSeenAboveOnly()) return ColumnState::kSolid;
  if (solid[0] + solid[1] + open[0] + open[1] == 0) return ColumnState::kUnseen;
  if (solid[0] > 0 && solid[0] >= open[0]) {
    *is_window = open[1] > solid[1];
    return ColumnState::kSolid;
  }
  return solid[0] + solid[1] >= open[0] + open[1] ? ColumnState::kSolid : ColumnState::kOpen;
}

double SolidShare(const WallFace& face, const Stretches& stretches, double from, double to) {
  int solid = 0;
  int count = 0;
  for (double s = from; s < to; s += WallFace::kColumnM, ++count) {
    const int column = face.ColumnOf(s);
    if (column >= 0 && stretches.states[static_cast<size_t>(column)] == ColumnState::kSolid) {
      ++solid;
    }
  }
  return count > 0 ? static_cast<double>(solid) / count : 0.0;
}

std::vector<CrossingWall> WallsAcross(size_t at,
                                      const std::vector<WallFace>& faces,
                                      const std::vector<Stretches>& stretches) {
  std::vector<CrossingWall> walls;
  const WallCurve& curve = faces[at].curve;
  for (const FaceCrossing& crossing : CrossingsOf(at, faces)) {
    const WallFace& other = faces[crossing.face];
    const Stretches& of_other = stretches[crossing.face];
    const double s = crossing.other_s;
    if (SolidShare(other, of_other, s - kNearM, s + kNearM) <= 0.0) continue;
    const Eigen::Vector2d p = curve.At(crossing.s);
    const Eigen::Vector2d normal = curve.NormalAt(p);
    const bool before =
        SolidShare(other, of_other, s - WallColumn::kMaxFurnitureM, s - kBesideM) > kMostly;
    const bool behind =
        SolidShare(other, of_other, s + kBesideM, s + WallColumn::kMaxFurnitureM) > kMostly;
    if (!before && !behind) continue;  // a jamb
    CrossingWall& wall = walls.emplace_back();
    wall.s = crossing.s;
    wall.faces = other.curve.NormalAt(p).dot(Eigen::Vector2d(-normal.y(), normal.x()));
    wall.goes_on = before && behind;
  }
  return walls;
}

// Whether the gap is the whole width of a room that the face's line only cuts: walls that look
// at each other, and go on before and behind, bound it on both sides.
bool IsRoomWide(const std::vector<CrossingWall>& walls, double from, double to) {
  bool begins = false;
  bool ends = false;
  for (const CrossingWall& wall : walls) {
    if (!wall.goes_on) continue;
    begins = begins || (std::abs(wall.s - from) < kNearM && wall.faces > 0.0);
    ends = ends || (std::abs(wall.s - to) < kNearM && wall.faces < 0.0);
  }
  return begins && ends;
}

// A gap in a face, with its beam counts.
struct Gap {
  double from_m = 0.0;
  double to_m = 0.0;
  size_t first = 0;  // columns
  size_t last = 0;   // one behind
  // Shares of its columns: beams pass; beams pass and go far; beams hit the face above it.
  double open = 0.0;
  double deep = 0.0;
  double lintel = 0.0;
  double furniture = 0.0;  // it ends below the ceiling, before another wall
  // Beams that hit and that passed the face up to where sills are, off the gap's ends.
  int low_hits = 0;
  int low_passes = 0;
  int ceiling_passes = 0;  // beams that went on to a ceiling well behind the face
  bool is_beside_window = false;
  bool rig_passed = false;
  bool is_between = false;  // stretches of the face on both sides are no pillars

  double width_m() const { return to_m - from_m; }
  bool IsOpen() const { return open >= kMostly; }
  // As wide as a door, and beams pass.
  bool MayBeDoor() const {
    return width_m() >= kMinDoorM && width_m() <= kMaxDoorM && IsOpen();
  }
  // The wall goes on below it.
  bool HasSill() const {
    const bool is_seen = low_hits >= kMinBeams || (is_beside_window && open > 0.0);
    return is_seen && low_hits >= low_passes && !rig_passed;
  }
  bool ReachesFloor() const {
    return rig_passed || (low_passes >= kMinBeams && low_passes > low_hits);
  }
  bool LeadsIndoors() const { return rig_passed || ceiling_passes >= kMinBeams; }
  bool HasLintel() const { return lintel >= kMostly; }
};

// The gaps of one face, closed where they do not stay open.
class GapCloser {
 public:
  GapCloser(size_t at,
            const std::vector<WallFace>& faces,
            const std::vector<Stretches>& seen,
            Stretches* stretches)
      : at_(at),
        faces_(faces),
        seen_(seen),
        face_(faces[at]),
        walls_(WallsAcross(at, faces, seen)),
        stretches_(*stretches) {}

  void Close() {
    std::vector<GapEnd> ends;
    for (const SolidRun& run : SolidRuns(face_, stretches_)) {
      ends.push_back({run.from_m, run.to_m, true});
    }
    if (ends.empty()) return;
    const std::vector<GapEnd> runs = ends;
    for (const CrossingWall& wall : walls_) {
      // At the end of a stretch, that end is the gap's.
      const bool is_known = std::any_of(runs.begin(), runs.end(), [&](const GapEnd& run) {
        return wall.s > run.from_m - kSameM && wall.s < run.to_m + kSameM;
      });
      if (!is_known) ends.push_back({wall.s, wall.s, false});
    }
    std::sort(ends.begin(), ends.end(), [](const GapEnd& a, const GapEnd& b) {
      return a.from_m < b.from_m;
    });
    GapEnd before = ends.front();
    for (size_t i = 1; i < ends.size(); ++i) {
      const GapEnd& after = ends[i];
      if (after.from_m > before.to_m && (before.is_own || after.is_own)) {
        CloseGap(GapBetween(before, after));
      }
      if (after.to_m >= before.to_m) before = after;
    }
  }

  // Closes gaps that alone were not enough for a door, where the opposite face of the wall has
  // one there.
  void CloseOpposite(const std::vector<Stretches>& closed) {
    for (const Gap& gap : doubtful_) {
      if (HasDoorOpposite(gap, closed)) CloseAs(gap, ColumnState::kDoor);
    }
  }

 private:
  Gap GapBetween(const GapEnd& before, const GapEnd& after) const {
    Gap gap;
    gap.from_m = before.to_m;
    gap.to_m = after.from_m;
    gap.is_between = before.IsWall() && after.IsWall();
    const double first = std::floor((gap.from_m - face_.start_m) / WallFace::kColumnM);
    const double last = std::ceil((gap.to_m - face_.start_m) / WallFace::kColumnM);
    gap.first = static_cast<size_t>(std::max(0.0, first));
    gap.last = std::min(face_.columns.size(), static_cast<size_t>(std::max(0.0, last)));
    if (gap.last <= gap.first) return gap;
    const double share = 1.0 / static_cast<double>(gap.last - gap.first);
    for (size_t i = gap.first; i < gap.last; ++i) {
      if (stretches_.states[i] == ColumnState::kOpen) gap.open += share;
      if (face_.columns[i].IsDeep()) gap.deep += share;
      gap.rig_passed = gap.rig_passed || face_.columns[i].rig_passed;
      if (face_.columns[i].hits_above > 0) gap.lintel += share;
      gap.ceiling_passes += face_.columns[i].ceiling_passes;
      if (face_.columns[i].EndsBelowCeiling()) gap.furniture += share;
      if (i == gap.first || i + 1 == gap.last) continue;
      for (size_t level = 0; level < WallColumn::kNumLow; ++level) {
        gap.low_hits += face_.columns[i].hits[level];
        gap.low_passes += face_.columns[i].passes[level];
      }
    }
    const std::vector<bool>& windows = stretches_.windows;
    gap.is_beside_window = (gap.first > 0 && windows[gap.first - 1]) ||
                           (gap.last < windows.size() && windows[gap.last]);
    return gap;
  }

  void CloseGap(const Gap& gap) {
    if (gap.furniture >= kMostly) return;
    if (gap.HasSill() && gap.open > 0.0 && gap.width_m() <= kMaxClearM) {
      CloseAs(gap, ColumnState::kBridged);
      MarkWindow(gap);
      return;
    }
    if (gap.MayBeDoor()) {
      const bool is_door =
          gap.HasLintel() || (gap.is_between && !IsRoomWide(walls_, gap.from_m, gap.to_m));
      if (is_door) {
        CloseAs(gap, ColumnState::kDoor);
      } else {
        doubtful_.push_back(gap);
      }
      return;
    }
    // A wide opening below a lintel that nobody went through ends a room, too: a window.
    constexpr double kMinWideLintel = 0.8;
    if (gap.width_m() > kMaxDoorM && gap.lintel >= kMinWideLintel && !gap.rig_passed &&
        gap.width_m() <= kMaxClearM) {
      CloseAs(gap, ColumnState::kDoor);
      return;
    }
    const bool is_hidden = gap.open <= kHardly && gap.width_m() <= kMaxClearM;
    if (gap.width_m() <= kMaxDoorM || is_hidden || IsRecess(gap)) {
      // A gap that is narrower than a door, and leads out of doors, is a pane beside a post.
      if (gap.IsOpen() && gap.width_m() < kMinDoorM && !gap.LeadsIndoors()) MarkWindow(gap);
      CloseAs(gap, ColumnState::kBridged);
    }
  }

  // Whether all beams end shortly behind the face, on something that is no wall: on the frame
  // of a window.
  bool IsRecess(const Gap& gap) const {
    if (gap.deep > kHardly || gap.width_m() > kMaxClearM) return false;
    const Eigen::Vector2d from = face_.curve.At(gap.from_m);
    const Eigen::Vector2d to = face_.curve.At(gap.to_m);
    const Eigen::Vector2d middle = 0.5 * (from + to);
    for (size_t i = 0; i < faces_.size(); ++i) {
      const WallCurve& other = faces_[i].curve;
      const double ahead = other.SignedDistance(middle);
      if (i == at_ || ahead < 0.0 || ahead > kMaxThicknessM) continue;
      if (other.NormalAt(middle).dot(face_.curve.NormalAt(middle)) < kParallelCosine) continue;
      const double a = other.Parameter(from);
      const double b = other.Parameter(to);
      if (SolidShare(faces_[i], seen_[i], std::min(a, b), std::max(a, b)) > kMostly) {
        return false;
      }
    }
    return true;
  }

  bool HasDoorOpposite(const Gap& gap, const std::vector<Stretches>& closed) const {
    const Eigen::Vector2d middle =
        0.5 * (face_.curve.At(gap.from_m) + face_.curve.At(gap.to_m));
    for (size_t i = 0; i < faces_.size(); ++i) {
      const WallCurve& other = faces_[i].curve;
      const double behind = -other.SignedDistance(middle);
      if (behind <= 0.0 || behind > kMaxThicknessM) continue;
      if (other.NormalAt(middle).dot(face_.curve.NormalAt(middle)) > -kParallelCosine)
        continue;
      const double s = other.Parameter(middle);
      for (const DoorGap& door : closed[i].doors) {
        if (s > door.from_m && s < door.to_m) return true;
      }
    }
    return false;
  }

  void MarkWindow(const Gap& gap) {
    for (size_t i = gap.first; i < gap.last; ++i) stretches_.windows[i] = true;
  }

  void CloseAs(const Gap& gap, ColumnState state) {
    if (state == ColumnState::kDoor) stretches_.doors.push_back(DoorIn(gap));
    for (size_t i = gap.first; i < gap.last; ++i) {
      if (stretches_.states[i] != ColumnState::kSolid) stretches_.states[i] = state;
    }
  }

  // A jamb lies between the last beam that hit the face and the first one that passed: in the
  // middle, with the deviation of a uniform distribution, and never known better than
  // kJambStddevM.
  DoorGap DoorIn(const Gap& gap) const {
    Stretch passed;
    for (size_t i = gap.first; i < gap.last; ++i) {
      if (stretches_.states[i] != ColumnState::kOpen) continue;
      for (const float s : {face_.pass_ends[i].from_m, face_.pass_ends[i].to_m}) {
        passed.Extend(std::clamp(static_cast<double>(s), gap.from_m, gap.to_m));
      }
    }
    const double left = static_cast<double>(passed.from_m) - gap.from_m;
    const double right = gap.to_m - static_cast<double>(passed.to_m);
    return {
        gap.from_m + 0.5 * left,
        gap.to_m - 0.5 * right,
        std::sqrt((left * left + right * right) / 12.0 + 2.0 * kJambStddevM * kJambStddevM),
        gap.HasLintel(),
        gap.ReachesFloor(),
        gap.LeadsIndoors()};
  }

  size_t at_;
  const std::vector<WallFace>& faces_;
  const std::vector<Stretches>& seen_;
  const WallFace& face_;
  std::vector<CrossingWall> walls_;
  Stretches& stretches_;
  std::vector<Gap> doubtful_;
};

}  // namespace

std::vector<FaceCrossing> CrossingsOf(size_t face, const std::vector<WallFace>& faces) {
  std::vector<FaceCrossing> crossings;
  const WallFace& own = faces[face];
  for (size_t i = 0; i < faces.size(); ++i) {
    const WallFace& other = faces[i];
    if (i == face || (own.curve.IsArc() && other.curve.IsArc())) continue;
    const bool swap = own.curve.IsArc();
    const WallFace& line = swap ? other : own;
    const WallFace& crossed = swap ? own : other;
    const Eigen::Vector2d a = line.curve.At(line.start_m);
    const Eigen::Vector2d b = line.curve.At(line.end_m());
    crossed.curve.ForEachCrossing(a, b, [&](double share, double s) {
      const Eigen::Vector2d p = a + share * (b - a);
      const Eigen::Vector2d normal = line.curve.NormalAt(p);
      const Eigen::Vector2d other_normal = crossed.curve.NormalAt(p);
      const double sine = normal.x() * other_normal.y() - normal.y() * other_normal.x();
      if (std::abs(sine) < kMinCrossingSine) return;
      const double line_s = line.curve.Parameter(p);
      crossings.push_back({i, swap ? s : line_s, swap ? line_s : s});
    });
  }
  std::sort(crossings.begin(), crossings.end(), [](const auto& a, const auto& b) {
    return a.s != b.s ? a.s < b.s : a.face < b.face;
  });
  return crossings;
}

std::vector<SolidRun> SolidRuns(const WallFace& face, const Stretches& stretches) {
  std::vector<SolidRun> runs;
  for (size_t i = 0; i < stretches.states.size();) {
    size_t end = i;
    while (end < stretches.states.size() && stretches.states[end] == ColumnState::kSolid)
      ++end;
    if (end - i >= size_t{kMinBeams}) {
      // A wall ends within the next column, where beams hit a part of it and pass the rest;
      // before that may be columns that were hardly seen.
      const auto was_hit = [&face](size_t column) { return !face.hit_ends[column].IsEmpty(); };
      const auto is_unseen = [&](size_t column) {
        return stretches.states[column] == ColumnState::kUnseen;
      };
      size_t first = i;
      while (first > 0 && was_hit(first - 1) && (first == i || is_unseen(first))) --first;
      size_t last = end - 1;
      while (last + 1 < face.columns.size() && was_hit(last + 1) &&
             (last == end - 1 || is_unseen(last))) {
        ++last;
      }
      runs.push_back({static_cast<double>(face.hit_ends[first].from_m),
                      static_cast<double>(face.hit_ends[last].to_m)});
    }
    i = std::max(end, i + 1);
  }
  return runs;
}

std::vector<Stretches> FindStretches(const std::vector<WallFace>& faces) {
  std::vector<Stretches> stretches(faces.size());
  for (size_t i = 0; i < faces.size(); ++i) {
    for (const WallColumn& column : faces[i].columns) {
      bool is_window = false;
      stretches[i].states.push_back(Judge(column, &is_window));
      stretches[i].windows.push_back(is_window);
    }
  }
  // Gaps are judged by what beams saw of the walls, not by gaps that have been closed before.
  const std::vector<Stretches> seen = stretches;
  std::vector<GapCloser> closers;
  for (size_t i = 0; i < faces.size(); ++i) {
    closers.emplace_back(i, faces, seen, &stretches[i]).Close();
  }
  const std::vector<Stretches> closed = stretches;
  for (GapCloser& closer : closers) closer.CloseOpposite(closed);
  return stretches;
}

}  // namespace plumbline
