#pragma once

#include <cstdint>
#include <string>

#include "core/result/result_types.h"
#include "core/util/progress.h"
#include "simulation/sensing/simulator.h"

namespace plumbline {

// TruthPlanes counts, for every face, the beams that hit it and have a return.
class TruthPlanes {
 public:
  explicit TruthPlanes(const Building& building);

  // Counts the beams of one scan line. recorded: the same line with noise. time_offset_s: from
  // the stamps to the true instants.
  void Add(const PerfectScanLine& perfect, const ScanLine& recorded, double time_offset_s);

  // Returns the faces that were hit, with the ids that they have in the building and the
  // normals to the side from which most beams came: not all meshes know their outside.
  std::vector<PlanePatch> Patches() const;

 private:
  std::vector<PlanePatch> patches_;
  std::vector<int64_t> num_from_behind_;
};

// Samples world_from_body every 5 ms, from the first to the last instant of the path.
std::vector<StampedPose> TruthTrajectory(const Path& path);

// Figures of a simulated recording.
struct SimulationSummary {
  double duration_s = 0.0;
  double path_length_m = 0.0;
  int num_scanners = 0;
  int64_t num_scan_lines = 0;  // that were recorded
  int64_t num_beams = 0;       // of these
  int num_faces = 0;           // that beams hit
};

// Prints the summary as a table for people, with what lies in the directory; ends with a line
// break.
std::string SimulationTable(const SimulationSummary& summary,
                            const std::string& output_directory);

// Reads the experiment, simulates it and writes recording.bag, rig.yaml, truth_trajectory.tum
// and truth_planes.json, truth_imu.json where the rig has an IMU and truth_mounts.json where
// scanners are on mounts, into output_directory, which is created where it is missing. Each
// file appears whole or not at all. progress is called after every scan line. Throws Error for
// a bad experiment or a file that can not be written.
SimulationSummary SimulateRecording(const std::string& experiment_path,
                                    uint64_t seed,
                                    const std::string& output_directory,
                                    const ProgressCallback& progress);

}  // namespace plumbline
