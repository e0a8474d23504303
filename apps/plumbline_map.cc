// Maps a recording of several 2D laser scanners.

#include <gflags/gflags.h>

#include <cstdio>

#include "apps/app.h"
#include "apps/progress.h"
#include "core/mapping/map_job.h"
#include "core/util/error.h"

// Read by jemalloc: free memory is kept (but see core/util/free_memory.h), in huge pages.
extern "C" {
const char* malloc_conf = "dirty_decay_ms:-1,thp:always";
}

DEFINE_string(recording, "", "ROS 1 bag with one LaserScan topic per scanner");
DEFINE_string(rig, "", "rig file (YAML): where the scanners sit and how well they measure");
DEFINE_string(config,
              "",
              "mapper settings (YAML) or a whole experiment; without it, defaults");
DEFINE_int32(threads, 0, "0: as many as there are cores; the result does not depend on them");
DEFINE_string(output, "", "directory for map, trajectory, planes and summary");

int main(int argc, char** argv) {
  return plumbline::RunApp(
      argc,
      argv,
      "a recording of 2D scan lines in, the rig's trajectory, the building's planes and a map "
      "out",
      __FILE__,
      {"recording", "rig", "output"},
      [] {
        if (FLAGS_threads < 0) throw plumbline::Error("--threads must be at least 0");
        plumbline::Progress progress("map");
        const plumbline::Summary summary = plumbline::RunMapJob(
            {FLAGS_recording, FLAGS_rig, FLAGS_config, FLAGS_output, FLAGS_threads},
            [&](double share) { progress.Report(share); });
        std::printf(
            "%d scans, %d planes, residual RMS %.1f mm, %.1f s at %.1f times real time\n",
            summary.scans,
            summary.planes,
            1e3 * summary.residual_rms_m,
            summary.duration_s,
            summary.real_time_factor);
      });
}
