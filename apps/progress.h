#pragma once

#include <chrono>
#include <string>

#include "core/util/progress.h"

namespace plumbline {

// Progress prints on stderr what a program is doing, how far it is, how fast compared with the
// recording's time, and how long it will still take: on a terminal one line that is rewritten
// and goes away with the last report, a line every 10 s otherwise.
class Progress {
 public:
  // job: what is done, in one word, such as "map".
  explicit Progress(const std::string& job);
  ~Progress();

  void Report(const ProgressState& state);  // cheap to call often

 private:
  using Clock = std::chrono::steady_clock;

  std::string job_;
  std::string stage_;  // of the last report
  bool is_terminal_;
  Clock::time_point start_;
  Clock::time_point last_report_;
};

// Returns the line that Progress shows, such as "map: following,  43 %, 12.4 times real time,
// 1 min 20 s to go". The speed is that of the whole job, from what is done so far.
std::string ProgressLine(const std::string& job, const ProgressState& state, double elapsed_s);

}  // namespace plumbline
