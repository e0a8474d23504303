#include "core/result/result_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

namespace plumbline {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(FormatTrajectoryTest, IsExactInTimeAndHasPositiveQw) {
  std::vector<StampedPose> poses(2);
  poses[0].time_ns = 1'600'000'000'123'456'789;
  poses[0].world_from_body.translation = {1.0, -2.5, 0.125};
  poses[0].world_from_body.rotation = Eigen::Quaterniond(-0.5, 0.5, 0.5, 0.5);
  poses[1].time_ns = -1;
  EXPECT_EQ(FormatTrajectory(poses),
            "1600000000.123456789 1.000000000 -2.500000000 0.125000000 "
            "-0.500000000000 -0.500000000000 -0.500000000000 0.500000000000\n"
            "-0.000000001 0.000000000 0.000000000 0.000000000 "
            "0.000000000000 0.000000000000 0.000000000000 1.000000000000\n");
}

TEST(FormatPlanesTest, HasTheAgreedKeys) {
  PlanePatch plane;
  plane.id = 7;
  plane.sigma_angle_rad = M_PI / 180.0;
  plane.sigma_distance_m = std::numeric_limits<double>::quiet_NaN();
  plane.outline = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}};
  plane.first_time_ns = 1'600'000'000'123'456'789;
  const std::string text = FormatPlanes({plane});
  EXPECT_THAT(text, HasSubstr("\"first_time\": 1600000000.123456789,"));
  EXPECT_EQ(text.back(), '\n');
  const nlohmann::ordered_json json = nlohmann::ordered_json::parse(text);
  ASSERT_EQ(json.size(), 1u);
  std::vector<std::string> keys;
  for (const auto& [key, value] : json[0].items()) keys.push_back(key);
  EXPECT_THAT(keys,
              ElementsAre("id",
                          "type",
                          "normal",
                          "distance",
                          "sigma_angle_deg",
                          "sigma_distance_m",
                          "centre",
                          "outline",
                          "num_points",
                          "num_segments",
                          "first_time",
                          "last_time"));
  EXPECT_EQ(json[0]["type"], "vertical");
  EXPECT_EQ(json[0]["sigma_angle_deg"], 1.0);
  EXPECT_TRUE(json[0]["sigma_distance_m"].is_null());
  EXPECT_EQ(json[0]["outline"][2], nlohmann::ordered_json({1.0, 1.0, 0.0}));
}

TEST(FormatTrajectoryCovarianceTest, WritesTheUpperTriangle) {
  StampedCovariance pose;
  pose.time_ns = 1'600'000'000'123'456'789;
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) pose.covariance(i, j) = 10 * std::min(i, j) + std::max(i, j);
  }
  const std::string text = FormatTrajectoryCovariance({pose});
  EXPECT_THAT(text, HasSubstr("t,px_px,px_py,px_pz,px_rx,px_ry,px_rz,py_py,"));
  EXPECT_THAT(text, HasSubstr(",rz_rz\n1600000000.123456789,0.000000e+00,1.000000e+00,"));
  EXPECT_THAT(text, HasSubstr(",4.500000e+01,5.500000e+01\n"));
  EXPECT_EQ(std::count(text.begin(), text.end(), ','), 2 * 21);
}

TEST(FormatPlanesTest, NoPlanesAreAnEmptyArray) {
  EXPECT_TRUE(nlohmann::json::parse(FormatPlanes({})).empty());
}

TEST(FormatPlanePolygonsTest, CountsCornersAndTriangles) {
  PlanePatch quad;
  quad.outline = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  PlanePatch unseen;
  unseen.id = 1;
  PlanePatch triangle;
  triangle.id = 2;
  triangle.outline = {{0, 0, 1}, {1, 0, 1}, {1, 1.5, 1}};
  const std::string text = FormatPlanePolygons({quad, unseen, triangle});
  EXPECT_THAT(text, HasSubstr("element vertex 7\n"));
  EXPECT_THAT(text, HasSubstr("element face 3\n"));
  EXPECT_THAT(text, HasSubstr("end_header\n0 0 0 255 64 64\n"));
  EXPECT_THAT(text, HasSubstr("\n1 1.5 1 "));
  EXPECT_THAT(text, HasSubstr("\n3 0 1 2 255 64 64 0\n3 0 2 3 255 64 64 0\n3 4 5 6 "));
}

