// Maps a recording of several 2D laser scanners.

#include <gflags/gflags.h>

#include <cstdio>
#include <string>

#include "apps/app.h"
#include "apps/progress.h"
#include "apps/terminal.h"
#include "apps/version.h"
#include "core/judging/rig_choice.h"
#include "core/mapping/map_job.h"
#include "core/result/closing_table.h"
#include "core/result/result_reader.h"

// jemalloc reads this: it keeps free memory (but see core/util/free_memory.h), in huge pages.
extern "C" {
const char* malloc_conf = "dirty_decay_ms:-1,thp:always,lg_extent_max_active_fit:20";
}

DEFINE_string(recording,
              "",
              "recording with one topic of scan lines per scanner: ROS 1 bag, ROS 2 recording "
              "(.mcap, .db3 or its folder) or CARMEN log (.clf, .log), also packed (.bz2, "
              ".zstd); may also stand alone, without the flag");
DEFINE_string(
    rig,
    "",
    "rig file (YAML): where the scanners sit and how well they measure; without it, "
    "NAME_rig.yaml or rig.yaml beside the recording, or else what its /tf_static says");
DEFINE_string(config,
              "",
              "mapper settings (YAML), or an experiment file with its section mapper; without "
              "it, every setting has its default");
DEFINE_int32(
    threads,
    0,
    "number of threads, which changes the time but not the result; 0: as many as there "
    "are cores");
DEFINE_validator(threads, [](const char*, int32_t threads) { return threads >= 0; });
DEFINE_bool(
    resume,
    false,
    "go on where a run with the same inputs and output was killed, once it had followed "
    "the whole recording");
DEFINE_bool(force,
            false,
            "map a recording although it is known before that a wrong map comes "
            "of it");
DEFINE_double(checkpoint_after_s,
              2.0,
              "for --resume, what following has found is kept where it took at least so many "
              "seconds: less is sooner done again");
DEFINE_validator(checkpoint_after_s,
                 [](const char*, double seconds) { return seconds >= 0.0; });
DEFINE_string(formats,
              plumbline::kDefaultCloudFormats,
              "in which the points of the map are written: a list of ply, pcd, las (1.4), las12 "
              "(1.2) and e57; plumbline_export makes the others from map.ply later");
DEFINE_validator(formats, [](const char*, const std::string& list) {
  return plumbline::IsCloudFormatList(list);
});
DEFINE_bool(report,
            false,
            "also write report.html, a page that shows the map in any browser, as "
            "plumbline_report does");
DEFINE_bool(floor_plan,
            false,
            "also draw the floor plan of each storey (SVG, DXF), with rooms as CityJSON and "
            "their areas in rooms.json; plumbline_plan does so later");
DEFINE_string(
    output,
    "",
    "directory for map, trajectory, planes and summary (default: the recording's name "
    "with _map, in the current directory)");

namespace {

// The exit code where a map was written that must not be trusted.
constexpr int kContradictoryMap = 3;

// The table with its verdict in a colour, on a terminal.
std::string InColour(std::string table, plumbline::Verdict verdict) {
  const std::string line = "Verdict: " + plumbline::VerdictName(verdict);
  const size_t place = table.find(line);
  if (place == std::string::npos) return table;
  const plumbline::Colour colour =
      verdict == plumbline::Verdict::kConsistent ? plumbline::Colour::kGreen
      : verdict == plumbline::Verdict::kDoubtful ? plumbline::Colour::kYellow
                                                 : plumbline::Colour::kRed;
  return table.replace(place, line.size(), plumbline::Coloured(line, colour, stdout));
}

void Print(const plumbline::Summary& summary) {
  const std::string table =
      plumbline::ClosingTable(summary,
                              plumbline::ReadPlanes(FLAGS_output + "/planes.json"),
                              plumbline::ReadTrajectory(FLAGS_output + "/trajectory.tum"),
                              FLAGS_output,
                              FLAGS_report);
  std::fputs(InColour(table, summary.consistency.verdict).c_str(), stdout);
}

plumbline::Summary Map() {
  if (FLAGS_output.empty())
    FLAGS_output = plumbline::NameOfRecording(FLAGS_recording) + "_map";
  plumbline::Progress progress("map");
  plumbline::MapJob job;
  job.recording = FLAGS_recording;
  const plumbline::RigChoice rig = plumbline::ChooseRig(FLAGS_recording, FLAGS_rig);
  job.rig = rig.path;
  if (!rig.why.empty()) std::printf("Rig file: %s (%s)\n", rig.path.c_str(), rig.why.c_str());
  job.config = FLAGS_config;
  job.output = FLAGS_output;
  job.version = plumbline::Version();
  job.threads = FLAGS_threads;
  job.resume = FLAGS_resume;
  job.force = FLAGS_force;
  job.checkpoint_after_s = FLAGS_checkpoint_after_s;
  job.report = FLAGS_report;
  job.floor_plan = FLAGS_floor_plan;
  job.formats = plumbline::ParseCloudFormats(FLAGS_formats);
  job.stop = plumbline::StopSignals();
  return plumbline::RunMapJob(job, [&](const auto& state) { progress.Report(state); });
}

// Says of a map that must not be trusted that it must not.
void Warn(const std::string& which) {
  std::fflush(stdout);
  plumbline::PrintOnStderr(
      plumbline::Coloured("plumbline_map: ", plumbline::Colour::kRed, stderr) + which +
      " was written, but it contradicts the scans it was made from: do not trust it (the "
      "warnings say where and why)");
}

// Prints what came out, and returns the exit code.
int Report(const plumbline::Summary& summary) {
  Print(summary);
  int exit_code = 0;
  if (summary.consistency.verdict == plumbline::Verdict::kContradictory) {
    Warn("the map");
    exit_code = kContradictoryMap;
  }
  for (const plumbline::PartSummary& part : summary.parts) {
    if (part.folder == "." || part.verdict != plumbline::Verdict::kContradictory) continue;
    Warn(part.folder);
    exit_code = kContradictoryMap;
  }
  return exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  int verdict_code = 0;
  const int exit_code = plumbline::RunApp(
      argc,
      argv,
      "estimates the trajectory of a rig and the planes of a building from the scan lines of "
      "2D laser scanners",
      __FILE__,
      {"recording"},
      [&verdict_code] { verdict_code = Report(Map()); },
      "recording");
  return exit_code == 0 ? verdict_code : exit_code;
}
