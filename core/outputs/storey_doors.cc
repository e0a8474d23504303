#include "core/outputs/storey_doors.h"

#include <algorithm>
#include <cmath>

#include "core/outputs/plan_scales.h"
#include "core/outputs/room_outlines.h"

namespace plumbline {
namespace {

// The number of the room that a point lies in; 0: none.
int RoomAt(const std::vector<Room>& rooms, const Eigen::Vector2d& p) {
  for (const Room& room : rooms) {
    if (IsInside(room.loops, p)) return room.number;
  }
  return 0;
}

struct FaceGap {
  size_t face = 0;
  DoorGap gap;
  Eigen::Vector2d from;
  Eigen::Vector2d to;
  Eigen::Vector2d normal;
  bool is_used = false;
  Eigen::Vector2d Middle() const { return 0.5 * (from + to); }
};

std::vector<FaceGap> GapsOf(const StoreyRegions& regions) {
  std::vector<FaceGap> gaps;
  for (size_t i = 0; i < regions.faces.size(); ++i) {
    const WallCurve& curve = regions.faces[i].curve;
    for (const DoorGap& gap : regions.stretches[i].doors) {
      FaceGap& added = gaps.emplace_back();
      added.face = i;
      added.gap = gap;
      added.from = curve.At(gap.from_m);
      added.to = curve.At(gap.to_m);
      added.normal = curve.NormalAt(added.Middle());
    }
  }
  return gaps;
}

// How far behind the first gap the second one lies, where it is the same door; else negative.
double DepthBetween(const FaceGap& a, const FaceGap& b) {
  if (a.normal.dot(b.normal) > -kParallelCosine) return -1.0;
  const Eigen::Vector2d to_b = b.Middle() - a.Middle();
  const double depth = -a.normal.dot(to_b);
  const double aside = (to_b + depth * a.normal).norm();
  const double width = std::min((a.to - a.from).norm(), (b.to - b.from).norm());
  return depth > 0.0 && depth < kMaxThicknessM && aside < 0.5 * width ? depth : -1.0;
}

// Area and half the perimeter of a cell without its holes and antennas, roughly.
struct CellSize {
  double area_m2 = 0.0;
  double half_perimeter_m = 0.0;
  // The shorter side of a rectangle of this size.
  double Thickness() const {
    const double root = half_perimeter_m * half_perimeter_m - 4.0 * area_m2;
    return 0.5 * (half_perimeter_m - std::sqrt(std::max(0.0, root)));
  }
};

std::vector<CellSize> SizesOf(const StoreyRegions& regions) {
  std::vector<CellSize> sizes(regions.plan.cells.size());
  for (const PlanSubdivision::HalfEdge& edge : regions.plan.half_edges) {
    const Eigen::Vector2d& a = regions.plan.points[static_cast<size_t>(edge.origin)];
    const Eigen::Vector2d& b = regions.plan.points[static_cast<size_t>(edge.target)];
    CellSize& size = sizes[static_cast<size_t>(edge.cell)];
    size.area_m2 += 0.5 * (a.x() * b.y() - a.y() * b.x());
    size.half_perimeter_m += 0.5 * regions.Length(edge);
  }
  return sizes;
}

// Finds the cells that are solid.
class SolidFinder {
 public:
  SolidFinder(const std::vector<bool>& kept_rooms, const StoreyRegions& regions)
      : kept_(kept_rooms),
        regions_(regions),
        sizes_(SizesOf(regions)),
        solid_(regions.plan.cells.size(), false) {}

  std::vector<bool> Find() {
    MarkEnclosed();
    MarkBetweenFaces();
    MarkCorners();
    for (size_t i = 0; i < solid_.size(); ++i) {
      if (regions_.rig_in_cell[i]) solid_[i] = false;
    }
    return solid_;
  }

