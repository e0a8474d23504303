// Buildings whose walls bend.

#include <gtest/gtest.h>

#include <cstdint>
#include <string>

#include "core/result/result_reader.h"
#include "simulation/evaluation/evaluation.h"
#include "simulation/sensing/simulate_recording.h"
#include "test/testing/scenario.h"

namespace plumbline {
namespace {

class CurvesTest : public MappingTest {
 protected:
  Evaluation MapCase(const std::string& name, uint64_t seed) {
    SimulateRecording(
        std::string(PLUMBLINE_CONFIGS_DIR) + "/experiments/robustness/" + name + ".yaml",
        seed,
        directory_.string(),
        [](double) {});
    Map();
    return Evaluate(ReadEvaluationInput(Path("result"), directory_.string()), {});
  }

  int NumCylinders() {
    int num_cylinders = 0;
    for (const PlanePatch& plane : ReadPlanes(Path("result/planes.json"))) {
      if (plane.type == PlaneType::kCylinder) ++num_cylinders;
    }
    return num_cylinders;
  }
};

TEST_F(CurvesTest, ACurvedCorridorIsTwoCylinders) {
  const Evaluation evaluation = MapCase("curved_corridor", 5);
  EXPECT_EQ(summary_.consistency.verdict, Verdict::kConsistent);
  EXPECT_LT(evaluation.trajectory.aligned.position_m.rmse, 0.004);
  EXPECT_EQ(NumCylinders(), 2);
  EXPECT_EQ(evaluation.planes.num_wrong, 0);
  EXPECT_GT(evaluation.planes.completeness, 0.95);
  EXPECT_LT(evaluation.planes.radius_max_percent, 1.0);
  for (const PlaneMatch& match : evaluation.planes.list) {
    if (!match.radius_error_m) continue;
    EXPECT_LT(std::abs(*match.radius_error_m), 4.0 * match.sigma_radius_m);
  }
}

// Its heading hangs on two pillars while the door is out of sight.
TEST_F(CurvesTest, ARoundRoomIsOneCylinder) {
  const Evaluation evaluation = MapCase("round_room", 6);
  EXPECT_EQ(summary_.consistency.verdict, Verdict::kConsistent);
  EXPECT_LT(evaluation.trajectory.aligned.position_m.rmse, 0.004);
  EXPECT_EQ(NumCylinders(), 1);
  EXPECT_LT(evaluation.planes.radius_max_m, 0.01);
}

}  // namespace
}  // namespace plumbline
