#include "core/result/closing_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace plumbline {
namespace {

using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;

TEST(ClosingTableTest, StatesFiguresVerdictAndFiles) {
  Summary summary;
  summary.duration_s = 47.73;
  summary.real_time_factor = 13.42;
  summary.residual_rms_m = 0.0221;
  summary.warnings = {"a", "b"};
  std::vector<PlanePatch> planes(3);
  planes[0].type = PlaneType::kHorizontal;
  planes[0].sigma_distance_m = 0.001;
  planes[1].sigma_distance_m = 0.004;
  planes[1].sigma_angle_rad = 0.02 * 3.14159265358979 / 180.0;
  planes[2].type = PlaneType::kCylinder;
  planes[2].curvature = -0.25;
  planes[2].sigma_distance_m = 0.002;
  planes[2].sigma_radius_m = 0.005;
  std::vector<StampedPose> trajectory(3);
  trajectory[1].world_from_body.translation.x() = 3.0;
  trajectory[2].world_from_body.translation = {3.0, 4.0, 0.0};
  const std::string text = ClosingTable(summary, planes, trajectory, "out/map");
  EXPECT_THAT(text, HasSubstr("47.7 s"));
  EXPECT_THAT(text, HasSubstr("13.4 times real time"));
  EXPECT_THAT(text, HasSubstr("7.0 m"));
  EXPECT_THAT(text, HasSubstr("1 horizontal, 1 vertical, 1 cylinder"));
  EXPECT_THAT(text, HasSubstr("2 mm median, 4 mm worst"));
  EXPECT_THAT(text, HasSubstr("0.02 deg median"));
  EXPECT_THAT(text, HasSubstr("radii"));
  EXPECT_THAT(text, HasSubstr("Verdict: consistent, 2 warnings"));
  EXPECT_THAT(text, HasSubstr("Written to out/map: map.* (points)"));
  EXPECT_EQ(text.back(), '\n');
}

TEST(ClosingTableTest, StatesNoDeviationsOfAMapThatIsNotConsistent) {
  std::vector<PlanePatch> planes(1);
  planes[0].sigma_distance_m = 0.00164;
  Summary summary;
  summary.duration_s = 20.0;
  summary.consistency.verdict = Verdict::kDoubtful;
  summary.consistency.doubtful_intervals = {{4.0, 6.0, "it jumps"}};
  summary.cause = Cause{"the rig was lost", "", "it jumps from 4 to 6 s", "move slower"};
  const std::string text = ClosingTable(summary, planes, {}, "out");
  EXPECT_THAT(text, Not(HasSubstr("1.64")));
  EXPECT_THAT(text, HasSubstr("not stated: the map is doubtful"));
  EXPECT_THAT(text, HasSubstr("Likeliest cause: the rig was lost"));
  EXPECT_THAT(text, HasSubstr("move slower\nDoubtful from 4 to 6 s:\n  - it jumps\n"));
  EXPECT_THAT(text, Not(HasSubstr("end to end")));
}

TEST(ClosingTableTest, TheLastLineSaysWhatIsDoubtfulThroughout) {
  Summary summary;
  summary.duration_s = 20.0;
  summary.consistency.verdict = Verdict::kDoubtful;
  summary.consistency.doubtful_intervals = {{0.0, 12.0, "a"}, {3.0, 5.0, "b"}, {11.0, 20.0, "c"}};
  const std::string text = ClosingTable(summary, {}, {}, "out", true);
  EXPECT_THAT(text, HasSubstr("Report: out/report.html\n"));
  EXPECT_THAT(text, EndsWith("doubtful from end to end: check it before it is used\n"));
}

TEST(ClosingTableTest, SaysWhereNothingIsStated) {
  const std::string text = ClosingTable({}, {}, {}, "out");
  EXPECT_THAT(text, HasSubstr("not stated"));
  EXPECT_THAT(text, Not(HasSubstr("radii")));
  EXPECT_THAT(text, Not(HasSubstr("warnings")));
}

}  // namespace
}  // namespace plumbline
