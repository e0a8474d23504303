#include "core/outputs/room_outlines.h"

#include <algorithm>
#include <cmath>
#include <unordered_set>

#include "core/outputs/plan_scales.h"

namespace plumbline {
namespace {

constexpr double kSamePointM = 1e-6;  // rounding

// A stretch of a loop along one line or arc.
struct LoopRun {
  int label = 0;
  int plane_id = -1;
  WallCurve curve;
  std::vector<Eigen::Vector2d> points;  // from its begin to the one before its end
  std::vector<double> closed_m;         // of each piece
};

// TraceLoop's walk round a room.
class Tracer {
 public:
  Tracer(int room, const StoreyRegions& regions) : room_(room), regions_(regions) {}

  bool IsBoundary(int half_edge) const {
    const auto& edges = regions_.plan.half_edges;
    const PlanSubdivision::HalfEdge& edge = edges[static_cast<size_t>(half_edge)];
    return InRoom(edge) && !InRoom(edges[static_cast<size_t>(edge.twin)]);
  }

  // The half-edges of the loop that begins with one on the boundary.
  std::vector<int> Trace(int start) const {
    const auto& edges = regions_.plan.half_edges;
    std::vector<int> loop;
    int at = start;
    do {
      loop.push_back(at);
      at = edges[static_cast<size_t>(at)].next;
      while (!IsBoundary(at)) {
        const int twin = edges[static_cast<size_t>(at)].twin;
        at = edges[static_cast<size_t>(twin)].next;
      }
    } while (at != start);
    return loop;
  }

 private:
  bool InRoom(const PlanSubdivision::HalfEdge& edge) const {
    return regions_.room_of_cell[static_cast<size_t>(edge.cell)] == room_;
  }

