#include "core/visibility/beam_association.h"

#include <algorithm>
#include <cmath>

#include "core/map/landmark_view.h"
#include "core/map/patch_extent.h"
#include "core/visibility/beam_tests.h"

namespace plumbline {
namespace {

// A plane that lies so far in front of what a beam has measured has let the beam pass.
constexpr double kPassed = 0.5;  // m
// Patches reach so far beyond what segments have shown of them.
constexpr double kMargin = 0.02;  // m
// Beams on what lies behind a free edge make a patch larger by as much, and a little more.
constexpr double kEdge = 0.07;  // m

}  // namespace

bool BeamAssociation::IsSolidAt(const LandmarkView& plane,
                                const Eigen::Vector3d& p_world,
                                double margin_m) const {
  const Landmark& landmark = *plane.landmark;
  if (!landmark.extent.IsSeenAt(p_world, margin_m)) return false;
  // A floor's openings are where something stands on it: it hides what lies below all the
  // same.
  return !plane.is_vertical || !openings_[static_cast<size_t>(landmark.id)].IsAt(p_world);
}

bool BeamAssociation::EndsBefore(const LandmarkView& plane,
                                 const Eigen::Vector3d& p_world) const {
  bool ends = false;
  planes_.ForEachWithin(p_world, kSeenReach, [&](const LandmarkView& other) {
    if (ends || other.landmark == plane.landmark) return;
    const double cosine = other.normal.dot(plane.normal);
    if (std::abs(cosine) > kMaxCornerCosine) return;
    const double in_front = other.SignedDistance(p_world);
    if (in_front <= 0.0) return;
    if (!other.landmark->extent.IsNear(p_world, p_world, kSeenReach)) return;
    const Eigen::Vector3d outwards = (other.normal - cosine * plane.normal).normalized();
    ends = IsSolidAt(plane, p_world - (in_front + kEdge) * outwards, kMargin) &&
           !IsSolidAt(plane, p_world + kSeenReach * outwards, 0.0);
  });
  return ends;
}

bool BeamAssociation::IsSeenAt(const LandmarkView& plane, const Eigen::Vector2d& p) const {
  const Eigen::Vector3d p_world = placement_ * p.homogeneous();
  return IsSolidAt(plane, p_world, kMargin) && !EndsBefore(plane, p_world);
}

bool BeamAssociation::GoesOn(const LandmarkView& plane, int beam, int step) const {
  const Trace trace(placement_, plane);
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
  const double off_m = kStrictSigmas * scanner_.range_noise_m;
  const LandmarkView* first = nullptr;
  double nearest = measured + off_m;  // what lies farther is none of the beam's
  ranges_.ForEachBetween(
      direction, measured - kPassed, nearest, [&](const LandmarkView& plane, double range) {
        if (range >= nearest || !IsSeenAt(plane, range * direction)) return;
        nearest = range;
        first = &plane;
      });
  return nearest > measured - off_m ? first : nullptr;
}

// Towards the beams of a plane that stands in front of it, the plane falls back behind that
// other plane; towards those of a plane round an edge, it comes out before it.
bool BeamAssociation::IsMet(const LandmarkView& plane,
                            const LandmarkView* beyond,
                            int end,
                            int step) const {
  if (beyond == nullptr || beyond == &plane) return false;
  const Trace trace(placement_, plane);
  const Trace other(placement_, *beyond);
  const auto behind = [&](int beam) {
    const Eigen::Vector2d direction = scan_line_.BeamDirection(beam);
    return trace.RangeAlong(direction) - other.RangeAlong(direction);
  };
  const double at = behind(end + step);
  return std::abs(at) < kFarSigmas * scanner_.range_noise_m && at > behind(end);
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
    if (!IsMet(*plane, plane_of(first - 1), first, -1)) {
      while (first <= last && !GoesOn(*plane, first, -1)) ++first;
    }
    if (!IsMet(*plane, plane_of(last + 1), last, 1)) {
      while (last >= first && !GoesOn(*plane, last, 1)) --last;
    }
    if (first <= last) found.push_back({plane, Trace(placement_, *plane), first, last});
  }
  return found;
}

}  // namespace plumbline