 private:
  int OtherCell(const PlanSubdivision::HalfEdge& edge) const {
    return regions_.plan.half_edges[static_cast<size_t>(edge.twin)].cell;
  }
  bool InRoom(int cell) const {
    const int room = regions_.room_of_cell[static_cast<size_t>(cell)];
    return room >= 0 && kept_[static_cast<size_t>(room)];
  }

  // Solids that rooms enclose: pillars, shafts.
  void MarkEnclosed() {
    constexpr double kMaxAreaM2 = 4.0;
    std::vector<std::vector<int>> neighbours(solid_.size());
    for (const PlanSubdivision::HalfEdge& edge : regions_.plan.half_edges) {
      if (!InRoom(OtherCell(edge))) {
        neighbours[static_cast<size_t>(edge.cell)].push_back(OtherCell(edge));
      }
    }
    std::vector<bool> seen(solid_.size(), false);
    for (size_t i = 0; i < solid_.size(); ++i) {
      if (seen[i] || InRoom(static_cast<int>(i))) continue;
      std::vector<size_t> region;
      std::vector<size_t> waiting = {i};
      bool is_outside = false;
      double area_m2 = 0.0;
      while (!waiting.empty()) {
        const size_t cell = waiting.back();
        waiting.pop_back();
        if (seen[cell]) continue;
        seen[cell] = true;
        region.push_back(cell);
        is_outside = is_outside || regions_.plan.cells[cell].is_unbounded;
        area_m2 += sizes_[cell].area_m2;
        for (const int next : neighbours[cell]) waiting.push_back(static_cast<size_t>(next));
      }
      if (is_outside || area_m2 > kMaxAreaM2) continue;
      for (const size_t cell : region) solid_[cell] = true;
    }
  }

  // Thin cells that lie behind two faces which look away from each other.
  void MarkBetweenFaces() {
    std::vector<std::vector<Eigen::Vector2d>> normals(solid_.size());
    for (const PlanSubdivision::HalfEdge& edge : regions_.plan.half_edges) {
      const auto cell = static_cast<size_t>(edge.cell);
      if (edge.label < 0 || InRoom(edge.cell) || sizes_[cell].Thickness() > kMaxThicknessM ||
          regions_.plan.cells[cell].is_unbounded) {
        continue;
      }
      const Eigen::Vector2d& a = regions_.plan.points[static_cast<size_t>(edge.origin)];
      const Eigen::Vector2d& b = regions_.plan.points[static_cast<size_t>(edge.target)];
      const Eigen::Vector2d normal =
          regions_.faces[static_cast<size_t>(edge.label)].curve.NormalAt(0.5 * (a + b));
      const Eigen::Vector2d inward(-(b - a).y(), (b - a).x());
      if (normal.dot(inward) > 0.0 || regions_.SharesOf(edge).closed < kMostly) continue;
      for (const Eigen::Vector2d& other : normals[cell]) {
        if (other.dot(normal) < -kParallelCosine) solid_[cell] = true;
      }
      normals[cell].push_back(normal);
    }
  }

  // Small cells that at least two solid ones touch: where walls meet.
  void MarkCorners() {
    std::vector<int> num_solid(solid_.size(), 0);
    for (const PlanSubdivision::HalfEdge& edge : regions_.plan.half_edges) {
      if (solid_[static_cast<size_t>(OtherCell(edge))])
        ++num_solid[static_cast<size_t>(edge.cell)];
    }
    for (size_t i = 0; i < solid_.size(); ++i) {
      if (num_solid[i] >= 2 && !InRoom(static_cast<int>(i)) &&
          sizes_[i].half_perimeter_m < 2.0 * kMaxThicknessM) {
        solid_[i] = true;
      }
    }
  }