  int room_;
  const StoreyRegions& regions_;
};

// Whether an edge goes on along the line of the one before.
bool GoesOn(const StoreyRegions& regions,
            const PlanSubdivision::HalfEdge& before,
            const PlanSubdivision::HalfEdge& edge) {
  if (before.label != edge.label) return false;
  if (edge.label >= 0 && regions.faces[static_cast<size_t>(edge.label)].curve.IsArc()) {
    return true;
  }
  const auto& points = regions.plan.points;
  const Eigen::Vector2d a =
      points[static_cast<size_t>(before.target)] - points[static_cast<size_t>(before.origin)];
  const Eigen::Vector2d b =
      points[static_cast<size_t>(edge.target)] - points[static_cast<size_t>(edge.origin)];
  return std::abs(a.x() * b.y() - a.y() * b.x()) < kSamePointM * a.norm() * b.norm() &&
         a.dot(b) > 0.0;
}

// Returns the surface of the run's face that was hit most along it.
size_t StrongestPlane(const WallFace& face, double from, double to) {
  if (from > to) std::swap(from, to);
  size_t best = 0;
  uint64_t most = 0;
  for (size_t k = 0; k < face.planes.size(); ++k) {
    uint64_t hits = 0;
    for (size_t i = 0; i < face.columns.size(); ++i) {
      const double s = face.start_m + (static_cast<double>(i) + 0.5) * WallFace::kColumnM;
      if (s > from && s < to) hits += face.plane_hits[k][i];
    }
    if (hits > most) {
      most = hits;
      best = k;
    }
  }
  return face.planes[best];
}

void FinishRun(const StoreyRegions& regions,
               const std::vector<PlanePatch>& planes,
               double section_m,
               const Eigen::Vector2d& end,
               LoopRun* run) {
  if (run->label < 0) {
    run->curve = WallCurve::Through(run->points.front(), end);
    return;
  }
  const WallFace& face = regions.faces[static_cast<size_t>(run->label)];
  const PlanePatch& plane = planes[StrongestPlane(
      face, face.curve.Parameter(run->points.front()), face.curve.Parameter(end))];
  run->plane_id = plane.id;
  run->curve = WallCurve(plane, section_m);
}

std::vector<LoopRun> RunsOf(const std::vector<int>& loop,
                            const StoreyRegions& regions,
                            const std::vector<PlanePatch>& planes,
                            double section_m) {
  const auto edge_at = [&](size_t i) -> const PlanSubdivision::HalfEdge& {
    return regions.plan.half_edges[static_cast<size_t>(loop[i % loop.size()])];
  };
  size_t first = 0;
  while (first < loop.size() &&
         GoesOn(regions, edge_at(first + loop.size() - 1), edge_at(first))) {
    ++first;
  }
  std::vector<LoopRun> runs;
  for (size_t i = 0; i < loop.size(); ++i) {
    const PlanSubdivision::HalfEdge& edge = edge_at(first + i);
    if (i == 0 || !GoesOn(regions, edge_at(first + i - 1), edge)) {
      runs.emplace_back().label = edge.label;
    }
    runs.back().points.push_back(regions.plan.points[static_cast<size_t>(edge.origin)]);
    runs.back().closed_m.push_back(regions.SharesOf(edge).closed * regions.Length(edge));
  }
  for (size_t i = 0; i < runs.size(); ++i) {
    FinishRun(
        regions, planes, section_m, runs[(i + 1) % runs.size()].points.front(), &runs[i]);
  }
  return runs;
}

RoomLoop LoopOf(std::vector<LoopRun> runs) {
  std::vector<Eigen::Vector2d> corners;
  for (size_t i = 0; i < runs.size(); ++i) {
    const LoopRun& before = runs[(i + runs.size() - 1) % runs.size()];
    corners.push_back(
        runs.size() < 2 ? runs[i].points.front()
                        : Meet(before.curve, runs[i].curve, runs[i].points.front(), kBesideM));
  }
  RoomLoop loop;
  for (size_t i = 0; i < runs.size(); ++i) {
    LoopRun& run = runs[i];
    run.points.front() = corners[i];
    double closed_m = 0.0;
    for (size_t k = 0; k < run.points.size(); ++k) {
      // A straight run is one edge; an arc keeps its chords.
      if (k > 0 && !run.curve.IsArc()) {
        loop.back().closed_m += run.closed_m[k];
        continue;
      }
      closed_m = run.closed_m[k];
      loop.push_back({run.points[k], run.plane_id, closed_m});
    }
  }
  for (size_t i = 0; i < loop.size() && loop.size() > 3;) {
    const Eigen::Vector2d& next = loop[(i + 1) % loop.size()].from;
    if ((next - loop[i].from).norm() < kSamePointM) {
      loop.erase(loop.begin() + static_cast<std::ptrdiff_t>(i));
    } else {
      ++i;
    }
  }
  return loop;
}

}  // namespace

double LoopArea(const RoomLoop& loop) {
  double twice = 0.0;
  for (size_t i = 0; i < loop.size(); ++i) {
    const Eigen::Vector2d& a = loop[i].from;
    const Eigen::Vector2d& b = loop[(i + 1) % loop.size()].from;
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return 0.5 * twice;
}

bool IsInside(const std::vector<RoomLoop>& loops, const Eigen::Vector2d& p) {
  bool inside = false;
  for (const RoomLoop& loop : loops) {
    for (size_t i = 0; i < loop.size(); ++i) {
      const Eigen::Vector2d& a = loop[i].from;
      const Eigen::Vector2d& b = loop[(i + 1) % loop.size()].from;
      if ((a.y() > p.y()) != (b.y() > p.y()) &&
          p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x())) {
        inside = !inside;
      }
    }
  }
  return inside;
}

std::vector<RoomLoop> TraceRoom(int room,
                                const StoreyRegions& regions,
                                const std::vector<PlanePatch>& planes,
                                double section_m) {
  const Tracer tracer(room, regions);
  std::vector<RoomLoop> loops;
  std::unordered_set<int> done;
  for (size_t i = 0; i < regions.plan.half_edges.size(); ++i) {
    const int start = static_cast<int>(i);
    if (done.count(start) > 0 || !tracer.IsBoundary(start)) continue;
    const std::vector<int> loop = tracer.Trace(start);
    done.insert(loop.begin(), loop.end());
    loops.push_back(LoopOf(RunsOf(loop, regions, planes, section_m)));
  }
  // The outer loop is the only one that runs counter-clockwise.
  std::stable_sort(loops.begin(), loops.end(), [](const RoomLoop& a, const RoomLoop& b) {
    return LoopArea(a) > LoopArea(b);
  });
  return loops;
}

}  // namespace plumbline
