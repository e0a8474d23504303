// Walls that step by less than the noise of a range.

#include <gtest/gtest.h>

#include "test/testing/scenario.h"

namespace plumbline {
namespace {

class LevelsTest : public MappingTest {};

// One plane through both levels would be 0.4 degrees off.
TEST_F(LevelsTest, AWallThatStepsByThreeCentimetresIsTwoPlanes) {
  Scenario scenario;
  scenario.building =
      "floor_height_m: 0.0\nceiling_height_m: 2.6\noutlines:\n"
      "  - corners: [[0, 0], [6, 0], [6, 5], [3.5, 5], [3.5, 5.03], [0, 5.03]]\n";
  scenario.scanners = TiltedRig();
  for (ScenarioScanner& scanner : scenario.scanners) {
    scanner.beams = 540;
    scanner.scan_rate_hz = 40.0;
    scanner.range_noise_m = 0.03;
  }
  scenario.path =
      "path:\n  way_points: [[1.5, 1.2], [4.6, 1.3], [4.7, 3.4], [1.4, 3.6]]\n"
      "  closed: true\n  laps: 1.15\n  corner_radius_m: 0.5\n  body_height_m: 1.3\n"
      "speed_m_s: 0.9\n";
  for (const uint64_t seed : {1, 2}) {
    const Evaluation evaluation = Run(scenario, seed);
    ExpectTruePlanes(evaluation);
    EXPECT_EQ(evaluation.planes.num_matched, 7);
  }
}

}  // namespace
}  // namespace plumbline
