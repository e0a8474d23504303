#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "core/association/model_frame.h"
#include "core/association/plane_candidates.h"
#include "core/following/tracker.h"
#include "core/map/map_state.h"
#include "core/map/observation.h"
#include "core/map/observation_poses.h"
#include "core/options/mapper_options.h"
#include "core/registration/scan_matching.h"
#include "core/sensor/imu.h"
#include "core/sensor/odometry.h"
#include "core/sensor/rig.h"
#include "core/sensor/scan_reader.h"
#include "core/sensor/scanner_motion.h"
#include "core/trajectory/motion_prior.h"
#include "core/util/error.h"
#include "core/util/stopwatch.h"
#include "core/window/window.h"

namespace plumbline {

// From scan to scan the rig's position is known to this even while nothing determines it, m.
inline constexpr double kUnheldStddev = 0.05;

// The rig's pose is no longer known; what was mapped until then stands.
class LostTrack : public Error {
 public:
  using Error::Error;
};

// Follows the rig scan by scan: segmentation, tracking, new planes, window.
class ScanFollower {
 public:
  // odometry, imu: nullptr where there is none.
  ScanFollower(const Rig& rig,
               bool planar,
               const MapperOptions& options,
               double scan_period_s,
               std::shared_ptr<const Odometry> odometry = nullptr,
               std::shared_ptr<const ImuReadings> imu = nullptr)
      : rig_(rig),
        planar_(planar),
        options_(options),
        scan_period_s_(scan_period_s),
        odometry_(std::move(odometry)),
        imu_(std::move(imu)),
        tentative_planes_(planar, options, MaxRangeNoise(rig), imu_ != nullptr),
        motion_prior_(options.trajectory) {}

  // Goes on from where another one stands, with a copy of its map.
  ScanFollower(const ScanFollower& other);
  ScanFollower& operator=(const ScanFollower&) = delete;

  bool started() const { return window_ != nullptr; }
  const MapState& state() const { return *state_; }
  MapState& state() { return *state_; }
  const std::vector<int64_t>& scan_times_ns() const { return scan_times_ns_; }
  const std::vector<WindowEstimate>& estimates() const { return window_->estimates(); }
  Stopwatch& segmentation_watch() { return segmentation_watch_; }
  // The local map of the last scans; nullptr if points hold no pose.
  const ScanMatcher* scan_matcher() const { return scan_matcher_.get(); }
  // Whether walls leave the newest scan's position open in some horizontal direction, or, in
  // space, its heading.
  bool is_open() const { return tracker_->is_open(); }

  // Estimates what the window holds once more by long walls, floors and the motion alone, and
  // goes on so wherever these walls leave the position open. Founds no surface from now on.
  void BridgeByMotion(int64_t now_ns);
  // Follows in the usual way again.
  void EndBridging();

  // Starts the map with this scan; false when the scan does not show the model frame.
  // must_hold: false, too, where it sees ramps or roofs, of which level traces look like
  // walls, and the planes that two scanners show leave a direction of the position open.
  // knot_ns, if given: an earlier instant that its knots shall fall together with, so that
  // parts of one recording can be joined.
  bool Start(const Scan& scan, bool must_hold = false, std::optional<int64_t> knot_ns = {});
  // Starts the map with this scan where it shows no model frame: z points against gravity, the
  // rig's heading is held, and planes are founded as the IMU leads the rig past them; false
  // where no IMU is read.
  bool StartByGravity(const Scan& scan, std::optional<int64_t> knot_ns = {});
  // Follows the rig through the next scan. Throws LostTrack when the pose is lost: nothing may
  // follow but EndAtLastKnown().
  void Follow(const Scan& scan);
  // Gives a map that started by gravity its frame: x is the normal of a wall. Nothing may
  // follow.
  void FaceWall();
  // Takes back what came after the last scan whose pose was well determined: its scans,
  // segments and control points, and planes that only they show.
  void EndAtLastKnown();

 private:
  // The model frame of the first scan's observations, and whether they see ramps or roofs.
  std::optional<ModelFrame> FindFrame(const std::vector<Observation>& observations,
                                      bool* sees_slopes) const;
  // Begins an empty map at this scan, with the rig at rest at the origin.
  void MakeMap(const Scan& scan,
               const Eigen::Quaterniond& world_from_body,
               std::optional<int64_t> knot_ns);
  // Whether the normals of the planes so far leave no direction of the position open.
  bool HoldsPosition() const;
  void FollowWhileKnown(const Scan& recorded);
  // The scan without the ranges of scan lines that repeat their scanner's last one to the bit:
  // a scanner that has frozen says that the rig stands still.
  Scan WithoutRepetitions(const Scan& scan);
  // Finds the segments of a scan.
  std::vector<Observation> Observe(const Scan& scan);
  ScannerMotion PredictMotion(const ScanLine& scan_line) const;
  // Takes in a scan's observations, once it has been tracked: on their landmarks, or as
  // what may found new ones.
  void TakeObservations(int first, int last);
  // Gives an observation that has a landmark to the window, and to the tracker unless the scan
  // was tracked with it.
  void Accept(int observation_index, bool tracked);
  // Takes the deviation of an observation into its landmark.
  void Judge(const Observation& observation);
  // Makes landmarks of the tentative planes that enough scans have seen.
  void StartPlanes(int min_scans, int min_scanners = 1);
  // Whether the plane only repeats a landmark (IsRedundant).
  bool IsRedundantPlane(const TentativePlane& plane) const;
  void AddLandmark(TentativePlane plane);
  // Solves the window, passes the newest poses on to the tracker, and merges planes.
  void SolveWindow(int64_t now_ns);
  // Throws LostTrack when the newest pose has been unknown for too long.
  void CheckNotLost(int64_t now_ns);

  Rig rig_;  // its poses as they are estimated
  bool planar_;
  const MapperOptions& options_;
  double scan_period_s_;
  std::shared_ptr<const Odometry> odometry_;
  std::shared_ptr<const ImuReadings> imu_;
  TentativePlanes tentative_planes_;
  MotionPrior motion_prior_;
  std::unique_ptr<MapState> state_;
  std::unique_ptr<Window> window_;
  std::unique_ptr<Tracker> tracker_;
  std::unique_ptr<ScanMatcher> scan_matcher_;  // where points hold the pose
  std::vector<int64_t> scan_times_ns_;
  std::vector<std::vector<float>> previous_ranges_;  // by scanner
  std::optional<SharedPoses> poses_;  // of the trajectory as the newest scan leaves it
  int64_t last_known_ns_ = 0;         // when the pose was last well determined
  size_t last_known_scan_ = 0;        // the scan that ended then
  bool may_found_ = true;
  int last_solved_interval_ = -1;
  int last_solved_scan_ = 0;
  int num_calibrated_ = 0;  // knot intervals that the odometry has been calibrated with
  Stopwatch segmentation_watch_;
};

}  // namespace plumbline
