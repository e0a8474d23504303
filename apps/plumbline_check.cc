// Says of a recording, before it is mapped, what is wrong with it.

#include <gflags/gflags.h>

#include <cstdio>
#include <optional>
#include <string>

#include "apps/app.h"
#include "core/judging/check_job.h"

DEFINE_string(recording, "", "recording to look at; may also stand alone, without the flag");
DEFINE_string(rig,
              "",
              "rig file (YAML) to hold the recording against; without it, a first one is "
              "written to fill in");
DEFINE_string(output,
              "",
              "directory for check.svg, check.json and the first rig file (default: the "
              "recording's name with _check, in the current directory)");

namespace {

// The exit code of a recording that can not be mapped as it is.
constexpr int kNotMappable = 3;

}  // namespace

int main(int argc, char** argv) {
  bool is_mappable = true;
  const int exit_code = plumbline::RunApp(
      argc,
      argv,
      "looks at a recording before it is mapped: topics, rates, gaps, clocks, ranges, and "
      "whether the scanners sit as the rig file says",
      __FILE__,
      {"recording"},
      [&is_mappable] {
        const plumbline::CheckOutcome outcome =
            plumbline::RunCheckJob({FLAGS_recording, FLAGS_rig, FLAGS_output});
        std::fputs(outcome.text.c_str(), stdout);
        is_mappable = outcome.is_mappable;
      },
      "recording");
  return exit_code == 0 && !is_mappable ? kNotMappable : exit_code;
}
