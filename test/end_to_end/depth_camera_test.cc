// Depth cameras, whose rows are taken as scan lines.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "simulation/sensing/simulate_recording.h"
#include "test/testing/paths.h"
#include "test/testing/scenario.h"

namespace plumbline {
namespace {

const std::string kConfigs = ConfigsDir();

class DepthCameraTest : public MappingTest {
 protected:
  // Simulates and maps an experiment of configs/experiments/depth with another length of its
  // walk.
  Evaluation RunPart(const std::string& name, const std::string& laps, uint64_t seed) {
    std::ostringstream text;
    text << std::ifstream(kConfigs + "/experiments/depth/" + name + ".yaml").rdbuf();
    std::string experiment = text.str();
    for (const auto& [from, to] : {std::make_pair(std::string("../.."), kConfigs),
                                   {"../..", kConfigs},
                                   {"laps: 1.15", "laps: " + laps}}) {
      experiment.replace(experiment.find(from), from.size(), to);
    }
    std::ofstream(Path("experiment.yaml")) << experiment;
    SimulateRecording(
        Path("experiment.yaml"), seed, directory_.string(), [](const ProgressState&) {});
    Map();
    return Evaluate(ReadEvaluationInput(Path("result"), directory_.string()), {});
  }
};

TEST_F(DepthCameraTest, TwoCamerasMapARoomWithinTheirReach) {
  const Evaluation evaluation = RunPart("room_two", "0.4", 5);
  EXPECT_EQ(summary_.consistency.verdict, Verdict::kConsistent);
  EXPECT_LT(evaluation.trajectory.aligned.position_m.max, 0.01);
  EXPECT_LT(evaluation.trajectory.aligned.rotation_deg.max, 0.1);
  EXPECT_EQ(evaluation.planes.num_wrong, 0);
}

// A single camera sees one wall at times, along which it may slip.
TEST_F(DepthCameraTest, ThatOneCameraLeavesADirectionOpenIsSaid) {
  RunPart("room", "1.15", 44);
  EXPECT_THAT(
      summary_.warnings,
      testing::Contains(testing::HasSubstr("leave one direction of the position open")));
}

}  // namespace
}  // namespace plumbline
