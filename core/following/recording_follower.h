#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/following/hypothesis_follower.h"
#include "core/following/start_trials.h"
#include "core/options/mapper_options.h"
#include "core/sensor/recording.h"
#include "core/sensor/rig.h"
#include "core/sensor/scan_reader.h"

namespace plumbline {

// A part of the recording that could be followed.
struct FollowerOfPart {
  std::unique_ptr<HypothesisFollower> follower;
  double start_s = 0.0;  // since the recording's start
  double end_s = 0.0;
  std::string ended_by;
};

// Takes the recording scan by scan, to its end, in as many parts as the scans allow.
class RecordingFollower {
 public:
  RecordingFollower(const Rig& rig,
                    bool planar,
                    const MapperOptions& options,
                    RecordingReader* recording)
      : rig_(rig), planar_(planar), options_(options), recording_(recording) {}

  // Throws Error when there is no start, or the pose is lost before anything is mapped.
  // progress: takes the share of the recording that has been followed. stop: asked before each
  // scan whether to end there.
  std::vector<FollowerOfPart> Run(const std::function<void(double share)>& progress,
                                  const std::function<bool()>& stop);

  // Scans before the first part that show no model frame.
  int num_skipped() const { return num_skipped_; }
  // Other stretches that are left out, and why, in words.
  const std::vector<std::string>& left_out() const { return left_out_; }

 private:
  // Whether the odometry says how the rig moved between two instants.
  bool WheelsCover(int64_t begin_ns, int64_t end_ns) const;
  // Looks for the scan that a part starts with; false when there is no use in looking any
  // longer.
  bool TryToStart(const Scan& scan, double now_s);
  std::unique_ptr<HypothesisFollower> MakeFollower() const;
  // An instant that the knots of all parts fall together with; nothing before the first part.
  std::optional<int64_t> KnotOfFirstPart() const;
  // Starts a part with this scan, which shows no model frame, by the IMU; false where it reads
  // no gravity. There is nothing to choose: gravity is as good a vertical from any scan.
  bool StartByGravity(const Scan& scan, double now_s);
  // A follower that this scan starts; nullptr where the scan does not show the model frame.
  std::unique_ptr<HypothesisFollower> StartWith(const Scan& scan, double now_s);
  // Goes on with one of the starts tried.
  void DecideStart();
  void Follow(const Scan& scan);
  // Ends the current part, which is kept where it is long enough to be of use.
  void EndPart(const std::string& why);

  const Rig& rig_;
  bool planar_;
  const MapperOptions& options_;
  RecordingReader* recording_;
  std::vector<FollowerOfPart> parts_;
  FollowerOfPart current_;  // without a follower: none
  StartTrials trials_;
  double first_trial_s_ = 0.0;
  int num_skipped_ = 0;
  std::string lost_;  // why the last part that was too short had ended
  std::vector<std::string> left_out_;
};

}  // namespace plumbline
