#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/mapping/map_job.h"
#include "core/sensor/scan_line.h"
#include "simulation/evaluation/evaluation.h"
#include "test/testing/temporary_directory.h"

namespace plumbline {

// A scanner of a scenario's rig.
struct ScenarioScanner {
  std::string name;
  std::string translation;   // "x, y, z" in m
  std::string rotation_deg;  // "roll, pitch, yaw"
  int beams = 180;
  double scan_rate_hz = 20.0;
  double range_noise_m = 0.02;
  double max_range_m = 30.0;
  double time_offset_s = 0.0;
};

// A short simulated recording: the texts of the simulator's files.
struct Scenario {
  std::string building;
  std::vector<ScenarioScanner> scanners;
  std::string motion_model = "automatic";  // of the rig
  std::string path;                        // of the experiment, with its speed
  std::string more;                        // of the experiment: motion, noise, ...
  std::string config;                      // of the mapper; empty: defaults
};

// Rooms of which no two walls are alike, and walks through them.
std::string HexagonalRoom();
std::string HexagonWalk(double length_m, double speed_m_s);
std::string TrapezoidRoom();
std::string TrapezoidWalk(double length_m, double speed_m_s);
std::string PillarRoom();
std::string PillarWalk(double length_m, double speed_m_s);

// One horizontal scanner and two that see floor and ceiling, none of them where the paper has
// it.
std::vector<ScenarioScanner> TiltedRig();

// What the simulator gives, before it is spoilt or written.
struct SimulatedRecording {
  Rig rig;
  std::vector<ScanLine> scan_lines;
  std::vector<StampedPose> truth_trajectory;
  std::vector<PlanePatch> truth_planes;
};

// Simulates scenarios and maps them in a directory of its own.
class MappingTest : public TemporaryDirectoryTest {
 protected:
  // Ends the log of a run, which would bury the failures; errors stay.
  void SetUp() override;

  SimulatedRecording Simulate(const Scenario& scenario, uint64_t seed = 1);
  // Writes recording.bag and rig.yaml.
  void WriteRecording(const SimulatedRecording& recording);
  // The job for what WriteRecording() wrote; the result goes to result/.
  MapJob Job(const std::string& config = "", int threads = 1);
  Summary Map(const std::string& config = "", int threads = 1);
  // What Map() wrote held against the truth.
  Evaluation EvaluateResult(const SimulatedRecording& recording);
  // All of these at once, for scenarios without spoilt data.
  Evaluation Run(const Scenario& scenario, uint64_t seed = 1);

  // A case of configs/experiments/robustness, simulated and mapped.
  Evaluation RunCase(const std::string& name, uint64_t seed);

  // The message of the error that mapping ends with; fails unless it is one line and no file
  // is left in the result directory.
  std::string MapError();

  std::string Path(const std::string& name) const { return (directory_ / name).string(); }

  Summary summary_;  // of the last Map()
};

// The planes are the true ones, each where the result says it is, to within what its own
// standard deviations allow.
void ExpectTruePlanes(const Evaluation& evaluation);

// Standard deviations of a pose as the noise of the ranges lets expect.
struct PoseStddevs {
  double position_m = 0.0;
  double rotation_deg = 0.0;
};

// The points of one knot interval measure its six unknowns. scan_rate_hz: of the fastest
// scanner; range_noise_m: of the noisiest.
PoseStddevs ExpectedPoseStddevs(double scan_rate_hz,
                                double range_noise_m,
                                const Summary& summary);

// The aligned trajectory's errors are no larger than the ranges' noise lets expect.
void ExpectPreciseTrajectory(const Evaluation& evaluation,
                             const Scenario& scenario,
                             const Summary& summary);

}  // namespace plumbline