  const std::vector<bool>& kept_;
  const StoreyRegions& regions_;
  std::vector<CellSize> sizes_;
  std::vector<bool> solid_;
};

}  // namespace

namespace {

// All gaps of the storey, those of the two faces of a wall as one, between whatever rooms.
std::vector<PlanDoor> PairedGaps(const StoreyRegions& regions,
                                 const std::vector<PlanePatch>& planes,
                                 const std::vector<Room>& rooms) {
  std::vector<FaceGap> gaps = GapsOf(regions);
  std::vector<PlanDoor> doors;
  for (size_t i = 0; i < gaps.size(); ++i) {
    if (gaps[i].is_used) continue;
    const FaceGap& gap = gaps[i];
    PlanDoor& door = doors.emplace_back();
    door.from = gap.from;
    door.to = gap.to;
    door.normal = gap.normal;
    door.plane_id = planes[regions.faces[gap.face].planes.front()].id;
    door.width_m = (gap.to - gap.from).norm();
    door.width_stddev_m = gap.gap.stddev_m;
    door.has_lintel = gap.gap.has_lintel;
    door.reaches_floor = gap.gap.reaches_floor;
    door.leads_indoors = gap.gap.leads_indoors;
    for (size_t k = i + 1; k < gaps.size(); ++k) {
      const double depth = DepthBetween(gap, gaps[k]);
      if (depth < 0.0 || gaps[k].is_used) continue;
      gaps[k].is_used = true;
      door.has_lintel = door.has_lintel || gaps[k].gap.has_lintel;
      door.reaches_floor = door.reaches_floor || gaps[k].gap.reaches_floor;
      door.leads_indoors = door.leads_indoors || gaps[k].gap.leads_indoors;
      door.depth_m = depth;
      door.width_m = 0.5 * (door.width_m + (gaps[k].to - gaps[k].from).norm());
      door.width_stddev_m /= std::sqrt(2.0);
      break;
    }
    door.rooms[0] = RoomAt(rooms, gap.Middle() + WallFace::kColumnM * gap.normal);
    for (double behind = door.depth_m + WallFace::kColumnM;
         door.rooms[1] == 0 && behind < kMaxThicknessM + WallFace::kColumnM;
         behind += WallFace::kColumnM) {
      door.rooms[1] = RoomAt(rooms, gap.Middle() - behind * gap.normal);
    }
  }
  return doors;
}

// An opening behind which there is no room, and beams that went through met no ceiling.
bool IsWindow(const PlanDoor& door) {
  return (door.rooms[0] == 0) != (door.rooms[1] == 0) && !door.leads_indoors;
}

}  // namespace

std::vector<PlanDoor> FindDoors(const StoreyRegions& regions,
                                const std::vector<PlanePatch>& planes,
                                const std::vector<Room>& rooms) {
  std::vector<PlanDoor> doors;
  for (const PlanDoor& door : PairedGaps(regions, planes, rooms)) {
    // Where one can walk round to the other side, both are one room, and the wall between
    // still has its door. A gap in a single face, such as that beside a pillar, is none.
    const bool is_in_wall = door.depth_m > 0.0 || door.has_lintel;
    const bool is_door = door.rooms[0] != door.rooms[1] || (door.rooms[0] != 0 && is_in_wall);
    if (is_door && !IsWindow(door)) doors.push_back(door);
  }
  return doors;
}

namespace {

// Of a window between two columns: both jambs with a uniform deviation.
double WidthStddev(const WallFace& face, size_t from, size_t to) {
  const auto is_wall = [&face](size_t column) {
    int hits = 0;
    for (size_t level = WallColumn::kNumLow; level < WallColumn::kNumLevels; ++level) {
      hits += face.columns[column].hits[level];
    }
    return hits > 0;
  };
  size_t before = from;
  while (before > 0 && !is_wall(before - 1)) --before;
  size_t after = to;
  while (after < face.columns.size() && !is_wall(after)) ++after;
  const double left_m = WallFace::kColumnM * static_cast<double>(from - before + 1);
  const double right_m = WallFace::kColumnM * static_cast<double>(after - to + 1);
  return std::sqrt((left_m * left_m + right_m * right_m) / 12.0 +
                   2.0 * kJambStddevM * kJambStddevM);
}

}  // namespace

namespace {

// A window on a face: where along it, m.
struct FaceWindow {
  double from_m = 0.0;
  double to_m = 0.0;
  double stddev_m = 0.0;  // of its width
  bool reaches_floor = false;
};

// Panes between which there are posts only are one window.
std::vector<FaceWindow> WithoutPosts(std::vector<FaceWindow> panes) {
  std::sort(panes.begin(), panes.end(), [](const FaceWindow& a, const FaceWindow& b) {
    return a.from_m < b.from_m;
  });
  std::vector<FaceWindow> windows;
  for (const FaceWindow& pane : panes) {
    if (windows.empty() || pane.from_m - windows.back().to_m >= kMinWallM) {
      windows.push_back(pane);
      continue;
    }
    // Either width has one jamb left.
    FaceWindow& window = windows.back();
    window.to_m = std::max(window.to_m, pane.to_m);
    window.stddev_m = std::sqrt(0.5) * std::hypot(window.stddev_m, pane.stddev_m);
    window.reaches_floor = window.reaches_floor || pane.reaches_floor;
  }
  return windows;
}

}  // namespace

std::vector<PlanWindow> FindWindows(const StoreyRegions& regions,
                                    const std::vector<PlanePatch>& planes,
                                    const std::vector<Room>& rooms) {
  constexpr double kMinWindowM = 0.4;
  std::vector<PlanDoor> openings = PairedGaps(regions, planes, rooms);
  std::vector<PlanWindow> windows;
  for (size_t i = 0; i < regions.faces.size(); ++i) {
    const WallFace& face = regions.faces[i];
    const std::vector<bool>& is_window = regions.stretches[i].windows;
    std::vector<FaceWindow> panes;
    for (const PlanDoor& opening : openings) {
      if (opening.plane_id != planes[face.planes.front()].id || !IsWindow(opening)) continue;
      const double a = face.curve.Parameter(opening.from);
      const double b = face.curve.Parameter(opening.to);
      panes.push_back(
          {std::min(a, b), std::max(a, b), opening.width_stddev_m, opening.reaches_floor});
    }
    for (size_t from = 0; from < is_window.size();) {
      size_t to = from;
      while (to < is_window.size() && is_window[to]) ++to;
      if (to > from) {
        const auto at = [&face](size_t column) {
          return face.start_m + WallFace::kColumnM * static_cast<double>(column);
        };
        panes.push_back({at(from), at(to), WidthStddev(face, from, to)});
      }
      from = std::max(to, from + 1);
    }
    for (const FaceWindow& window : WithoutPosts(panes)) {
      if (window.to_m - window.from_m < kMinWindowM) continue;
      const Eigen::Vector2d middle = face.curve.At(0.5 * (window.from_m + window.to_m));
      const Eigen::Vector2d before = WallFace::kColumnM * face.curve.NormalAt(middle);
      if (RoomAt(rooms, middle + before) != 0 && RoomAt(rooms, middle - before) == 0) {
        windows.push_back({face.curve.At(window.from_m),
                           face.curve.At(window.to_m),
                           window.stddev_m,
                           window.reaches_floor});
      }
    }
  }
  return windows;
}

std::vector<std::vector<Eigen::Vector2d>> FindSolids(const std::vector<bool>& kept_rooms,
                                                     StoreyRegions regions,
                                                     const std::vector<PlanePatch>& planes,
                                                     double section_m) {
  const std::vector<bool> solid = SolidFinder(kept_rooms, regions).Find();
  // Traced as if they were a room.
  for (size_t i = 0; i < solid.size(); ++i) regions.room_of_cell[i] = solid[i] ? 0 : -1;
  std::vector<std::vector<Eigen::Vector2d>> outlines;
  for (const RoomLoop& loop : TraceRoom(0, regions, planes, section_m)) {
    std::vector<Eigen::Vector2d>& outline = outlines.emplace_back();
    for (const RoomEdge& edge : loop) outline.push_back(edge.from);
  }
  return outlines;
}

}  // namespace plumbline
