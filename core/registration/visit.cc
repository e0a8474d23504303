#include "core/registration/visit.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "core/geometry/rigid3.h"
#include "core/registration/visit_grid.h"
#include "core/sensor/scan_line.h"
#include "core/util/time.h"

namespace plumbline {
namespace {

constexpr double kMaxRange = 15.0;  // m
// Scan lines of one scanner are taken at so different poses.
constexpr double kMinWay = 0.15;  // m
constexpr double kMinTurn = 0.1;  // rad
// A beam is no stray if it ends within this distance of the one before it.
constexpr double kMaxStep = 0.5;  // m

constexpr double kLength =
    8.0;  // m of the way, of a visit; the next one begins at its quarter

// The ends of a scan line's beams from above, each with its own pose.
PlacedScan Place(const Scanner& scanner, const ScanLine& line, PoseSampler* poses) {
  PlacedScan placed;
  Eigen::Vector2d previous = Eigen::Vector2d::Constant(1e9);
  const int64_t offset_ns = NanosecondsFromSeconds(scanner.time_offset_s);
  for (int beam = 0; beam < line.num_beams(); ++beam) {
    const double range_m = line.ranges[static_cast<size_t>(beam)];
    if (!scanner.IsValidRange(range_m) || range_m > kMaxRange) continue;
    const Eigen::Vector2d end = range_m * line.BeamDirection(beam);
    const int64_t time_ns = line.BeamTime(beam) + offset_ns;
    const Rigid3d world_from_scanner =
        poses->WorldFromBody(time_ns) * scanner.BodyFromScanner(time_ns);
    const Eigen::Vector3d end_world =
        world_from_scanner * Eigen::Vector3d(end.x(), end.y(), 0.0);
    const bool follows = (end_world.head<2>() - previous).norm() < kMaxStep;
    previous = end_world.head<2>();
    if (follows) placed.ends.push_back(previous);
  }
  return placed;
}

}  // namespace

std::vector<PlacedScan> PlaceScans(const Rig& rig,
                                   const Trajectory& trajectory,
                                   RecordingReader* recording) {
  std::vector<PlacedScan> scans;
  std::vector<PlanarPose> last(rig.scanners.size());
  std::vector<bool> has_last(rig.scanners.size(), false);
  PoseSampler poses(trajectory);
  Eigen::Vector2d previous = Eigen::Vector2d::Zero();
  bool has_previous = false;
  double way_m = 0.0;
  ScanLine line;
  recording->Rewind();
  while (recording->Next(&line)) {
    const auto index = static_cast<size_t>(line.scanner_index);
    const Scanner& scanner = rig.scanners[index];
    const int64_t offset_ns = NanosecondsFromSeconds(scanner.time_offset_s);
    const int64_t begin_ns = line.BeamTime(0) + offset_ns;
    const int64_t end_ns = line.BeamTime(line.num_beams() - 1) + offset_ns;
    if (begin_ns < trajectory.start_ns() || end_ns >= trajectory.end_ns()) continue;
    const PlanarPose pose = FromAbove(poses.WorldFromBody(begin_ns));
    if (has_previous) way_m += (pose.position - previous).norm();
    previous = pose.position;
    has_previous = true;
    if (has_last[index] && (pose.position - last[index].position).norm() < kMinWay &&
        std::abs(std::remainder(pose.heading - last[index].heading, 2.0 * M_PI)) < kMinTurn) {
      continue;
    }
    last[index] = pose;
    has_last[index] = true;
    PlacedScan placed = Place(scanner, line, &poses);
    placed.time_ns = begin_ns;
    placed.way_m = way_m;
    placed.scanner = (poses.WorldFromBody(begin_ns) * scanner.BodyFromScanner(begin_ns))
                         .translation.head<2>();
    scans.push_back(std::move(placed));
  }
  return scans;
}

namespace {

// Takes what the scans of a visit saw into it.
void Fill(const std::vector<PlacedScan>& scans, Visit* visit) {
  const PlanarPose visit_from_world = visit->world_from_visit.Inverse();
  auto scan = std::lower_bound(
      scans.begin(),
      scans.end(),
      visit->way_m - 0.5 * kLength,
      [](const PlacedScan& placed, double way_m) { return placed.way_m < way_m; });
  std::set<std::pair<int, int>> taken;
  for (; scan != scans.end() && scan->way_m <= visit->way_m + 0.5 * kLength; ++scan) {
    const Eigen::Vector2d scanner = visit_from_world * scan->scanner;
    for (const Eigen::Vector2d& end_world : scan->ends) {
      const Eigen::Vector2d end = visit_from_world * end_world;
      const Eigen::Vector2i cell = (end / VisitGrid::kCell).array().floor().cast<int>();
      if (!taken.insert({cell.x(), cell.y()}).second) continue;
      visit->points.push_back(end);
      visit->scanners.push_back(scanner);
    }
  }
}

}  // namespace

std::vector<Visit> CutIntoVisits(const std::vector<PlacedScan>& scans,
                                 const Trajectory& trajectory) {
  std::vector<Visit> visits;
  for (const PlacedScan& scan : scans) {
    if (!visits.empty() && scan.way_m < visits.back().way_m + 0.25 * kLength) continue;
    Visit& visit = visits.emplace_back();
    visit.time_ns = scan.time_ns;
    visit.way_m = scan.way_m;
    visit.world_from_visit = FromAbove(trajectory.WorldFromBody(scan.time_ns));
  }
  for (Visit& visit : visits) Fill(scans, &visit);
  return visits;
}

}  // namespace plumbline
