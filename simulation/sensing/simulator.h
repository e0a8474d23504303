#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "core/sensor/scan_line.h"
#include "simulation/sensing/experiment.h"
#include "simulation/world/path.h"
#include "simulation/world/ray_caster.h"

namespace plumbline {

// PerfectScanLine is a scan line as an errorless scanner with unlimited range takes it.
struct PerfectScanLine {
  ScanLine scan_line;                        // its ranges are empty
  int line_index = 0;                        // among the scan lines of its scanner
  std::vector<std::optional<RayHit>> beams;  // nullopt where the beam meets nothing
};

// Adds the errors of a scanner to the ranges: Gaussian noise, lost returns, and +infinity
// where a range is beyond the scanner's limits. The random numbers depend only on the seed,
// the scanner and the line.
ScanLine AddNoise(const PerfectScanLine& perfect,
                  const Scanner& scanner,
                  const NoiseOptions& noise,
                  uint64_t seed);

// Moves the rig along its path through the building and takes every beam from the rig's pose
// at the beam's own time.
class Simulator {
 public:
  // Throws Error naming file, line and place where the body or a scanner leaves the free space
  // or comes closer to a face than kMinClearance. What a mesh encloses is not known: there, a
  // floor has to lie below. seed: of the world's chances: people's and doors' phases, what
  // glass does with a beam, uneven surfaces.
  explicit Simulator(const Experiment& experiment, uint64_t seed = 1);

  // m; people and their rigs keep farther away, and a scanner inside a wall is a mistake.
  static constexpr double kMinClearance = 0.1;

  // Calls the sink with every scan line, in the order of their stamps; those of the same stamp
  // come in the order of the scanners.
  void Run(const std::function<void(const PerfectScanLine&)>& sink) const;

  int num_scan_lines() const { return static_cast<int>(schedule_.size()); }
  const Path& path() const { return path_; }
  // The rig that measures, which is not what the rig file says where the experiment has
  // faults.
  const Rig& true_rig() const { return rig_; }
  const SimulatedMounts& mounts() const { return mounts_; }
  // Stamp of the first scan line.
  int64_t first_line_ns() const { return schedule_.front().stamp_ns; }

 private:
  struct ScheduledLine {
    int64_t stamp_ns = 0;
    int scanner_index = 0;
    int line_index = 0;
  };

  void CheckPath() const;
  void CheckPlace(const Eigen::Vector3d& p_world, int64_t time_ns) const;
  void MakeSchedule();
  PerfectScanLine Take(const ScheduledLine& scheduled) const;
  std::optional<RayHit> CastThroughGlass(const Eigen::Vector3d& origin_world,
                                         const Eigen::Vector3d& direction_world,
                                         const ScheduledLine& scheduled,
                                         int beam) const;

  Rig rig_;
  SimulatedMounts mounts_;
  std::vector<double> scanner_phases_s_;
  Path path_;
  bool building_is_closed_ = true;
  RayCaster ray_caster_;
  MovingThings moving_things_;
  FaultOptions faults_;
  Unevenness unevenness_;
  uint64_t seed_ = 1;
  std::vector<ScheduledLine> schedule_;
};

}  // namespace plumbline
