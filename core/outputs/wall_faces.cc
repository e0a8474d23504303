#include "core/outputs/wall_faces.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "core/outputs/plan_scales.h"
#include "core/util/quantiles.h"

namespace plumbline {
namespace {

constexpr size_t kMinHits = 50;  // within the band, of a surface that is to be a wall
constexpr double kSameFaceCosine = 0.9994;  // 2 degrees

// A stretch along a surface, m.
struct Extent {
  double first_s = std::numeric_limits<double>::max();
  double last_s = std::numeric_limits<double>::lowest();

  void Add(double s) {
    first_s = std::min(first_s, s);
    last_s = std::max(last_s, s);
  }
  double length_m() const { return last_s - first_s; }
};

// Counts of the points of one surface, as a wall.
struct SurfaceHits {
  size_t in_band = 0;
  std::vector<float> heights_m;  // above the floor, of all its points in the storey
  double sum_clear_m = 0.0;      // of the heights of the ceilings above the floors there
  Extent in_band_extent;
  Extent extent;  // of all of them

  // Height of the ceiling above the floor.
  double ClearHeight() const { return sum_clear_m / static_cast<double>(heights_m.size()); }
  // Range of the parameter in which it is a wall.
  const Extent& Wall() const { return in_band >= kMinHits ? in_band_extent : extent; }
};

// Whether it reaches the ceiling, wherever it begins.
bool IsHigh(const StoreyLevel& storey, double top_m, const SurfaceHits& hits) {
  return storey.has_ceiling && hits.heights_m.size() >= kMinHits &&
         top_m > hits.ClearHeight() - kBesideM && hits.extent.length_m() >= kMinWallM;
}

// Whether it reaches the ceiling, or from where people walk to above where they could look
// over.
bool IsWall(const StoreyLevel& storey, const SurfaceHits& hits) {
  constexpr double kMaxBottomM = 1.3;  // above the floor: what is behind a kitchen is a wall
  constexpr double kMinTopM = 1.9;
  constexpr double kMaxNeededM = 2.3;
  constexpr double kBelowCeilingM = 0.5;
  constexpr double kNarrowM = 0.7;  // pillars and jambs, of which less may have been seen
  constexpr double kNarrowTopM = 1.7;
  if (hits.heights_m.empty()) return false;
  if (!storey.has_floor) return hits.in_band >= kMinHits;
  const auto bottom_m = static_cast<double>(SampleQuantile(hits.heights_m, 0.02));
  const auto top_m = static_cast<double>(SampleQuantile(hits.heights_m, 0.98));
  if (IsHigh(storey, top_m, hits)) return true;
  if (hits.in_band < kMinHits) return false;
  double needed_m = kMinTopM;
  if (storey.has_ceiling) {
    needed_m = std::min(hits.ClearHeight() - kBelowCeilingM, kMaxNeededM);
  }
  if (hits.in_band_extent.length_m() < kNarrowM) needed_m = std::min(needed_m, kNarrowTopM);
  return bottom_m < kMaxBottomM && top_m > needed_m;
}

// Whether all that was seen of the surface lies on the face.
bool Continues(const WallFace& face, const WallCurve& curve, const SurfaceHits& hits) {
  if (face.curve.IsArc() != curve.IsArc()) return false;
  for (const double s : {hits.Wall().first_s, hits.Wall().last_s}) {
    const Eigen::Vector2d p = curve.At(s);
    if (std::abs(face.curve.SignedDistance(p)) > WallFace::kColumnM) return false;
    if (face.curve.NormalAt(p).dot(curve.NormalAt(p)) < kSameFaceCosine) return false;
  }
  return true;
}

// Gives the face empty columns over the box.
void AddColumns(const Eigen::AlignedBox2d& box, WallFace* face) {
  double first_s = std::numeric_limits<double>::max();
  double last_s = std::numeric_limits<double>::lowest();
  if (face->curve.IsArc()) {
    last_s = M_PI * face->curve.radius_m();
    first_s = -last_s;
  } else {
    for (const auto corner : {Eigen::AlignedBox2d::BottomLeft,
                              Eigen::AlignedBox2d::BottomRight,
                              Eigen::AlignedBox2d::TopLeft,
                              Eigen::AlignedBox2d::TopRight}) {
      const double s = face->curve.Parameter(box.corner(corner));
      first_s = std::min(first_s, s);
      last_s = std::max(last_s, s);
    }
  }
  face->start_m = first_s;
  const auto count =
      static_cast<size_t>(std::ceil((last_s - first_s) / WallFace::kColumnM)) + 1;
  face->columns.resize(count);
  face->hit_ends.resize(count);
  face->pass_ends.resize(count);
  face->plane_hits.resize(face->planes.size(), std::vector<uint32_t>(count, 0));
}

}  // namespace

StoreyHeights HeightsBefore(const WallCurve& curve,
                            const Eigen::Vector2d& p,
                            const StoreyLevel& storey) {
  if (storey.floors == nullptr) return storey;
  return storey.At(p + kBesideM * curve.NormalAt(p));
}

std::vector<WallFace> FindWallFaces(const std::vector<PlanePatch>& planes,
                                    const std::vector<CloudPoint>& points,
                                    const StoreyLevel& storey) {
  std::unordered_map<int, size_t> index_of_id;
  std::vector<WallCurve> curves(planes.size());
  for (size_t i = 0; i < planes.size(); ++i) {
    if (std::abs(planes[i].normal.z()) > kLevelCosine) continue;
    index_of_id[planes[i].id] = i;
    curves[i] = WallCurve(planes[i], storey.section_m());
  }
  std::vector<SurfaceHits> hits(planes.size());
  for (const CloudPoint& point : points) {
    const auto at = index_of_id.find(point.plane_id);
    if (at == index_of_id.end()) continue;
    const auto z = static_cast<double>(point.p_world.z());
    const Eigen::Vector2d p = point.p_world.head<2>().cast<double>();
    const StoreyHeights heights = HeightsBefore(curves[at->second], p, storey);
    if (z < heights.band_low_m() || z > std::max(heights.top_m, heights.band_high_m())) {
      continue;
    }
    SurfaceHits& of_plane = hits[at->second];
    of_plane.heights_m.push_back(static_cast<float>(z - heights.floor_m));
    of_plane.sum_clear_m += heights.top_m - heights.floor_m;
    const double s = curves[at->second].Parameter(p);
    of_plane.extent.Add(s);
    if (z > heights.band_high_m()) continue;
    ++of_plane.in_band;
    of_plane.in_band_extent.Add(s);
  }
  std::vector<size_t> order;
  Eigen::AlignedBox2d box;
  for (size_t i = 0; i < planes.size(); ++i) {
    if (!IsWall(storey, hits[i])) continue;
    order.push_back(i);
    const Extent& extent = hits[i].Wall();
    box.extend(curves[i].At(extent.first_s)).extend(curves[i].At(extent.last_s));
  }
  std::sort(order.begin(), order.end(), [&](size_t a, size_t b) {
    return hits[a].in_band != hits[b].in_band ? hits[a].in_band > hits[b].in_band : a < b;
  });
  std::vector<WallFace> faces;
  for (const size_t i : order) {
    const auto face = std::find_if(faces.begin(), faces.end(), [&](const WallFace& f) {
      return Continues(f, curves[i], hits[i]);
    });
    if (face != faces.end()) {
      face->planes.push_back(i);
    } else {
      WallFace& added = faces.emplace_back();
      added.curve = curves[i];
      added.planes = {i};
    }
  }
  if (faces.empty()) return faces;
  const Eigen::Vector2d margin(kLongWallM, kLongWallM);
  const Eigen::AlignedBox2d wide(box.min() - margin, box.max() + margin);
  for (WallFace& face : faces) AddColumns(wide, &face);
  return faces;
}

}  // namespace plumbline
