#include "apps/progress.h"

#include <cmath>
#include <cstdio>

#include "apps/terminal.h"

namespace plumbline {
namespace {

std::string Duration(double seconds) {
  const auto whole = static_cast<long>(std::lround(seconds));
  if (whole < 100) return std::to_string(whole) + " s";
  if (whole < 3600) {
    return std::to_string(whole / 60) + " min " + std::to_string(whole % 60) + " s";
  }
  return std::to_string(whole / 3600) + " h " + std::to_string(whole % 3600 / 60) + " min";
}

}  // namespace

Progress::Progress(const std::string& job)
    : job_(job),
      is_terminal_(IsTerminal(stderr)),
      start_(Clock::now()),
      last_report_(start_) {}

Progress::~Progress() {
  if (is_terminal_) ShowStatus("");
}

void Progress::Report(const ProgressState& state) {
  if (state.share_done >= 1.0) {  // what follows is the outcome
    if (is_terminal_) ShowStatus("");
    return;
  }
  const Clock::time_point now = Clock::now();
  const std::chrono::duration<double> since_report = now - last_report_;
  const bool is_new_stage = is_terminal_ && stage_ != state.stage;
  if (!is_new_stage && since_report.count() < (is_terminal_ ? 0.1 : 10.0)) return;
  last_report_ = now;
  stage_ = state.stage;
  const std::string line =
      ProgressLine(job_, state, std::chrono::duration<double>(now - start_).count());
  if (is_terminal_) {
    ShowStatus(line);
  } else {
    PrintOnStderr(line);
  }
}

std::string ProgressLine(const std::string& job,
                         const ProgressState& state,
                         double elapsed_s) {
  char share[16];
  std::snprintf(share, sizeof(share), "%3.0f %%", 100.0 * state.share_done);
  std::string line = job + ": " + state.stage + (*state.stage != '\0' ? ", " : "") + share;
  constexpr double kTooShortS = 0.1;  // to tell anything of the whole
  if (state.share_done <= 0.0 || elapsed_s < kTooShortS) return line;
  const double total_s = elapsed_s / state.share_done;
  if (state.recording_s > 0.0 && total_s > 0.0) {
    char speed[64];
    std::snprintf(speed, sizeof(speed), ", %.1f times real time", state.recording_s / total_s);
    line += speed;
  }
  return line + ", " + Duration(total_s - elapsed_s) + " to go";
}

}  // namespace plumbline
