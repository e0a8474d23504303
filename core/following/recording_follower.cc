#include "core/following/recording_follower.h"

#include <algorithm>
#include <utility>

#include "core/util/error.h"
#include "core/util/time.h"

namespace plumbline {
namespace {

// A start that leaves a direction of the position open is taken after this only.
constexpr double kSureStartS = 1.0;

}  // namespace

std::vector<FollowerOfPart> RecordingFollower::Run(
    const std::function<void(double share)>& progress, const std::function<bool()>& stop) {
  const double duration_s =
      std::max(1e-9, SecondsBetween(recording_->start_ns(), recording_->end_ns()));
  ScanReader scans(rig_, recording_);
  Scan scan;
  int64_t previous_end_ns = 0;
  const auto is_followed = [&] { return current_.follower != nullptr || !trials_.empty(); };
  while (scans.Next(&scan)) {
    const double now_s = SecondsBetween(recording_->start_ns(), scan.start_ns);
    progress(now_s / duration_s);
    if (stop && stop()) {
      if (is_followed()) EndPart("stopped by the user");
      break;
    }
    if (is_followed()) {
      const double gap_s = SecondsBetween(previous_end_ns, scan.start_ns);
      if (gap_s > options_.max_gap_s && !WheelsCover(previous_end_ns, scan.start_ns)) {
        EndPart("no scans for " + FormatSeconds(gap_s) +
                ", a gap the motion can not be followed across");
      }
    }
    if (current_.follower != nullptr) {
      Follow(scan);
    } else if (!TryToStart(scan, now_s)) {
      break;
    }
    previous_end_ns = scan.end_ns;
  }
  if (is_followed()) EndPart("");
  if (!parts_.empty()) return std::move(parts_);
  if (!lost_.empty()) throw Error(lost_);
  throw Error("no start: none of the first " + std::to_string(num_skipped_) + " scans shows " +
              (planar_ ? "a wall" : "floor or ceiling and a wall") + " clearly enough");
}

bool RecordingFollower::WheelsCover(int64_t begin_ns, int64_t end_ns) const {
  const std::shared_ptr<const Odometry> odometry = recording_->odometry();
  return options_.odometry.enabled && odometry != nullptr &&
         odometry->Covers(begin_ns, end_ns);
}

bool RecordingFollower::TryToStart(const Scan& scan, double now_s) {
  trials_.Follow(scan);
  if (trials_.WantsStart(now_s) && (trials_.empty() || options_.rules.several_starts)) {
    const bool is_first = trials_.empty();
    std::unique_ptr<HypothesisFollower> follower = StartWith(scan, now_s);
    if (follower != nullptr) {
      if (is_first) first_trial_s_ = now_s;
      trials_.Add(std::move(follower), now_s);
    } else if (is_first && StartByGravity(scan, now_s)) {
      return true;
    } else if (is_first && parts_.empty() && lost_.empty()) {
      ++num_skipped_;
      return now_s <= options_.tracking.max_start_search_s;
    }
  }
  if (trials_.IsDecided(now_s)) DecideStart();
  return true;
}

std::unique_ptr<HypothesisFollower> RecordingFollower::MakeFollower() const {
  return std::make_unique<HypothesisFollower>(
      rig_,
      planar_,
      options_,
      recording_->scan_period_s(),
      options_.odometry.enabled ? recording_->odometry() : nullptr,
      recording_->imu());
}

std::optional<int64_t> RecordingFollower::KnotOfFirstPart() const {
  if (parts_.empty()) return std::nullopt;
  return parts_.front().follower->follower().state().trajectory.start_ns();
}

bool RecordingFollower::StartByGravity(const Scan& scan, double now_s) {
  std::unique_ptr<HypothesisFollower> follower = MakeFollower();
  if (!follower->StartByGravity(scan, KnotOfFirstPart())) return false;
  current_ = {std::move(follower), now_s, now_s, ""};
  return true;
}

std::unique_ptr<HypothesisFollower> RecordingFollower::StartWith(const Scan& scan,
                                                                 double now_s) {
  std::unique_ptr<HypothesisFollower> follower = MakeFollower();
  const bool must_hold = parts_.empty() && now_s < kSureStartS;
  try {
    if (follower->Start(scan, must_hold, KnotOfFirstPart())) return follower;
  } catch (const Error& error) {
    // The scan shows the frame, but does not determine the pose.
    if (trials_.empty()) lost_ = error.what();
  }
  return nullptr;
}

void RecordingFollower::DecideStart() {
  FollowedStart start = trials_.Take();
  if (start.start_s > first_trial_s_) {
    left_out_.push_back("the map starts at " + FormatSeconds(start.start_s) + " instead of " +
                        FormatSeconds(first_trial_s_) +
                        ": maps that start before explain less of what comes after");
  }
  current_ = {std::move(start.follower), start.start_s, start.start_s, ""};
  if (start.lost.empty()) return;
  current_.follower->follower().EndAtLastKnown();
  EndPart(start.lost);
}

void RecordingFollower::Follow(const Scan& scan) {
  try {
    current_.follower->Follow(scan);
  } catch (const LostTrack& lost) {
    current_.follower->follower().EndAtLastKnown();
    EndPart(lost.what());
  }
}

void RecordingFollower::EndPart(const std::string& why) {
  if (current_.follower == nullptr) {
    DecideStart();
    if (current_.follower == nullptr) return;  // it had lost the rig, and has ended
  }
  current_.follower->follower().FaceWall();
  const std::vector<int64_t>& times_ns = current_.follower->follower().scan_times_ns();
  current_.end_s = SecondsBetween(recording_->start_ns(), times_ns.back());
  current_.ended_by = why;
  // A whole recording is mapped however short it is.
  const bool is_whole = why.empty() && parts_.empty() && lost_.empty();
  if (is_whole || current_.end_s - current_.start_s >= options_.tracking.min_part_s) {
    parts_.push_back(std::move(current_));
  } else if (!why.empty()) {
    lost_ = why;
    left_out_.push_back("what was followed from " + FormatSeconds(current_.start_s) + " to " +
                        FormatSeconds(current_.end_s) + " is left out: " + why);
  }
  current_ = {};
}

}  // namespace plumbline
