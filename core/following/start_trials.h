#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "core/following/hypothesis_follower.h"
#include "core/sensor/scan_reader.h"

namespace plumbline {

// A part of the recording as it is followed, from one scan on.
struct FollowedStart {
  std::unique_ptr<HypothesisFollower> follower;
  double start_s = 0.0;  // since the recording's start
  std::string lost;      // why it has lost the rig; empty where it has not
};

// Chooses the scan that a map starts with. The first scan has to tell floors from walls alone:
// stairs, furniture or a roof may give it a vertical that is none, and the map that follows
// then either slips for as long as the rig sees the same surfaces, or not at all. So several
// scans of the first second are tried, each with a map of its own, side by side. The earliest
// one is taken, unless the map of a later one explains clearly more of the same scans.
class StartTrials {
 public:
  // Times after the first scan at which starts are tried.
  static constexpr double kDelaysS[] = {0.0, 0.125, 0.25, 0.5, 1.0};
  // Time after the first scan at which the choice is made,
  static constexpr double kDurationS = 2.0;
  // and after the start of a map that explains nearly all that it sees.
  static constexpr double kSureAfterS = 1.0;

  bool empty() const { return trials_.empty(); }
  // Whether the next scan, of this time since the recording's start, is to be tried.
  bool WantsStart(double now_s) const;
  // Adds a follower that has just been started.
  void Add(std::unique_ptr<HypothesisFollower> follower, double now_s);
  // Lets all trials follow a scan; those that lose the rig end, unless all others have.
  void Follow(const Scan& scan);
  // Whether what is tried has been followed for long enough.
  bool IsDecided(double now_s) const;
  // Takes the trial that goes on; there is none afterwards.
  FollowedStart Take();

 private:
  std::vector<FollowedStart> trials_;  // in the order of their starts
  double first_start_s_ = 0.0;
  size_t num_tried_ = 0;
};

// The points of a scan, and those of them on surfaces of a map.
struct ExplainedPoints {
  int num_points = 0;
  int num_explained = 0;
};

// Selects the earliest trial that no later one explains clearly more than, over the scans in
// which both have settled. of_trials: of each trial the scans since its start, all up to the
// same scan; earliest first. num_settling: scans after a start that do not count.
size_t EarliestGoodTrial(const std::vector<std::vector<ExplainedPoints>>& of_trials,
                         size_t num_settling);

}  // namespace plumbline
