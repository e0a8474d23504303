#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "core/result/result_types.h"
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

// Reads the experiment, simulates it and writes recording.bag, rig.yaml, truth_trajectory.tum
// and truth_planes.json into output_directory, which is created where it is missing. Each file
// appears whole or not at all. progress is called with the share that is done, 0 to 1, after
// every scan line. Throws Error for a bad experiment or a file that can not be written.
void SimulateRecording(const std::string& experiment_path,
                       uint64_t seed,
                       const std::string& output_directory,
                       const std::function<void(double)>& progress);

}  // namespace plumbline
