#include "core/floor_plan/wall_stretches.h"

#include <algorithm>
#include <cmath>

namespace plumbline {
namespace {

constexpr double kMinDoorM = 0.6;
constexpr double kMaxDoorM = 1.5;
constexpr double kMaxHiddenM = 5.0;  // what no beam passed is bridged up to here
constexpr double kNearM = 0.25;      // of a crossing: a wall's columns there tell of its end
constexpr double kMinCrossingSine = 0.34;  // 20 degrees

// A place on a face at which a gap ends: a run of its own, or a wall that crosses.
struct GapEnd {
  double from_m = 0.0;
  double to_m = 0.0;
  bool is_own = false;

  // Whether it is a stretch of the face that is no pillar.
  bool IsWall() const {
    constexpr double kMinWallM = 0.3;
    return is_own && to_m - from_m >= kMinWallM;
  }
};

// A wall that crosses, solid at the crossing.
struct CrossingWall {
  double s = 0.0;
  double faces = 0.0;    // the cosine of its normal with the direction of growing s
  bool goes_on = false;  // it is solid well before and well behind the face, not on one side
};

ColumnState Judge(const WallColumn& column, bool* is_window) {
  constexpr int kMinBeams = 2;  // one may be a stray
  int solid[2] = {0, 0};        // low, high
  int open[2] = {0, 0};
  for (size_t level = 0; level < WallColumn::kNumLevels; ++level) {
    const int half = level < WallColumn::kNumLow ? 0 : 1;
    const int hits = column.hits[level];
    const int passes = column.passes[level];
    if (hits >= kMinBeams && hits >= passes) ++solid[half];
    if (passes >= kMinBeams && passes > hits) ++open[half];
  }
  *is_window = false;
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
  constexpr double kGoesOnFromM = 0.2;  // beyond it a wall is no jamb
  constexpr double kGoesOnToM = 0.8;
  constexpr double kGoesOnShare = 0.5;
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
        SolidShare(other, of_other, s - kGoesOnToM, s - kGoesOnFromM) > kGoesOnShare;
    const bool behind =
        SolidShare(other, of_other, s + kGoesOnFromM, s + kGoesOnToM) > kGoesOnShare;
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

// The gaps of one face, closed where they do not stay open.
class GapCloser {
 public:
  GapCloser(const WallFace& face, const std::vector<CrossingWall>& walls, Stretches* stretches)
      : face_(face), walls_(walls), stretches_(*stretches) {}

  void Close() {
    std::vector<GapEnd> ends;
    for (const SolidRun& run : SolidRuns(face_, stretches_)) {
      ends.push_back({run.from_m, run.to_m, true});
    }
    if (ends.empty()) return;
    for (const CrossingWall& wall : walls_) ends.push_back({wall.s, wall.s, false});
    std::sort(ends.begin(), ends.end(), [](const GapEnd& a, const GapEnd& b) {
      return a.from_m < b.from_m;
    });
    GapEnd before = ends.front();
    for (size_t i = 1; i < ends.size(); ++i) {
      const GapEnd& after = ends[i];
      if (after.from_m > before.to_m && (before.is_own || after.is_own)) {
        CloseGap(before, after);
      }
      if (after.to_m >= before.to_m) before = after;
    }
  }

 private:
  void CloseGap(const GapEnd& before, const GapEnd& after) {
    const double from = before.to_m;
    const double to = after.from_m;
    const auto first = static_cast<size_t>(
        std::max(0.0, std::floor((from - face_.start_m) / WallFace::kColumnM)));
    const auto last =
        std::min(face_.columns.size(),
                 static_cast<size_t>(
                     std::max(0.0, std::ceil((to - face_.start_m) / WallFace::kColumnM))));
    int open = 0;
    int lintel = 0;
    for (size_t i = first; i < last; ++i) {
      if (stretches_.states[i] == ColumnState::kOpen) ++open;
      if (face_.columns[i].hits_above > 0) ++lintel;
    }
    const int count = std::max(1, static_cast<int>(last) - static_cast<int>(first));
    const double open_share = static_cast<double>(open) / count;
    const double lintel_share = static_cast<double>(lintel) / count;
    const double width = to - from;
    constexpr double kMinOpen = 0.4;
    constexpr double kMaxHiddenOpen = 0.15;
    constexpr double kMinLintel = 0.5;
    ColumnState state = ColumnState::kBridged;
    if (width > kMaxDoorM && (open_share > kMaxHiddenOpen || width > kMaxHiddenM)) return;
    if (width >= kMinDoorM && width <= kMaxDoorM && open_share >= kMinOpen) {
      const bool has_lintel = lintel_share >= kMinLintel;
      const bool is_between = before.IsWall() && after.IsWall();
      if (!has_lintel && (!is_between || IsRoomWide(walls_, from, to))) return;
      state = ColumnState::kDoor;
      stretches_.doors.push_back(DoorIn(from, to, first, last, has_lintel));
    }
    for (size_t i = first; i < last; ++i) {
      if (stretches_.states[i] != ColumnState::kSolid) stretches_.states[i] = state;
    }
  }

  // A jamb lies between the last beam that hit the face and the first one that passed: in the
  // middle, with the deviation of a uniform distribution. Beams that hit the jamb's own side
  // are taken for hits of the face where they end within its noise, and those at the face's
  // end for none of it, so that a jamb is not known better than to 1.5 cm.
  DoorGap DoorIn(double from, double to, size_t first, size_t last, bool has_lintel) const {
    constexpr double kJambStddevM = 0.015;
    Stretch passed;
    for (size_t i = first; i < last; ++i) {
      if (stretches_.states[i] != ColumnState::kOpen) continue;
      for (const float s : {face_.pass_ends[i].from_m, face_.pass_ends[i].to_m}) {
        passed.Extend(std::clamp(static_cast<double>(s), from, to));
      }
    }
    const double left = static_cast<double>(passed.from_m) - from;
    const double right = to - static_cast<double>(passed.to_m);
    return {
        from + 0.5 * left,
        to - 0.5 * right,
        std::sqrt((left * left + right * right) / 12.0 + 2.0 * kJambStddevM * kJambStddevM),
        has_lintel};
  }

  const WallFace& face_;
  const std::vector<CrossingWall>& walls_;
  Stretches& stretches_;
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
  constexpr size_t kMinColumns = 2;  // one may be a stray
  std::vector<SolidRun> runs;
  for (size_t i = 0; i < stretches.states.size();) {
    size_t end = i;
    while (end < stretches.states.size() && stretches.states[end] == ColumnState::kSolid)
      ++end;
    if (end - i >= kMinColumns) {
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
  for (size_t i = 0; i < faces.size(); ++i) {
    GapCloser(faces[i], WallsAcross(i, faces, seen), &stretches[i]).Close();
  }
  return stretches;
}

}  // namespace plumbline
