#include "core/outputs/storey_planner.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/outputs/plan_scales.h"
#include "core/outputs/region_labels.h"

namespace plumbline {
namespace {

constexpr int kFrameLabel = -1;  // of the box of all that is solid, and of one round it
constexpr int kEndLabel = -2;    // of lines across the ends of free-standing walls
// By how much a chord leaves its arc, and a line goes beyond the face that it has to meet.
constexpr double kMaxSagittaM = 0.001;

void AddFrame(const Eigen::AlignedBox2d& box, std::vector<PlanSegment>* segments) {
  const Eigen::Vector2d low = box.min();
  const Eigen::Vector2d high = box.max();
  const Eigen::Vector2d corners[] = {low, {high.x(), low.y()}, high, {low.x(), high.y()}};
  for (size_t i = 0; i < 4; ++i) {
    segments->push_back({corners[i], corners[(i + 1) % 4], kFrameLabel});
  }
}

// The box of all solid stretches, and a little more, so that walls which are not quite level
// with it lie within.
Eigen::AlignedBox2d BoxOfWalls(const std::vector<WallFace>& faces,
                               const std::vector<Stretches>& stretches) {
  Eigen::AlignedBox2d box;
  for (size_t i = 0; i < faces.size(); ++i) {
    for (const SolidRun& run : SolidRuns(faces[i], stretches[i])) {
      for (double s = run.from_m; s < run.to_m; s += WallFace::kColumnM) {
        box.extend(faces[i].curve.At(s));
      }
      box.extend(faces[i].curve.At(run.to_m));
    }
  }
  const Eigen::Vector2d margin(WallFace::kColumnM, WallFace::kColumnM);
  if (box.isEmpty()) return box;
  return {Eigen::Vector2d(box.min() - margin), Eigen::Vector2d(box.max() + margin)};
}

// An arc as chords, where it was seen and a little beyond.
void AddArc(const WallFace& face,
            const Stretches& stretches,
            int label,
            std::vector<PlanSegment>* segments) {
  const std::vector<SolidRun> runs = SolidRuns(face, stretches);
  if (runs.empty()) return;
  const double half_turn = M_PI * face.curve.radius_m();
  const double from = std::max(-half_turn, runs.front().from_m - kLongWallM);
  const double to = std::min(half_turn, runs.back().to_m + kLongWallM);
  const double chord = 2.0 * std::sqrt(2.0 * kMaxSagittaM * face.curve.radius_m());
  const int count = std::max(1, static_cast<int>(std::ceil((to - from) / chord)));
  const Eigen::Vector2d begin = face.curve.At(from);
  // A whole circle ends where it begins, to the last bit: else it encloses nothing.
  const Eigen::Vector2d end =
      from == -half_turn && to == half_turn ? begin : face.curve.At(to);
  Eigen::Vector2d last = begin;
  for (int i = 1; i <= count; ++i) {
    const Eigen::Vector2d next =
        i < count ? face.curve.At(from + (to - from) * i / count) : end;
    segments->push_back({last, next, label});
    last = next;
  }
}

// Lines backwards from the ends of solid runs where the wall just ends: its other sides may
// not have been seen as surfaces.
void AddEnds(size_t at,
             const std::vector<WallFace>& faces,
             const Stretches& stretches,
             std::vector<PlanSegment>* segments) {
  const WallFace& face = faces[at];
  const std::vector<FaceCrossing> crossings = CrossingsOf(at, faces);
  for (const SolidRun& run : SolidRuns(face, stretches)) {
    for (const bool is_begin : {true, false}) {
      const double s = is_begin ? run.from_m : run.to_m;
      const int column = face.ColumnOf(s) + (is_begin ? -1 : 1);
      if (column < 0 || column >= static_cast<int>(face.columns.size())) continue;
      const ColumnState beyond = stretches.states[static_cast<size_t>(column)];
      if (beyond == ColumnState::kSolid || beyond == ColumnState::kBridged) continue;
      if (std::any_of(crossings.begin(), crossings.end(), [s](const FaceCrossing& crossing) {
            return std::abs(crossing.s - s) < kSameM;
          })) {
        continue;
      }
      const Eigen::Vector2d p = face.curve.At(s);
      const Eigen::Vector2d normal = face.curve.NormalAt(p);
      segments->push_back({p + kMaxSagittaM * normal, p - kLongWallM * normal, kEndLabel});
    }
  }
}

// SquareMap says in which cell the middle of each square of the free grid lies.
class SquareMap {
 public:
  SquareMap(const PlanSubdivision& plan, const Eigen::AlignedBox2d& box)
      : box_(box),
        num_columns_(static_cast<int>(std::ceil(box.sizes().x() / FreeGrid::kCellM))),
        rows_(static_cast<size_t>(std::ceil(box.sizes().y() / FreeGrid::kCellM))) {
    // A cell is on the left of its half-edges, so that east of one that goes down its cell
    // begins: in each row, a square lies in the cell of the last such edge before it.
    const int num_rows = static_cast<int>(rows_.size());
    std::vector<std::vector<std::pair<double, int>>> crossings(rows_.size());
    for (const PlanSubdivision::HalfEdge& edge : plan.half_edges) {
      const Eigen::Vector2d& a = plan.points[static_cast<size_t>(edge.origin)];
      const Eigen::Vector2d& b = plan.points[static_cast<size_t>(edge.target)];
      if (a.y() <= b.y()) continue;
      for (int row = RowFrom(b.y()); row < num_rows && RowY(row) < a.y(); ++row) {
        if (row < 0) continue;
        const double x = a.x() + (RowY(row) - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
        crossings[static_cast<size_t>(row)].emplace_back(x, edge.cell);
      }
    }
    for (size_t row = 0; row < rows_.size(); ++row) {
      std::sort(crossings[row].begin(), crossings[row].end());
      for (const auto& [x, cell] : crossings[row]) AddRun(ColumnFrom(x), cell, &rows_[row]);
    }
  }

  // The cell of the square that a point lies in; -1 outside.
  int CellAt(const Eigen::Vector2d& p) const {
    const double column = std::floor((p.x() - box_.min().x()) / FreeGrid::kCellM);
    const double row = std::floor((p.y() - box_.min().y()) / FreeGrid::kCellM);
    if (!(column >= 0.0 && row >= 0.0 && column < num_columns_ &&
          row < static_cast<double>(rows_.size()))) {
      return -1;
    }
    int cell = -1;
    for (const Run& run : rows_[static_cast<size_t>(row)]) {
      if (run.from <= column) cell = run.cell;
    }
    return cell;
  }

  // Calls visit(cell, row, from, to) for each run of squares of a row that lie in a cell, from
  // the column `from` to the one before `to`.
  template <typename Visit>
  void ForEachRun(Visit visit) const {
    for (size_t row = 0; row < rows_.size(); ++row) {
      const std::vector<Run>& runs = rows_[row];
      for (size_t i = 0; i < runs.size(); ++i) {
        const int to = i + 1 < runs.size() ? runs[i + 1].from : num_columns_;
        if (runs[i].cell < 0) continue;
        visit(static_cast<size_t>(runs[i].cell), static_cast<int>(row), runs[i].from, to);
      }
    }
  }

 private:
  // Squares of a row that lie in one cell, from this column to the next run's.
  struct Run {
    int from = 0;
    int cell = -1;
  };

  void AddRun(int from, int cell, std::vector<Run>* runs) const {
    if (from >= num_columns_) return;
    if (!runs->empty() && runs->back().from == from) {
      runs->back().cell = cell;
    } else {
      runs->push_back({from, cell});
    }
  }
  double RowY(int row) const { return box_.min().y() + (row + 0.5) * FreeGrid::kCellM; }
  int RowFrom(double y) const {
    return static_cast<int>(std::ceil((y - box_.min().y()) / FreeGrid::kCellM - 0.5));
  }
  // The first column whose middle does not lie before x.
  int ColumnFrom(double x) const {
    return std::max(
        0, static_cast<int>(std::ceil((x - box_.min().x()) / FreeGrid::kCellM - 0.5)));
  }

  Eigen::AlignedBox2d box_;
  int num_columns_;
  std::vector<std::vector<Run>> rows_;
};

// Returns for each cell whether it lies outdoors: at the frame or beyond, where the rig never
// was and into which no wall looks. Beams go there through windows and open doors, and see the
// ground. inside_m: of each cell, how much of walls' faces looks into it.
std::vector<bool> OutdoorCells(const PlanSubdivision& plan,
                               const std::vector<bool>& rig_in_cell,
                               const std::vector<double>& inside_m) {
  std::vector<bool> outdoors(plan.cells.size(), false);
  for (const PlanSubdivision::HalfEdge& edge : plan.half_edges) {
    const auto cell = static_cast<size_t>(edge.cell);
    if (edge.label == kFrameLabel) outdoors[cell] = inside_m[cell] < kLongWallM;
  }
  for (size_t i = 0; i < outdoors.size(); ++i) {
    if (rig_in_cell[i]) outdoors[i] = false;
  }
  return outdoors;
}

// Evidence for and against a cell being free, without the beams that passed it.
struct WallEvidence {
  std::vector<CellCost> cells;
  std::vector<BorderCost> borders;
};

WallEvidence EvidenceOfWalls(const StoreyRegions& regions) {
  constexpr double kOpenBorder = 0.5;
  constexpr double kUnseenBorder = 0.2;
  const PlanSubdivision& plan = regions.plan;
  WallEvidence evidence;
  evidence.cells.resize(plan.cells.size());
  for (size_t i = 0; i < plan.half_edges.size(); ++i) {
    const PlanSubdivision::HalfEdge& edge = plan.half_edges[i];
    if (static_cast<int>(i) > edge.twin) continue;
    const auto cell = static_cast<size_t>(edge.cell);
    const auto twin_cell =
        static_cast<size_t>(plan.half_edges[static_cast<size_t>(edge.twin)].cell);
    const double length = regions.Length(edge);
    if (edge.label < 0) {
      evidence.borders.push_back({cell, twin_cell, kUnseenBorder * length});
      continue;
    }
    const StoreyRegions::EdgeShares shares = regions.SharesOf(edge);
    const Eigen::Vector2d& a = plan.points[static_cast<size_t>(edge.origin)];
    const Eigen::Vector2d& b = plan.points[static_cast<size_t>(edge.target)];
    const Eigen::Vector2d left(-(b - a).y(), (b - a).x());
    const WallCurve& curve = regions.faces[static_cast<size_t>(edge.label)].curve;
    const bool looks_left = curve.NormalAt(0.5 * (a + b)).dot(left) > 0.0;
    evidence.cells[looks_left ? cell : twin_cell].solid += shares.solid * length;
    evidence.cells[looks_left ? twin_cell : cell].free += shares.solid * length;
    evidence.borders.push_back(
        {cell,
         twin_cell,
         (kOpenBorder * shares.open + kUnseenBorder * shares.unseen) * length});
  }
  return evidence;
}

void LabelCells(const FreeGrid& free, const SquareMap& squares, StoreyRegions* regions) {
  constexpr double kFreePerM2 = 4.0;
  constexpr double kUnseenPerM2 = 0.1;
  const PlanSubdivision& plan = regions->plan;
  WallEvidence evidence = EvidenceOfWalls(*regions);
  std::vector<CellCost>& cells = evidence.cells;
  std::vector<double> inside_m;
  for (const CellCost& cell : cells) inside_m.push_back(cell.solid);
  const std::vector<bool> outdoors = OutdoorCells(plan, regions->rig_in_cell, inside_m);
  for (size_t i = 0; i < cells.size(); ++i) {
    if (plan.cells[i].is_unbounded || outdoors[i]) {
      cells[i].free = std::numeric_limits<double>::infinity();
    }
  }
  const double square_m2 = FreeGrid::kCellM * FreeGrid::kCellM;
  squares.ForEachRun([&](size_t cell, int row, int from, int to) {
    const int num_free = free.CountFree(row, from, to);
    cells[cell].solid += kFreePerM2 * square_m2 * num_free;
    cells[cell].free += kUnseenPerM2 * square_m2 * (to - from - num_free);
  });
  regions->is_free = LabelRegions(cells, evidence.borders);
}

// Joins free cells to rooms where no closed edge separates them.
void JoinRooms(StoreyRegions* regions) {
  const PlanSubdivision& plan = regions->plan;
  std::vector<std::vector<int>> neighbours(plan.cells.size());
  for (const PlanSubdivision::HalfEdge& edge : plan.half_edges) {
    const int other = plan.half_edges[static_cast<size_t>(edge.twin)].cell;
    if (!regions->is_free[static_cast<size_t>(edge.cell)] ||
        !regions->is_free[static_cast<size_t>(other)]) {
      continue;
    }
    if (regions->SharesOf(edge).closed >= kMostly) continue;
    neighbours[static_cast<size_t>(edge.cell)].push_back(other);
  }
  regions->room_of_cell.assign(plan.cells.size(), -1);
  int num_rooms = 0;
  for (size_t i = 0; i < plan.cells.size(); ++i) {
    if (!regions->is_free[i] || regions->room_of_cell[i] >= 0) continue;
    std::vector<int> waiting = {static_cast<int>(i)};
    while (!waiting.empty()) {
      const auto cell = static_cast<size_t>(waiting.back());
      waiting.pop_back();
      if (regions->room_of_cell[cell] >= 0) continue;
      regions->room_of_cell[cell] = num_rooms;
      waiting.insert(waiting.end(), neighbours[cell].begin(), neighbours[cell].end());
    }
    ++num_rooms;
  }
  regions->num_rooms = num_rooms;
}

}  // namespace

StoreyRegions::EdgeShares StoreyRegions::SharesOf(
    const PlanSubdivision::HalfEdge& edge) const {
  EdgeShares shares;
  if (edge.label < 0) return shares;
  const WallFace& face = faces[static_cast<size_t>(edge.label)];
  const Stretches& of_face = stretches[static_cast<size_t>(edge.label)];
  double from = face.curve.Parameter(plan.points[static_cast<size_t>(edge.origin)]);
  double to = face.curve.Parameter(plan.points[static_cast<size_t>(edge.target)]);
  if (from > to) std::swap(from, to);
  // At least three samples: edges can be much shorter than a column.
  const int count = std::max(3, static_cast<int>((to - from) / WallFace::kColumnM) * 2);
  for (int i = 0; i < count; ++i) {
    const int column = face.ColumnOf(from + (to - from) * (i + 0.5) / count);
    const ColumnState state =
        column < 0 ? ColumnState::kUnseen : of_face.states[static_cast<size_t>(column)];
    if (state == ColumnState::kSolid) shares.solid += 1.0 / count;
    if (state == ColumnState::kOpen) shares.open += 1.0 / count;
    if (state == ColumnState::kUnseen) shares.unseen += 1.0 / count;
    if (column >= 0 && of_face.IsClosed(static_cast<size_t>(column))) {
      shares.closed += 1.0 / count;
    }
  }
  return shares;
}

double StoreyRegions::Length(const PlanSubdivision::HalfEdge& edge) const {
  return (plan.points[static_cast<size_t>(edge.target)] -
          plan.points[static_cast<size_t>(edge.origin)])
      .norm();
}

StoreyRegions PlanStorey(std::vector<WallFace> faces,
                         const FreeGrid& free,
                         const std::vector<Eigen::Vector2d>& way) {
  StoreyRegions regions;
  regions.stretches = FindStretches(faces);
  regions.faces = std::move(faces);
  std::vector<PlanSegment> segments;
  AddFrame(free.box(), &segments);
  const Eigen::AlignedBox2d walls = BoxOfWalls(regions.faces, regions.stretches);
  if (!walls.isEmpty()) AddFrame(walls, &segments);
  for (size_t i = 0; i < regions.faces.size(); ++i) {
    const WallFace& face = regions.faces[i];
    const int label = static_cast<int>(i);
    if (face.curve.IsArc()) {
      AddArc(face, regions.stretches[i], label, &segments);
    } else {
      segments.push_back({face.curve.At(face.start_m), face.curve.At(face.end_m()), label});
    }
    AddEnds(i, regions.faces, regions.stretches[i], &segments);
  }
  regions.plan = Subdivide(segments);
  const SquareMap squares(regions.plan, free.box());
  regions.rig_in_cell.assign(regions.plan.cells.size(), false);
  for (const Eigen::Vector2d& p : way) {
    const int cell = squares.CellAt(p);
    if (cell >= 0) regions.rig_in_cell[static_cast<size_t>(cell)] = true;
  }
  LabelCells(free, squares, &regions);
  JoinRooms(&regions);
  return regions;
}

}  // namespace plumbline
