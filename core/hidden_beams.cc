#include "core/hidden_beams.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/time.h"

namespace plumbline {
namespace {

// At less than this between beam and normal, the pose does not tell where on the plane the
// beam lies: 1 mm across it is 20 mm along the beam.
constexpr double kMinCosine = 0.05;
// How near the walls' seen parts have to come to what they hide: one cell of their grids.
constexpr double kReach = 0.25;  // m
// Walls whose normals are nearer to each other form no corner.
constexpr double kMaxCosine = 0.7;

// A wall that a segment crosses, at this share of its length.
struct WallCrossing {
  const LandmarkCandidate* wall;
  double at;
};

// Beams on both sides of an end that may tell of an opening.
constexpr int kNumBeams = 8;
constexpr double kOutlierSigmas = 5.0;  // of a range, beyond which a beam is not on the plane
// A beam that went through a plane ended so far behind it.
constexpr double kMinPassageDepth = 0.05;  // m

}  // namespace

PlaneTrace HiddenBeams::MakeTrace() const {
  std::array<Rigid3d, 3> world_from_scanner;
  for (size_t k = 0; k < 3; ++k) {
    world_from_scanner[k] = poses.world_from_body[k] * scanner.body_from_scanner;
  }
  return {poses.times_ns, world_from_scanner, plane.normal, plane.distance};
}

std::optional<Eigen::Vector3d> HiddenBeams::MeetingPoint(
    const PlaneTrace& trace, int beam, const Eigen::Vector2d& direction) const {
  const int64_t time_ns =
      scan_line.BeamTime(beam) + NanosecondsFromSeconds(scanner.time_offset_s);
  const Eigen::Vector3d line = trace.At(time_ns);
  const double cosine = line.head<2>().dot(direction);
  if (std::abs(cosine) < kMinCosine) return std::nullopt;
  return poses.ToWorld(scanner.body_from_scanner, line.z() / cosine * direction, time_ns);
}

std::vector<int> HiddenBeams::InOpenings(const OpeningMap& openings) const {
  std::vector<int> beams;
  if (!openings.HasOpenings(*plane.landmark)) return beams;
  const PlaneTrace trace = MakeTrace();
  const auto is_open = [&](int beam) {
    const auto at = MeetingPoint(trace, beam, scan_line.BeamDirection(beam));
    return at && openings.IsOpening(*plane.landmark, *at);
  };
  if (!OpeningMap::HasHeight(*plane.landmark)) {  // at the ends only
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
  BeamSweep sweep(scan_line, first_beam);
  for (int beam = first_beam; beam <= last_beam; ++beam, sweep.Next()) {
    const std::optional<Eigen::Vector3d> at = MeetingPoint(trace, beam, sweep.direction());
    if (!at || openings.IsOpening(*plane.landmark, *at)) beams.push_back(beam);
  }
  return beams;
}

std::vector<int> HiddenBeams::BehindCorners(
    const std::vector<LandmarkCandidate>& others) const {
  std::vector<int> beams;
  if (plane.landmark->model != PlaneModel::kHorizontal) return beams;
  const PlaneTrace trace = MakeTrace();
  const std::optional<Eigen::Vector3d> start =
      MeetingPoint(trace, first_beam, scan_line.BeamDirection(first_beam));
  const std::optional<Eigen::Vector3d> end =
      MeetingPoint(trace, last_beam, scan_line.BeamDirection(last_beam));
  if (!start || !end) return beams;
  const auto point_at = [&](double share) -> Eigen::Vector3d {
    return *start + share * (*end - *start);
  };
  std::vector<WallCrossing> leaving;   // goes behind the wall
  std::vector<WallCrossing> entering;  // comes from behind it
  for (const LandmarkCandidate& other : others) {
    if (other.landmark->model != PlaneModel::kVertical) continue;
    const double from = other.normal.dot(*start) - other.distance;
    const double to = other.normal.dot(*end) - other.distance;
    if (from * to >= 0.0) continue;
    (from > 0.0 ? leaving : entering).push_back({&other, from / (from - to)});
  }
  const Rigid3d scanner_from_world = (poses.middle() * scanner.body_from_scanner).Inverse();
  const auto beam_at = [&](double share) {
    const Eigen::Vector3d p = scanner_from_world * point_at(share);
    const double turn = std::atan2(p.y(), p.x()) - scan_line.BeamAngle(first_beam);
    return first_beam + std::remainder(turn, 2.0 * M_PI) / scan_line.angle_increment;
  };
  for (const WallCrossing& first : leaving) {
    for (const WallCrossing& second : entering) {
      if (first.at >= second.at) continue;
      if (std::abs(first.wall->normal.dot(second.wall->normal)) > kMaxCosine) continue;
      const Eigen::Vector3d middle = point_at(0.5 * (first.at + second.at));
      const auto is_near = [&](const WallCrossing& crossing) {
        return crossing.wall->landmark->extent.IsNear(middle, middle, kReach);
      };
      if (!is_near(first) || !is_near(second)) continue;
      // One beam more on both sides, for the motion within the scan line.
      const auto [low, high] = std::minmax({beam_at(first.at), beam_at(second.at)});
      const int from = std::max(first_beam, static_cast<int>(std::ceil(low)) - 1);
      const int to = std::min(last_beam, static_cast<int>(std::floor(high)) + 1);
      for (int beam = from; beam <= to; ++beam) beams.push_back(beam);
    }
  }
  return beams;
}

void CountOpenings(const SegmentEnd& end, OpeningMap* openings) {
  const auto meeting_point = [&](int beam) -> std::optional<Eigen::Vector3d> {
    const Eigen::Vector2d direction = end.scan_line.BeamDirection(beam);
    const double range = end.trace.RangeAlong(direction);
    if (!end.scanner.IsValidRange(range)) return std::nullopt;
    return end.world_from_scanner *
           Eigen::Vector3d(range * direction.x(), range * direction.y(), 0.0);
  };
  const double margin_m = kOutlierSigmas * end.scanner.range_noise_m;
  for (int k = 1; k <= kNumBeams; ++k) {
    const int beam = end.beam + k * end.step;
    if (beam < 0 || beam >= end.scan_line.num_beams()) break;
    const std::optional<Eigen::Vector3d> at = meeting_point(beam);
    const double range = end.scan_line.ranges[static_cast<size_t>(beam)];
    if (!at || !end.scanner.IsValidRange(range)) continue;
    const Eigen::Vector2d direction = end.scan_line.BeamDirection(beam);
    const double beyond_m = range - end.trace.RangeAlong(direction);
    // At grazing incidence the pose's uncertainty moves the range by decimetres.
    const double behind_m = beyond_m * std::abs(end.trace.normal.dot(direction));
    if (beyond_m > margin_m && behind_m > kMinPassageDepth) {
      openings->CountPassage(end.landmark, *at);
    }
    if (end.landmark.model == PlaneModel::kHorizontal && beyond_m < -margin_m) {
      openings->CountBlock(end.landmark, *at);
    }
  }
  for (int k = 0; k < kNumBeams && end.step * (end.beam - end.middle) > k; ++k) {
    const std::optional<Eigen::Vector3d> at = meeting_point(end.beam - k * end.step);
    if (!at) break;
    openings->CountHit(end.landmark, *at);
  }
}

}  // namespace plumbline
