// Calibrates a rig from one or several recordings.

#include <gflags/gflags.h>

#include <cstdio>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "apps/app.h"
#include "apps/progress.h"
#include "apps/terminal.h"
#include "apps/version.h"
#include "core/batch/calibration_joining.h"
#include "core/mapping/map_job.h"
#include "core/result/calibration_text.h"
#include "core/result/result_files.h"
#include "core/result/result_reader.h"
#include "core/sensor/rig.h"
#include "core/util/atomic_file.h"
#include "core/util/error.h"

DEFINE_string(recordings,
              "",
              "recordings of one rig, as plumbline_map takes them, or directories that it has "
              "written with this rig file, which are not mapped again; may also stand alone, "
              "without the flag, one after the other");
DEFINE_string(rig, "", "rig file (YAML), whose `uncertainty` says what is to be estimated");
DEFINE_string(config, "", "mapper settings (YAML)");
DEFINE_int32(threads, 0, "number of threads; 0: as many as there are cores");
DEFINE_validator(threads, [](const char*, int32_t threads) { return threads >= 0; });
DEFINE_string(output,
              "",
              "directory for rig_calibrated.yaml, calibration.json and the maps of the "
              "recordings, map_1, map_2, ...");

namespace {

namespace fs = std::filesystem;

std::vector<std::string> Lines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    if (!line.empty()) lines.push_back(line);
  }
  return lines;
}

// A map that must not be trusted says nothing of the rig.
void RequireTrusted(const std::string& recording, const std::string& verdict) {
  if (verdict != plumbline::VerdictName(plumbline::Verdict::kContradictory)) return;
  throw plumbline::Error(recording +
                         ": its map contradicts its scans and is of no use for a " +
                         "calibration: leave it out");
}

void Map(const std::string& recording, const std::string& output) {
  plumbline::Progress progress("map");
  plumbline::MapJob job;
  job.recording = recording;
  job.rig = FLAGS_rig;
  job.config = FLAGS_config;
  job.output = output;
  job.version = plumbline::Version();
  job.threads = FLAGS_threads;
  job.stop = plumbline::StopSignals();
  const plumbline::Summary summary =
      plumbline::RunMapJob(job, [&](const auto& state) { progress.Report(state); });
  const std::string verdict = plumbline::VerdictName(summary.consistency.verdict);
  std::printf("%s: %s\n", recording.c_str(), verdict.c_str());
  RequireTrusted(recording, verdict);
}

void Calibrate() {
  const plumbline::Rig rig = plumbline::ReadRig(FLAGS_rig);
  std::vector<std::string> files;
  int num_mapped = 0;
  for (const std::string& name : Lines(FLAGS_recordings)) {
    const std::string file = (fs::path(name) / "calibration.json").string();
    if (fs::exists(file)) {
      RequireTrusted(
          name, plumbline::ReadMapOrigin((fs::path(name) / "summary.json").string()).verdict);
      files.push_back(file);
      continue;
    }
    const fs::path map = fs::path(FLAGS_output) / ("map_" + std::to_string(++num_mapped));
    fs::create_directories(FLAGS_output);
    Map(name, map.string());
    files.push_back((map / "calibration.json").string());
    if (!fs::exists(files.back())) {
      throw plumbline::Error(FLAGS_rig +
                             ": knows everything exactly (uncertainty): there is nothing to "
                             "calibrate");
    }
  }
  std::vector<plumbline::Calibration> calibrations;
  for (const std::string& file : files) {
    calibrations.push_back(plumbline::ReadCalibration(file));
    if (calibrations.back().scanners.empty()) {
      throw plumbline::Error(file + ": its rig knows all scanners exactly: there is nothing " +
                             "to calibrate");
    }
  }
  const plumbline::Calibration joined = plumbline::JoinCalibrations(calibrations, files);
  const plumbline::Rig calibrated = plumbline::WithCalibration(rig, joined);
  fs::create_directories(FLAGS_output);
  const fs::path output = FLAGS_output;
  plumbline::WriteFileAtomically((output / "calibration.json").string(),
                                 plumbline::FormatCalibration(joined));
  plumbline::WriteRig(calibrated, (output / plumbline::kRigCalibrated).string());
  std::printf(
      "%s\nWritten to %s: %s, calibration.json\nNext: plumbline_map RECORDING --rig=%s\n",
      plumbline::CalibrationLine(joined).c_str(),
      FLAGS_output.c_str(),
      plumbline::kRigCalibrated,
      (output / plumbline::kRigCalibrated).c_str());
}

}  // namespace

int main(int argc, char** argv) {
  return plumbline::RunApp(
      argc,
      argv,
      "finds poses, clocks and range biases of a rig's scanners from recordings of walks",
      __FILE__,
      {"recordings", "rig", "output"},
      Calibrate,
      "recordings...");
}
