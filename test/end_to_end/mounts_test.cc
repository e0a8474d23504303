// Rigs with scanners on mounts.

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "simulation/evaluation/evaluation.h"
#include "test/testing/scenario.h"

namespace plumbline {
namespace {

class MountsTest : public MappingTest {
 protected:
  nlohmann::json Json(const std::string& name) const {
    return nlohmann::json::parse(std::ifstream(Path(name)));
  }

  // The parameter of the scanner on a mount is found: within its sigmas, which are well below
  // what the rig file states, and within a limit.
  void ExpectFound(const std::string& name, double limit) const {
    const nlohmann::json truth = Json("truth_mounts.json")["scanners"][0];
    const nlohmann::json found = Json("result/calibration.json")["scanners"];
    for (const auto& scanner : found) {
      if (scanner["name"] != truth["name"]) continue;
      for (const auto& parameter : scanner["parameters"]) {
        if (parameter["name"] != name) continue;
        const double sigma = parameter["sigma"];
        const double off = parameter["value"].get<double>() - truth[name].get<double>();
        EXPECT_LT(std::abs(off), 4.0 * sigma) << name;
        EXPECT_LT(std::abs(off), limit) << name;
        EXPECT_LT(sigma, 0.5 * parameter["prior_sigma"].get<double>()) << name;
        return;
      }
    }
    ADD_FAILURE() << "no " << name;
  }
};

TEST_F(MountsTest, ANoddingScannerAndItsMountAreFoundWithTheMap) {
  const Evaluation evaluation = RunCase("../mounts/nodding_corner", 5);
  EXPECT_EQ(summary_.consistency.verdict, Verdict::kConsistent);
  EXPECT_LT(evaluation.trajectory.aligned.position_m.max, 0.03);
  EXPECT_LT(evaluation.trajectory.aligned.rotation_deg.max, 0.2);
  ExpectFound("mount_zero_deg", 0.05);
  ExpectFound("mount_time_s", 2e-4);
}

TEST_F(MountsTest, ASpinningScannerWhoseAngleNobodyReadsIsFoundWithTheMap) {
  const Evaluation evaluation = RunCase("../mounts/spinning_room", 5);
  EXPECT_EQ(summary_.consistency.verdict, Verdict::kConsistent);
  EXPECT_LT(evaluation.trajectory.aligned.position_m.max, 0.03);
  EXPECT_LT(evaluation.trajectory.aligned.rotation_deg.rmse, 0.3);
  ExpectFound("mount_zero_deg", 0.1);
  ExpectFound("mount_rate", 1e-4);
}

}  // namespace
}  // namespace plumbline
