#pragma once

#include <chrono>
#include <string>

namespace plumbline {

// Progress prints on stderr how far a stage is and how long it will still take: one line that
// is rewritten on a terminal, a line every 10 s otherwise.
class Progress {
 public:
  explicit Progress(const std::string& stage);
  ~Progress();

  void Report(double share_done);  // 0 to 1; cheap to call often

 private:
  using Clock = std::chrono::steady_clock;

  std::string stage_;
  bool is_terminal_;
  Clock::time_point start_;
  Clock::time_point last_report_;
  bool line_is_open_ = false;
};

}  // namespace plumbline
