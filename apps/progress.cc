#include "apps/progress.h"

#include <unistd.h>

#include <cstdio>

namespace plumbline {

Progress::Progress(const std::string& stage)
    : stage_(stage),
      is_terminal_(isatty(STDERR_FILENO) == 1),
      start_(Clock::now()),
      last_report_(start_) {}

Progress::~Progress() {
  if (line_is_open_) std::fputc('\n', stderr);
}

void Progress::Report(double share_done) {
  const Clock::time_point now = Clock::now();
  const std::chrono::duration<double> since_report = now - last_report_;
  const bool is_end = share_done >= 1.0 && line_is_open_;
  if (!is_end && since_report.count() < (is_terminal_ ? 0.2 : 10.0)) return;
  last_report_ = now;
  const double elapsed_s = std::chrono::duration<double>(now - start_).count();
  const double remaining_s =
      share_done > 0.0 ? elapsed_s * (1.0 - share_done) / share_done : 0.0;
  std::fprintf(stderr,
               "%s%s: %3.0f %%, %.0f s, %.0f s to go%s",
               is_terminal_ ? "\r" : "",
               stage_.c_str(),
               100.0 * share_done,
               elapsed_s,
               remaining_s,
               is_terminal_ ? "   " : "\n");
  line_is_open_ = is_terminal_;
}

}  // namespace plumbline
