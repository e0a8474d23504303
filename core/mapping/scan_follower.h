#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "core/association/plane_candidates.h"
#include "core/map/map_state.h"
#include "core/map/observation.h"
#include "core/map/observation_poses.h"
#include "core/options/mapper_options.h"
#include "core/sensor/rig.h"
#include "core/sensor/scan_reader.h"
#include "core/sensor/scanner_motion.h"
#include "core/tracking/tracker.h"
#include "core/util/stopwatch.h"
#include "core/window/window.h"

namespace plumbline {

// Follows the rig scan by scan: segmentation, tracking, new planes, window.
class ScanFollower {
 public:
  ScanFollower(const Rig& rig, bool planar, const MapperOptions& options, double scan_period_s)
      : rig_(rig),
        planar_(planar),
        options_(options),
        scan_period_s_(scan_period_s),
        candidates_(planar, options) {}

  bool started() const { return window_ != nullptr; }
  MapState& state() { return *state_; }
  const std::vector<int64_t>& scan_times_ns() const { return scan_times_ns_; }
  const std::vector<WindowEstimate>& estimates() const { return window_->estimates(); }
  Stopwatch& segmentation_watch() { return segmentation_watch_; }

  // Looks for the model frame in this scan; false when it does not show.
  bool Start(const Scan& scan);
  // Takes the next scan. Throws Error when the pose is lost.
  void Follow(const Scan& scan);

 private:
  std::vector<Observation> Observe(const Scan& scan);
  ScannerMotion PredictMotion(const ScanLine& scan_line) const;
  void Accept(int observation_index, bool tracked);
  void Judge(const Observation& observation);
  void StartPlanes(int min_scans);
  bool IsRedundantPlane(const TentativePlane& candidate) const;
  void AddLandmark(TentativePlane candidate);
  void SolveWindow(int64_t now_ns);
  void CheckNotLost(int64_t now_ns);

  const Rig& rig_;
  bool planar_;
  const MapperOptions& options_;
  double scan_period_s_;
  TentativePlanes candidates_;
  std::unique_ptr<MapState> state_;
  std::unique_ptr<Window> window_;
  std::unique_ptr<Tracker> tracker_;
  std::vector<int64_t> scan_times_ns_;
  std::optional<SharedPoses> poses_;  // of the trajectory as the newest scan leaves it
  int64_t last_known_ns_ = 0;         // when the pose was last well determined
  int last_solved_interval_ = -1;
  int last_solved_scan_ = 0;
  Stopwatch segmentation_watch_;
};

}  // namespace plumbline
