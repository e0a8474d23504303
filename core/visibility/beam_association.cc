#include "core/visibility/beam_association.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/association/surface_levels.h"
#include "core/geometry/angles.h"
#include "core/surface/landmark_view.h"
#include "core/surface/patch_extent.h"
#include "core/util/quantiles.h"
#include "core/visibility/beam_tests.h"

namespace plumbline {
namespace {

// A beam has passed a plane if its range exceeds that of the plane by this.
constexpr double kPassed = 0.5;  // m
// Distance by which patches reach beyond what segments have shown of them.
constexpr double kMargin = 0.02;  // m
// Surfaces that meet at less than this angle go over into each other.
const double kMinSmoothCosine = std::cos(10.0 * kRadiansPerDegree);
// Number of beams from which a run lies on its surface as a whole.
constexpr int kLongRun = 8;
// Width at an edge in which beams are left out: beams on what lies behind a free edge enlarge
// a patch by nearly this.
constexpr double kEdge = 0.07;  // m

}  // namespace

double BeamAssociation::RangeAlong(const LandmarkView& surface,
                                   const Eigen::Vector2d& direction) const {
  if (!surface.is_curved) return Trace(placement_, surface).RangeAlong(direction);
  return RangeOnCylinder(*surface.landmark, placement_, direction)
      .value_or(std::numeric_limits<double>::infinity());
}

Trace BeamAssociation::TraceAt(const LandmarkView& surface, int beam) const {
  const Eigen::Vector2d direction = scan_line_.BeamDirection(beam);
  const double range = std::min(RangeAlong(surface, direction), scanner_.max_range_m);
  std::optional<LandmarkView> near;
  return {placement_, surface.Near(placement_ * (range * direction).homogeneous(), &near)};
}

bool BeamAssociation::IsSolidAt(const LandmarkView& plane,
                                const Eigen::Vector3d& p_world,
                                double margin_m) const {
  const Landmark& landmark = *plane.landmark;
  if (!landmark.extent.IsSeenAt(p_world, margin_m)) return false;
  return !plane.traits.has_doorways ||
         !openings_[static_cast<size_t>(landmark.id)].IsAt(p_world);
}

bool BeamAssociation::EndsBefore(const LandmarkView& plane,
                                 const Eigen::Vector3d& p_world) const {
  bool ends = false;
  std::optional<LandmarkView> near;
  const Eigen::Vector3d& normal = plane.Near(p_world, &near).normal;
  const auto ends_at = [&](const LandmarkView& other, const Eigen::Vector3d& other_normal) {
    if (ends || other.landmark == plane.landmark) return;
    const double cosine = other_normal.dot(normal);
    if (std::abs(cosine) > kMaxCornerCosine) return;
    const double in_front = other.SignedDistance(p_world);
    if (in_front <= 0.0) return;
    if (!other.landmark->extent.IsNear(p_world, p_world, kSeenReach)) return;
    const Eigen::Vector3d outwards = (other_normal - cosine * normal).normalized();
    ends = IsSolidAt(plane, p_world - (in_front + kEdge) * outwards, kMargin) &&
           !IsSolidAt(plane, p_world + kSeenReach * outwards, 0.0);
  };
  planes_.ForEachWithin(
      p_world, kSeenReach, [&](const LandmarkView& other) { ends_at(other, other.normal); });
  for (const LandmarkView& other : planes_.cylinders()) {
    if (std::abs(other.SignedDistance(p_world)) > kSeenReach) continue;
    ends_at(other, other.landmark->NormalNear(p_world));
  }
  return ends;
}

bool BeamAssociation::IsSeenAt(const LandmarkView& plane, const Eigen::Vector2d& p) const {
  const Eigen::Vector3d p_world = placement_ * p.homogeneous();
  return IsSolidAt(plane, p_world, kMargin) && !EndsBefore(plane, p_world);
}

bool BeamAssociation::GoesOn(const LandmarkView& plane, int beam, int step) const {
  const Trace trace = TraceAt(plane, beam);
  const Eigen::Vector2d direction = scan_line_.BeamDirection(beam);
  const Eigen::Vector2d p = trace.RangeAlong(direction) * direction;
  // Beams that turn counter-clockwise go along it so, seen from the side that it faces.
  const double turn = step * scan_line_.angle_increment * trace.distance;
  const Eigen::Vector2d along(-trace.normal.y(), trace.normal.x());
  const Eigen::Vector2d outwards = std::copysign(1.0, turn) * along.normalized();
  const Eigen::Vector3d beyond = placement_ * (p + kEdge * outwards).homogeneous();
  return IsSolidAt(plane, beyond, kMargin) || EndsBefore(plane, beyond);
}

const LandmarkView* BeamAssociation::PlaneOf(int beam) const {
  if (beam < 0 || beam >= scan_line_.num_beams()) return nullptr;
  const double measured = scan_line_.ranges[static_cast<size_t>(beam)];
  if (!scanner_.IsValidRange(measured)) return nullptr;
  const Eigen::Vector2d direction = scan_line_.BeamDirection(beam);
  // The noise of beams that only their range puts on a plane has mean zero, if those are kept
  // that are near on both sides of it; few beams on something close behind are among them.
  const double off_m = (kind_ == Kind::kWholeLine ? kOutlierSigmas : kSignificantStddevs) *
                       scanner_.RangeStddev(measured);
  const LandmarkView* first = nullptr;
  double nearest = measured + off_m;  // what lies farther is none of the beam's
  ranges_.ForEachBetween(
      direction, measured - kPassed, nearest, [&](const LandmarkView& plane, double range) {
        if (range >= nearest || !IsSeenAt(plane, range * direction)) return;
        nearest = range;
        first = &plane;
      });
  if (first == nullptr || !(nearest > measured - off_m)) return nullptr;
  return GoesOverInto(*first, direction, nearest) ? nullptr : first;
}

bool BeamAssociation::GoesOverInto(const LandmarkView& surface,
                                   const Eigen::Vector2d& direction,
                                   double range) const {
  if (!planes_.HasSoftEdges()) return false;
  // Surfaces that are nearer to each other than this are the same to a beam.
  const double off_m = kSignificantStddevs * scanner_.RangeStddev(range);
  const Eigen::Vector3d normal =
      surface.landmark->NormalNear(placement_ * (range * direction).homogeneous());
  const bool is_soft = surface.traits.has_soft_edges;
  bool goes_over = false;
  ranges_.ForEachBetween(
      direction, range - off_m, range + off_m, [&](const LandmarkView& other, double at) {
        if (other.landmark == surface.landmark) return;
        if (!is_soft && !other.traits.has_soft_edges) return;
        const Eigen::Vector2d p = at * direction;
        const double cosine =
            normal.dot(other.landmark->NormalNear(placement_ * p.homogeneous()));
        goes_over = goes_over || (cosine > kMinSmoothCosine && IsSeenAt(other, p));
      });
  return goes_over;
}

// Towards the beams of a plane that stands in front of it, the plane falls back behind that
// other plane; towards those of a plane round an edge, it comes out before it.
bool BeamAssociation::IsMet(const LandmarkView& plane,
                            const LandmarkView* beyond,
                            int end,
                            int step) const {
  if (beyond == nullptr || beyond == &plane) return false;
  const auto behind = [&](int beam) {
    const Eigen::Vector2d direction = scan_line_.BeamDirection(beam);
    return RangeAlong(plane, direction) - RangeAlong(*beyond, direction);
  };
  const double at = behind(end + step);
  const double noise_m =
      scanner_.RangeStddev(RangeAlong(plane, scan_line_.BeamDirection(end + step)));
  return std::abs(at) < kFarSigmas * noise_m && at > behind(end);
}

std::vector<BeamAssociation::PlaneBeams> BeamAssociation::Associate(int first_beam,
                                                                    int last_beam) const {
  std::vector<const LandmarkView*> planes;
  planes.reserve(static_cast<size_t>(std::max(0, last_beam - first_beam + 1)));
  for (int beam = first_beam; beam <= last_beam; ++beam) planes.push_back(PlaneOf(beam));
  const auto plane_of = [&](int beam) {
    const bool is_within = beam >= first_beam && beam <= last_beam;
    return is_within ? planes[static_cast<size_t>(beam - first_beam)] : PlaneOf(beam);
  };
  std::vector<PlaneBeams> found;
  for (int beam = first_beam; beam <= last_beam;) {
    const LandmarkView* plane = plane_of(beam);
    int first = beam;
    int last = beam;
    while (last < last_beam && plane_of(last + 1) == plane) ++last;
    beam = last + 1;
    if (plane == nullptr) continue;
    const bool is_first_met = IsMet(*plane, plane_of(first - 1), first, -1);
    const bool is_last_met = IsMet(*plane, plane_of(last + 1), last, 1);
    const bool is_sure = kind_ == Kind::kWholeLine && last - first + 1 >= kLongRun;
    if (!is_sure && !is_first_met) {
      while (first <= last && !GoesOn(*plane, first, -1)) ++first;
    }
    if (!is_sure && !is_last_met) {
      while (last >= first && !GoesOn(*plane, last, 1)) --last;
    }
    if (first > last) continue;
    found.push_back({plane, TraceAt(*plane, first), first, last, is_first_met, is_last_met});
  }
  return found;
}

}  // namespace plumbline
