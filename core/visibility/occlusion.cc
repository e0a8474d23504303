#include "core/visibility/occlusion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/association/surface_levels.h"
#include "core/surface/landmark_view.h"
#include "core/surface/patch_extent.h"
#include "core/util/time.h"
#include "core/visibility/beam_tests.h"

namespace plumbline {
namespace {

// Where the cosine between beam and normal is smaller than this, the pose does not determine
// the cell of openings in which the beam lies: 1 mm across the plane is 20 mm along the beam.
constexpr double kMinCosine = 0.05;
// A cosine above the first one for sure, with the plane's turn as the scanner moves left out.
constexpr double kSafeCosine = 0.06;
// Number of beams beside a segment's end, on both sides, that are tested for passing through
// the plane. Beams beyond them count for as long as they pass: at a grazing angle those on the
// far jamb meet the plane decimetres before it.
constexpr int kNumBeams = 8;
// Number of a segment's beams that are counted as hits, each for its share of all of them.
constexpr int kNumHits = 8;

// The point in the world where a beam meets the plane at a segment's end, p in the scanner's
// frame; nothing where that is out of range.
std::optional<Eigen::Vector3d> IntersectionPoint(const SegmentEnd& end,
                                                 const Eigen::Vector2d& p) {
  if (!end.scanner.IsValidRange(p.norm())) return std::nullopt;
  return end.placement * p.homogeneous();
}

}  // namespace

Occlusion::PlaneView Occlusion::MakePlaneView() const {
  return {poses.motion.TraceOf(plane.normal, plane.distance), poses.motion};
}

int64_t Occlusion::BeamInstantNs(int beam) const {
  return scan_line.BeamTime(beam) + NanosecondsFromSeconds(scanner.time_offset_s);
}

std::optional<Eigen::Vector3d> Occlusion::IntersectionPoint(const PlaneView& view,
                                                            int beam,
                                                            const Eigen::Vector2d& direction,
                                                            double min_cosine) const {
  const int64_t time_ns = BeamInstantNs(beam);
  const Eigen::Vector3d line = view.trace.At(time_ns);
  const double cosine = line.head<2>().dot(direction);
  if (std::abs(cosine) < min_cosine) return std::nullopt;
  return view.motion.ToWorld(line.z() / cosine * direction, time_ns);
}

std::optional<Eigen::Vector3d> Occlusion::SafeIntersectionPoint(const PlaneView& view,
                                                                int beam) const {
  return IntersectionPoint(view, beam, scan_line.BeamDirection(beam), kSafeCosine);
}

std::vector<int> Occlusion::InOpenings(const PlaneOpenings& openings) const {
  std::vector<int> beams;
  if (openings.none()) return beams;
  const PlaneView view = MakePlaneView();
  const auto is_open = [&](int beam) {
    const auto at = IntersectionPoint(view, beam, scan_line.BeamDirection(beam), kMinCosine);
    return at && openings.IsAt(*at);
  };
  if (!openings.has_height()) {  // at the ends only
    int first = first_beam;
    while (first <= last_beam && first < first_beam + kNumBeams && is_open(first)) {
      beams.push_back(first++);
    }
    for (int last = last_beam; last > first && last > last_beam - kNumBeams && is_open(last);
         --last) {
      beams.push_back(last);
    }
    return beams;
  }
  AddOpen(view,
          openings,
          {first_beam,
           last_beam,
           SafeIntersectionPoint(view, first_beam),
           SafeIntersectionPoint(view, last_beam)},
          &beams);
  return beams;
}

// Most segments pass no opening, and of the others most beams do not: between two ends that
// meet the plane steeply enough, without an opening in between, no beam is in one.
void Occlusion::AddOpen(const PlaneView& view,
                        const PlaneOpenings& openings,
                        const BeamSpan& span,
                        std::vector<int>* beams) const {
  if (span.start && span.end && !openings.MayBeAlong(*span.start, *span.end)) {
    return;
  }
  if (span.last - span.first >= kBeamsPerPlacement) {
    const int middle = (span.first + span.last) / 2;
    AddOpen(view,
            openings,
            {span.first, middle, span.start, SafeIntersectionPoint(view, middle)},
            beams);
    AddOpen(view,
            openings,
            {middle + 1, span.last, SafeIntersectionPoint(view, middle + 1), span.end},
            beams);
    return;
  }
  // The scanner's motion is even over these few beams.
  const int64_t start_ns = BeamInstantNs(span.first);
  const int64_t end_ns = BeamInstantNs(span.last);
  const double share = 1.0 / std::max(1, span.last - span.first);
  Eigen::Vector3d line = view.trace.At(start_ns);
  const Eigen::Vector3d line_step = share * (view.trace.At(end_ns) - line);
  Eigen::Matrix<double, 2, 3> on_axes = openings.OnAxes(view.motion.At(start_ns));
  const Eigen::Matrix<double, 2, 3> on_axes_step =
      share * (openings.OnAxes(view.motion.At(end_ns)) - on_axes);
  for (int beam = span.first; beam <= span.last; ++beam) {
    const Eigen::Vector2d direction = scan_line.BeamDirection(beam);
    const double cosine = line.head<2>().dot(direction);
    const bool is_open =
        std::abs(cosine) < kMinCosine
            ? IsNearOpening(view, beam, direction, openings)
            : openings.IsAtLocal(on_axes * (line.z() / cosine * direction).homogeneous());
    if (is_open) beams->push_back(beam);
    line += line_step;
    on_axes += on_axes_step;
  }
}

bool Occlusion::IsNearOpening(const PlaneView& view,
                              int beam,
                              const Eigen::Vector2d& direction,
                              const PlaneOpenings& openings) const {
  // Down to this cosine the pose determines it to the length of a cell; farther from an
  // opening than that, such a beam may count.
  const std::optional<Eigen::Vector3d> at =
      IntersectionPoint(view, beam, direction, kMinCosine * kOpeningCell / kSeenReach);
  if (!at) return true;
  const Eigen::Vector3d from =
      view.motion.ToWorld(Eigen::Vector2d::Zero(), BeamInstantNs(beam));
  const Eigen::Vector3d reach = kSeenReach * (*at - from).normalized();
  return openings.MayBeAlong(*at - reach, *at + reach);
}

Occlusion::WallCrossings Occlusion::FindCrossings(
    const std::vector<LandmarkView>& others) const {
  WallCrossings crossings;
  if (!plane.traits.goes_on_behind_walls) return crossings;
  const PlaneView view = MakePlaneView();
  const std::optional<Eigen::Vector3d> start =
      IntersectionPoint(view, first_beam, scan_line.BeamDirection(first_beam), kMinCosine);
  const std::optional<Eigen::Vector3d> end =
      IntersectionPoint(view, last_beam, scan_line.BeamDirection(last_beam), kMinCosine);
  if (!start || !end) return crossings;
  crossings.start = *start;
  crossings.end = *end;
  for (const LandmarkView& other : others) {
    if (!other.traits.bounds_floors) continue;
    const double from = other.SignedDistance(*start);
    const double to = other.SignedDistance(*end);
    if (from * to >= 0.0) continue;
    auto& of_kind = from > 0.0 ? crossings.leaving : crossings.entering;
    of_kind.push_back({&other, from / (from - to)});
  }
  return crossings;
}

double Occlusion::BeamAt(const WallCrossings& crossings, double share) const {
  const Rigid3d scanner_from_world = poses.world_from_scanner.Inverse();
  const Eigen::Vector3d p = scanner_from_world * crossings.PointAt(share);
  return first_beam + scan_line.BeamsTo(std::atan2(p.y(), p.x()), first_beam);
}

std::vector<int> Occlusion::BehindCorners(const std::vector<LandmarkView>& others) const {
  std::vector<int> beams;
  const WallCrossings crossings = FindCrossings(others);
  for (const WallCrossing& first : crossings.leaving) {
    for (const WallCrossing& second : crossings.entering) {
      if (first.at >= second.at) continue;
      if (std::abs(first.wall->normal.dot(second.wall->normal)) > kMaxCornerCosine) continue;
      const Eigen::Vector3d middle = crossings.PointAt(0.5 * (first.at + second.at));
      const auto is_near = [&](const WallCrossing& crossing) {
        return crossing.wall->landmark->extent.IsNear(middle, middle, kSeenReach);
      };
      if (!is_near(first) || !is_near(second)) continue;
      // One beam more on both sides, for the motion within the scan line.
      const auto [low, high] =
          std::minmax({BeamAt(crossings, first.at), BeamAt(crossings, second.at)});
      const int from = std::max(first_beam, static_cast<int>(std::ceil(low)) - 1);
      const int to = std::min(last_beam, static_cast<int>(std::floor(high)) + 1);
      for (int beam = from; beam <= to; ++beam) beams.push_back(beam);
    }
  }
  return beams;
}

std::vector<int> Occlusion::BehindWalls(const std::vector<LandmarkView>& others) const {
  std::vector<int> beams;
  const WallCrossings crossings = FindCrossings(others);
  const auto is_hidden = [&](const PlaneView& view, int beam, const LandmarkView& wall) {
    const auto at = IntersectionPoint(view, beam, scan_line.BeamDirection(beam), kMinCosine);
    return at && wall.SignedDistance(*at) > -kSeenReach &&
           wall.landmark->extent.IsNear(*at, *at, kSeenReach);
  };
  // Goes from the crossing on, to the side of it that lies behind the wall.
  const auto add = [&](const WallCrossing& crossing, int step) {
    int beam = static_cast<int>(std::lround(BeamAt(crossings, crossing.at)));
    const PlaneView view = MakePlaneView();
    for (; beam >= first_beam && beam <= last_beam && is_hidden(view, beam, *crossing.wall);
         beam += step) {
      beams.push_back(beam);
    }
  };
  for (const WallCrossing& crossing : crossings.leaving) add(crossing, 1);
  for (const WallCrossing& crossing : crossings.entering) add(crossing, -1);
  return beams;
}

void Occlusion::CountHits(OccupancyGrids* grids) const {
  const PlaneView view = MakePlaneView();
  const int stride = std::max(1, (last_beam - first_beam) / kNumHits);
  for (int beam = first_beam + kNumBeams % stride; beam <= last_beam; beam += stride) {
    const Eigen::Vector2d direction = scan_line.BeamDirection(beam);
    const int64_t time_ns = BeamInstantNs(beam);
    const Eigen::Vector3d line = view.trace.At(time_ns);
    const double cosine = line.head<2>().dot(direction);
    if (std::abs(cosine) < kMinCosine) continue;
    const double on_plane_m = line.z() / cosine;
    const double beyond_m = scan_line.ranges[static_cast<size_t>(beam)] - on_plane_m;
    const double stddev_m = scanner.RangeStddev(on_plane_m);
    if (!(std::abs(beyond_m) < kOutlierSigmas * stddev_m)) continue;
    const Eigen::Vector3d at_world = view.motion.ToWorld(on_plane_m * direction, time_ns);
    grids->CountDeviation(
        *plane.landmark, at_world, cosine * beyond_m, std::abs(cosine) * stddev_m);
    const bool is_at_end = beam < first_beam + kNumBeams || beam > last_beam - kNumBeams;
    if (!is_at_end) grids->CountHit(*plane.landmark, at_world, stride);
  }
}

void CountHitsAtEnd(const SegmentEnd& end, OccupancyGrids* grids) {
  for (int k = 0; k < kNumBeams && end.step * (end.beam - end.middle) > k; ++k) {
    const Eigen::Vector2d direction = end.scan_line.BeamDirection(end.beam - k * end.step);
    const std::optional<Eigen::Vector3d> at =
        IntersectionPoint(end, end.trace.RangeAlong(direction) * direction);
    if (!at) break;
    grids->CountHit(end.landmark, *at);
  }
}

void CountPassages(const SegmentEnd& end, OccupancyGrids* grids) {
  const PatchExtent& extent = end.landmark.extent;
  bool is_opening = false;
  Eigen::Vector3d last = Eigen::Vector3d::Zero();  // passage that counted, and its k
  int last_k = 0;
  for (int k = 1;; ++k) {
    const bool is_close = k <= kNumBeams;
    if (!is_close && !is_opening) break;
    const int beam = end.beam + k * end.step;
    if (beam < 0 || beam >= end.scan_line.num_beams()) break;
    const double range = end.scan_line.ranges[static_cast<size_t>(beam)];
    if (!end.scanner.IsValidRange(range)) continue;
    const Eigen::Vector2d direction = end.scan_line.BeamDirection(beam);
    const double on_plane_m = end.trace.RangeAlong(direction);
    const double beyond_m = range - on_plane_m;
    // At grazing incidence the pose's uncertainty moves the range by decimetres.
    const double behind_m = beyond_m * std::abs(end.trace.normal.dot(direction));
    const double margin_m = kOutlierSigmas * end.scanner.RangeStddev(on_plane_m);
    const bool passes = beyond_m > margin_m && behind_m > kMinDepth;
    if (!is_close && !passes) break;
    if (!passes) continue;
    const std::optional<Eigen::Vector3d> at = IntersectionPoint(end, on_plane_m * direction);
    if (!at) continue;
    is_opening = true;
    if (!is_close) {
      if (!extent.Contains(extent.Project(*at), 0.0)) break;
      if ((*at - last).norm() < 0.5 * kOpeningCell) continue;
    }
    grids->CountPassage(end.landmark, *at, is_close ? 1 : k - last_k);
    last = *at;
    last_k = k;
  }
}

}  // namespace plumbline