TEST(FormatSummaryTest, StatesTheVerdict) {
  Summary summary;
  summary.consistency.verdict = Verdict::kDoubtful;
  summary.consistency.contradicted_share = 0.125;
  summary.consistency.doubtful_intervals = {{3.0, 5.0, "walls are doubled"}};
  summary.consistency.degenerate_intervals = {{1.0, 2.0, "vertical", 0.5}};
  const auto json = nlohmann::ordered_json::parse(FormatSummary(summary))["consistency"];
  EXPECT_EQ(json.dump(),
            "{\"verdict\":\"doubtful\",\"contradicted_share\":0.125,"
            "\"doubtful_intervals\":[{\"start_s\":3.0,\"end_s\":5.0,"
            "\"reason\":\"walls are doubled\"}],"
            "\"symptoms\":[{\"start_s\":3.0,\"end_s\":5.0,\"what\":[\"walls are doubled\"]}],"
            "\"degenerate_intervals\":[{\"start_s\":1.0,\"end_s\":2.0,"
            "\"direction\":\"vertical\",\"stddev_m\":0.5}]}");
  summary.consistency.ends_at_s = 7.5;
  EXPECT_EQ(nlohmann::ordered_json::parse(FormatSummary(summary))["consistency"]["ends_at_s"],
            7.5);
}

TEST(FormatSummaryTest, HasTheAgreedKeys) {
  Summary summary;
  summary.start_time_ns = 1'700'000'000'123'456'789;
  summary.scanners = {"top", "left"};
  summary.scans = 3;
  summary.points = int64_t{1} << 40;
  summary.residual_rms_m = 0.0217;
  summary.stages = {{"read", 0.5}, {"batch", 2.0}, {"read", 0.25}};
  summary.largest_correlations = {{"this with that", -0.5}};
  summary.motion = "planar";
  summary.motion_noise = {{"horizontal_m_s2", 0.5}, {"angular_deg_s2", 50.0}};
  summary.range_noise = {{"top", 0.03, 0.02, {{2.0, 4.0, 0.01}}, {}}};
  summary.reference_plane_id = 4;
  summary.warnings = {"a \"quoted\" name", "not UTF-8: \xff"};
  const std::string text = FormatSummary(summary);
  EXPECT_EQ(text.back(), '\n');
  EXPECT_THAT(text, HasSubstr("\"start_time\": 1700000000.123456789,\n"));
  const nlohmann::ordered_json json = nlohmann::ordered_json::parse(text);
  std::vector<std::string> keys;
  for (const auto& [key, value] : json.items()) keys.push_back(key);
  EXPECT_THAT(keys,
              ElementsAre("start_time",
                          "scanners",
                          "scans",
                          "points",
                          "points_used",
                          "points_moving",
                          "segments",
                          "planes",
                          "control_points",
                          "residual_rms_m",
                          "variance_factor",
                          "duration_s",
                          "stages",
                          "real_time_factor",
                          "peak_memory_mb",
                          "largest_correlations",
                          "weakest_directions",
                          "motion",
                          "motion_noise",
                          "range_noise",
                          "reference_plane_id",
                          "consistency",
                          "warnings"));
  EXPECT_EQ(json["scanners"].dump(), "[\"top\",\"left\"]");
  EXPECT_EQ(json["points"], int64_t{1} << 40);
  EXPECT_EQ(json["residual_rms_m"], 0.0217);
  EXPECT_EQ(json["stages"].dump(), "{\"read\":0.75,\"batch\":2.0}");
  EXPECT_EQ(json["motion"], "planar");
  EXPECT_EQ(
      json["range_noise"].dump(),
      "[{\"scanner\":\"top\",\"stated_m\":0.03,\"noise_m\":0.02,\"by_range_m\":[{\"from\":2.0,"
      "\"to\":4.0,\"noise_m\":0.01}],\"by_incidence_deg\":[]}]");
  EXPECT_EQ(json["motion_noise"].dump(), "{\"horizontal_m_s2\":0.5,\"angular_deg_s2\":50.0}");
  EXPECT_EQ(json["warnings"][0], "a \"quoted\" name");
  EXPECT_EQ(json["warnings"].size(), 2u);
}

TEST(FormatSummaryTest, SaysWhatWheelsCountWhereTheyDo) {
  Summary summary;
  summary.odometry = OdometrySummary{0.5, 0.25, 1.5, 0.125, 0.0625, 2.0, 9};
  const auto json = nlohmann::ordered_json::parse(FormatSummary(summary));
  EXPECT_EQ(json["odometry"].dump(),
            "{\"length_scale\":0.5,\"length_scale_stddev\":0.25,\"turn_scale\":1.5,"
            "\"turn_scale_stddev\":0.125,\"length_noise\":0.0625,\"turn_noise\":2.0,"
            "\"motions\":9}");
}

}  // namespace
}  // namespace plumbline
