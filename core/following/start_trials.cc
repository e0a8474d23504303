#include "core/following/start_trials.h"

#include <glog/logging.h>

#include <algorithm>
#include <iterator>
#include <utility>

#include "core/util/error.h"
#include "core/util/time.h"

namespace plumbline {
namespace {

// A start's first scans found its surfaces: what they explain is not compared.
constexpr double kSettlingS = 0.5;
// A later start explains clearly more where the share of the points is larger by this. Good
// starts of one recording differ by up to 0.02, those that went astray by 0.04 to 0.66.
constexpr double kMinGain = 0.03;
// The share that a good start explains in bare buildings: those that went astray have up to
// 0.72 there.
constexpr double kSureShare = 0.85;

std::vector<ExplainedPoints> ExplainedBy(const ScanFollower& follower) {
  std::vector<ExplainedPoints> scans(follower.scan_times_ns().size());
  for (const Observation& observation : follower.state().observations) {
    ExplainedPoints& scan = scans[static_cast<size_t>(observation.scan_index)];
    scan.num_points += observation.num_points;
    if (observation.landmark_id >= 0) scan.num_explained += observation.num_points;
  }
  return scans;
}

// The share of the points that is explained in the last scans.
double ShareOfLast(const std::vector<ExplainedPoints>& scans, size_t num_scans) {
  double num_points = 0.0;
  double num_explained = 0.0;
  for (size_t i = scans.size() - num_scans; i < scans.size(); ++i) {
    num_points += scans[i].num_points;
    num_explained += scans[i].num_explained;
  }
  return num_points == 0.0 ? 0.0 : num_explained / num_points;
}

// How many of a follower's first scans lie within the time in which a start settles.
size_t NumSettling(const ScanFollower& follower) {
  const std::vector<int64_t>& times_ns = follower.scan_times_ns();
  const auto settled = std::find_if(times_ns.begin(), times_ns.end(), [&](int64_t time_ns) {
    return SecondsBetween(times_ns.front(), time_ns) >= kSettlingS;
  });
  return static_cast<size_t>(settled - times_ns.begin());
}

}  // namespace

size_t EarliestGoodTrial(const std::vector<std::vector<ExplainedPoints>>& of_trials,
                         size_t num_settling) {
  size_t chosen = 0;
  for (size_t later = 1; later < of_trials.size(); ++later) {
    if (of_trials[later].size() <= num_settling) break;
    const size_t num_compared = of_trials[later].size() - num_settling;
    const double gain = ShareOfLast(of_trials[later], num_compared) -
                        ShareOfLast(of_trials[chosen], num_compared);
    if (gain > kMinGain) chosen = later;
  }
  return chosen;
}

bool StartTrials::WantsStart(double now_s) const {
  if (trials_.empty()) return true;
  return num_tried_ < std::size(kDelaysS) && now_s - first_start_s_ >= kDelaysS[num_tried_];
}

void StartTrials::Add(std::unique_ptr<HypothesisFollower> follower, double now_s) {
  if (trials_.empty()) {
    first_start_s_ = now_s;
    num_tried_ = 0;
  }
  trials_.push_back({std::move(follower), now_s, ""});
  ++num_tried_;
}

void StartTrials::Follow(const Scan& scan) {
  for (FollowedStart& trial : trials_) {
    if (!trial.lost.empty()) continue;
    try {
      trial.follower->Follow(scan);
    } catch (const LostTrack& lost) {
      trial.lost = lost.what();
    }
  }
  const auto is_lost = [](const FollowedStart& trial) { return !trial.lost.empty(); };
  if (std::all_of(trials_.begin(), trials_.end(), is_lost)) return;
  trials_.erase(std::remove_if(trials_.begin(), trials_.end(), is_lost), trials_.end());
}

bool StartTrials::IsDecided(double now_s) const {
  if (trials_.empty()) return false;
  const FollowedStart& first = trials_.front();
  if (!first.lost.empty() || now_s - first_start_s_ >= kDurationS) return true;
  if (now_s - first.start_s < kSureAfterS) return false;
  const ScanFollower& follower = first.follower->follower();
  const std::vector<ExplainedPoints> scans = ExplainedBy(follower);
  return ShareOfLast(scans, scans.size() - NumSettling(follower)) >= kSureShare;
}

FollowedStart StartTrials::Take() {
  size_t chosen = 0;
  if (trials_.size() > 1) {
    std::vector<std::vector<ExplainedPoints>> of_trials;
    for (const FollowedStart& trial : trials_) {
      of_trials.push_back(ExplainedBy(trial.follower->follower()));
    }
    chosen = EarliestGoodTrial(of_trials, NumSettling(trials_.front().follower->follower()));
    VLOG(1) << "of " << trials_.size() << " starts number " << chosen + 1 << " goes on, at "
            << trials_[chosen].start_s << " s";
  }
  FollowedStart taken = std::move(trials_[chosen]);
  trials_.clear();
  return taken;
}

}  // namespace plumbline
