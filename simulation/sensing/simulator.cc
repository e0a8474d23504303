#include "simulation/sensing/simulator.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <sstream>
#include <tuple>

#include "core/util/error.h"
#include "core/util/time.h"
#include "simulation/world/random.h"

namespace plumbline {
namespace {

// Keeps the chances of glass apart from the noise's.
constexpr uint64_t kGlassKey = 0x676c6173;
constexpr double kCheckStep = 0.02;  // m along the path; a fifth of the clearance

// LaserScan messages hold angles and time increments in single precision: take the beams
// exactly where the recording will say they were. Not inlined, because GCC 12 drops the
// rounding when it vectorises several of these conversions (-O3).
[[gnu::noinline]] double AsRecorded(double value) { return static_cast<float>(value); }

// Geometry and timing of a scanner's lines: beams in the middle of equal shares of the field
// of view, which the mirror passes in the same share of its period. The row of a depth camera
// is taken at once.
ScanLine MakeHeader(const Scanner& scanner, const Rig& rig) {
  ScanLine header;
  if (scanner.camera_row) {
    const auto& [camera, row] = *scanner.camera_row;
    const std::vector<float> angles = RowAngles(rig.depth_cameras[camera].model, row);
    header.angle_min = angles.front();
    header.angle_increment =
        (angles.back() - angles.front()) / static_cast<double>(angles.size() - 1);
    header.angles = std::make_shared<const std::vector<double>>(angles.begin(), angles.end());
    return header;
  }
  const double field_of_view = scanner.field_of_view_deg * M_PI / 180.0;
  const double increment = field_of_view / scanner.beams;
  header.angle_min = AsRecorded(-field_of_view / 2 + increment / 2);
  header.angle_increment = AsRecorded(increment);
  header.time_increment_s = AsRecorded(increment / (2 * M_PI) / scanner.scan_rate_hz);
  return header;
}

}  // namespace

ScanLine AddNoise(const PerfectScanLine& perfect,
                  const Scanner& scanner,
                  const NoiseOptions& noise,
                  uint64_t seed) {
  ScanLine scan_line = perfect.scan_line;
  Random random({seed,
                 static_cast<uint64_t>(scan_line.scanner_index),
                 static_cast<uint64_t>(perfect.line_index)});
  scan_line.ranges.reserve(perfect.beams.size());
  for (const std::optional<RayHit>& hit : perfect.beams) {
    // Drawn for every beam, so that no setting changes the others' noise.
    const double stddev_m = hit ? scanner.RangeStddev(hit->range) : scanner.range_noise_m;
    const double error = noise.scale * stddev_m * random.Gaussian();
    const bool lost = random.Uniform() < noise.dropout;
    float range = std::numeric_limits<float>::infinity();
    if (hit && !lost) {
      const float measured = static_cast<float>(hit->range + error);
      if (scanner.IsValidRange(measured)) range = measured;
    }
    scan_line.ranges.push_back(range);
  }
  return scan_line;
}

Simulator::Simulator(const Experiment& experiment, uint64_t seed)
    : rig_(TrueRig(experiment.rig, experiment.faults)),
      scanner_phases_s_(experiment.scanner_phases_s),
      path_(experiment.path),
      building_is_closed_(experiment.building.is_closed),
      ray_caster_(experiment.building),
      moving_things_(experiment.moving, seed),
      faults_(experiment.faults),
      unevenness_(experiment.faults.surfaces, experiment.building, seed),
      seed_(seed) {
  faults_.scanners.resize(rig_.scanners.size());
  MakeSchedule();
  if (!schedule_.empty()) {
    mounts_ = SimulateMounts(
        experiment.mounts, first_line_ns(), path_.start_ns(), path_.end_ns(), seed, &rig_);
  }
  CheckPath();
  if (schedule_.empty()) {
    throw Error(experiment.path.location + ": the path is too short for a single scan line");
  }
}

void Simulator::CheckPath() const {
  // Nothing that moves on for a step of less than the clearance passes through a wall unseen.
  double last_checked_m = -kCheckStep;
  for (int64_t time_ns = path_.start_ns(); time_ns <= path_.end_ns(); time_ns += 1000000) {
    const double travelled_m = path_.TravelledAt(time_ns);
    if (travelled_m - last_checked_m < kCheckStep) continue;
    last_checked_m = travelled_m;
    const Rigid3d world_from_body = path_.PoseAt(time_ns);
    std::vector<Eigen::Vector3d> origins = {world_from_body.translation};
    for (const Scanner& scanner : rig_.scanners) {
      origins.push_back(world_from_body * scanner.BodyFromScanner(time_ns).translation);
    }
    for (const Eigen::Vector3d& p : origins) CheckPlace(p, time_ns);
  }
}

void Simulator::CheckPlace(const Eigen::Vector3d& p, int64_t time_ns) const {
  const bool is_free = building_is_closed_
                           ? ray_caster_.IsInFreeSpace(p)
                           : ray_caster_.Cast(p, -Eigen::Vector3d::UnitZ()).has_value();
  if (is_free && ray_caster_.Clearance(p) >= kMinClearance) return;
  std::ostringstream message;
  message << path_.LocationAt(time_ns)
          << (path_.is_walk() ? ": the path " : ": after this way point the path ")
          << (is_free               ? "comes too close to a wall, floor or ceiling"
              : building_is_closed_ ? "leaves the building or goes into a wall"
                                    : "has no floor below")
          << " at (" << p.x() << ", " << p.y();
  if (path_.is_walk()) {
    message << ", " << p.z() << "), " << path_.TravelledAt(time_ns) << " m from its begin";
  } else {
    message << ")";
  }
  throw Error(message.str());
}

void Simulator::MakeSchedule() {
  for (size_t i = 0; i < rig_.scanners.size(); ++i) {
    const Scanner& scanner = rig_.scanners[i];
    const double period_s = 1.0 / scanner.scan_rate_hz;
    const int64_t offset_ns = NanosecondsFromSeconds(scanner.time_offset_s);
    for (int line = 0;; ++line) {
      const int64_t stamp_ns =
          path_.start_ns() + NanosecondsFromSeconds(scanner_phases_s_[i] + line * period_s);
      // A scan line is taken whole or not at all.
      const int64_t end_ns = stamp_ns + NanosecondsFromSeconds(period_s);
      if (std::max(end_ns, end_ns + offset_ns) > path_.end_ns()) break;
      if (stamp_ns + offset_ns < path_.start_ns()) continue;
      schedule_.push_back({stamp_ns, static_cast<int>(i), line});
    }
  }
  std::sort(schedule_.begin(), schedule_.end(), [](const auto& a, const auto& b) {
    return std::tie(a.stamp_ns, a.scanner_index) < std::tie(b.stamp_ns, b.scanner_index);
  });
}

PerfectScanLine Simulator::Take(const ScheduledLine& scheduled) const {
  const Scanner& scanner = rig_.scanners[static_cast<size_t>(scheduled.scanner_index)];
  PerfectScanLine line;
  line.scan_line = MakeHeader(scanner, rig_);
  line.scan_line.scanner_index = scheduled.scanner_index;
  line.scan_line.stamp_ns = scheduled.stamp_ns;
  line.line_index = scheduled.line_index;
  line.beams.reserve(static_cast<size_t>(scanner.beams));
  const int64_t offset_ns = NanosecondsFromSeconds(scanner.time_offset_s);
  const bool mirrored =
      faults_.scanners[static_cast<size_t>(scheduled.scanner_index)].mirrored;
  for (int beam = 0; beam < scanner.beams; ++beam) {
    const int64_t time_ns = line.scan_line.BeamTime(beam) + offset_ns;
    const Rigid3d world_from_scanner =
        path_.PoseAt(time_ns) * scanner.BodyFromScanner(time_ns);
    const Eigen::Vector2d beam_direction = line.scan_line.BeamDirection(beam);
    const Eigen::Vector3d origin = world_from_scanner.translation;
    const Eigen::Vector3d direction =
        world_from_scanner.rotation *
        Eigen::Vector3d(
            beam_direction.x(), mirrored ? -beam_direction.y() : beam_direction.y(), 0.0);
    std::optional<RayHit> hit = CastThroughGlass(origin, direction, scheduled, beam);
    if (hit) {
      hit->range +=
          unevenness_.RangeError(hit->face_id, origin + hit->range * direction, direction);
    }
    const std::optional<double> in_the_way =
        moving_things_.Cast(origin, direction, path_, time_ns);
    if (in_the_way && (!hit || *in_the_way < hit->range)) {
      hit = RayHit{*in_the_way, kNoFace, false};
    }
    line.beams.push_back(hit);
  }
  return line;
}

std::optional<RayHit> Simulator::CastThroughGlass(const Eigen::Vector3d& origin_world,
                                                  const Eigen::Vector3d& direction_world,
                                                  const ScheduledLine& scheduled,
                                                  int beam) const {
  const std::optional<RayHit> hit = ray_caster_.Cast(origin_world, direction_world);
  if (!hit || !hit->is_glass) return hit;
  const double chance = Random({seed_,
                                kGlassKey,
                                static_cast<uint64_t>(scheduled.scanner_index),
                                static_cast<uint64_t>(scheduled.line_index),
                                static_cast<uint64_t>(beam)})
                            .Uniform();
  if (chance < faults_.glass.returns) return hit;
  if (chance >= faults_.glass.returns + faults_.glass.passes) return std::nullopt;
  return ray_caster_.Cast(origin_world, direction_world, true);
}

void Simulator::Run(const std::function<void(const PerfectScanLine&)>& sink) const {
  for (const ScheduledLine& scheduled : schedule_) sink(Take(scheduled));
}

}  // namespace plumbline
