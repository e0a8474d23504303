// People walk ahead of the rig and around it in a corridor: for seconds, what shows how far
// the rig has gone is them. One hypothesis follows them, the other keeps the rig's pace.

#include <gtest/gtest.h>

#include <string>

#include "simulation/evaluation/evaluation.h"
#include "simulation/sensing/simulate_recording.h"
#include "test/testing/paths.h"
#include "test/testing/scenario.h"

namespace plumbline {
namespace {

class HypothesesTest : public MappingTest {};

// Without a second hypothesis the rig is lost here.
TEST_F(HypothesesTest, TheRigDoesNotFollowPeople) {
  constexpr uint64_t kSeed = 114;
  SimulateRecording(ConfigsDir() + "/experiments/robustness/people_and_doors.yaml",
                    kSeed,
                    directory_.string(),
                    [](double) {});
  Map();
  const Evaluation evaluation =
      Evaluate(ReadEvaluationInput(Path("result"), directory_.string()), {});
  EXPECT_LT(evaluation.trajectory.aligned.position_m.rmse, 0.02);
  EXPECT_EQ(summary_.consistency.verdict, Verdict::kConsistent);
}

}  // namespace
}  // namespace plumbline
