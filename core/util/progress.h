#pragma once

#include <functional>

namespace plumbline {

// ProgressState says how far a job is. It converts from and to the share that is done, for
// jobs of one stage and for callers that want no more than that.
struct ProgressState {
  ProgressState(double share) : share_done(share) {}  // NOLINT: see above
  operator double() const { return share_done; }      // NOLINT

  // 0 to 1, roughly by the time it takes.
  double share_done = 0.0;
  // The present stage in a word or two, such as "following"; empty: the job's one stage.
  const char* stage = "";
  // The length of the recording that the job works on; 0: not known.
  double recording_s = 0.0;
};

// Called now and then while a job goes on.
using ProgressCallback = std::function<void(const ProgressState& state)>;

}  // namespace plumbline
