#include "test/benchmark/mapped_walk.h"

#include <glog/logging.h>
#include <stdlib.h>

#include <fstream>
#include <sstream>
#include <vector>

#include "core/estimation/estimation_problem.h"
#include "core/sensor/recording.h"
#include "core/trajectory/motion_noise.h"
#include "simulation/sensing/simulate_recording.h"
#include "test/testing/paths.h"

namespace plumbline {
namespace {

std::filesystem::path MakeDirectory() {
  std::string pattern =
      (std::filesystem::temp_directory_path() / "plumbline_benchmark_XXXXXX").string();
  CHECK(mkdtemp(pattern.data()) != nullptr) << pattern;
  return pattern;
}

// The experiment with another length, its files named by absolute paths.
std::string Shortened(const std::string& experiment, double length_m) {
  const std::string configs = ConfigsDir();
  std::ifstream file(configs + "/experiments/" + experiment + ".yaml");
  CHECK(file) << "no experiment " << experiment;
  std::ostringstream text;
  bool has_length = false;
  for (std::string line; std::getline(file, line);) {
    const bool is_length = line.find("  length_m:") == 0 || line.find("  laps:") == 0;
    const size_t up = line.find(": ../");
    if (is_length) {
      text << "  length_m: " << length_m << "\n";
      has_length = true;
    } else if (up != std::string::npos) {
      text << line.substr(0, up + 2) << configs << line.substr(up + 4) << "\n";
    } else {
      text << line << "\n";
    }
  }
  CHECK(has_length) << experiment << " has no length";
  return text.str();
}

}  // namespace

MappedWalk::MappedWalk(const std::string& experiment, double length_m, FactorKind factor)
    : directory_(MakeDirectory()) {
  FLAGS_minloglevel = google::ERROR;
  const std::string experiment_path = (directory_ / "experiment.yaml").string();
  std::ofstream(experiment_path) << Shortened(experiment, length_m);
  SimulateRecording(experiment_path, 1, directory_.string(), [](double) {});
  rig_ = ReadRig((directory_ / "rig.yaml").string());
  options_.batch.factor = factor;
  RecordingReader reader(recording(), rig_);
  scan_period_s_ = reader.scan_period_s();
  result_ = std::make_unique<MapResult>(std::move(MapRecording(
                                                      rig_, options_, [](double) {}, &reader)
                                                      .front()));
}

MappedWalk::~MappedWalk() {
  std::error_code ignored;  // nothing can be done about what is left
  std::filesystem::remove_all(directory_, ignored);
}

std::unique_ptr<EstimationProblem> MappedWalk::BatchProblem(FactorKind factor,
                                                            MapState* state) const {
  auto problem = std::make_unique<EstimationProblem>(
      rig_, result_->planar, &state->trajectory, &state->landmarks);
  problem->AddTrajectoryTerms(
      options_.trajectory,
      MotionProfile::Uniform(MotionNoise::Of(options_.trajectory), state->trajectory),
      state->origin_time_ns);
  std::vector<const Observation*> associated;
  for (const Observation& observation : state->observations) {
    if (observation.landmark_id < 0) continue;
    if (factor == FactorKind::kPoint) {
      CHECK(!observation.points.empty()) << "mapped without keeping single beams";
      problem->AddPoints(observation);
    } else {
      associated.push_back(&observation);
    }
  }
  problem->AddSegments(associated, 0.0);
  return problem;
}

const MappedWalk& CorridorWalk() {
  static const MappedWalk walk("corridor", 6.0, FactorKind::kSegment);
  return walk;
}

const MappedWalk& OfficeWalk() {
  static const MappedWalk walk("office", 20.0, FactorKind::kSegment);
  return walk;
}

const MappedWalk& WalkWithSinglePoints() {
  static const MappedWalk walk("corridor", 2.0, FactorKind::kPoint);
  return walk;
}

const MappedWalk& WalkByName(const std::string& name) {
  if (name == "office") return OfficeWalk();
  CHECK_EQ(name, "corridor");
  return CorridorWalk();
}

}  // namespace plumbline
