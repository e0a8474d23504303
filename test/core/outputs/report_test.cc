#include "core/outputs/report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "core/result/plane_covariance.h"
#include "core/result/result_directory.h"
#include "core/result/result_writer.h"
#include "test/testing/temporary_directory.h"

namespace plumbline {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

class ReportTest : public TemporaryDirectoryTest {
 protected:
  void SetUp() override {
    TemporaryDirectoryTest::SetUp();
    job_.result_directory = (directory_ / "result").string();
    job_.output = (directory_ / "report.html").string();
    job_.title = "a <b> & \"c\"";
    WriteResult(2000);
  }

  // A wall and a floor that the rig sees for 10 s.
  void WriteResult(int num_points) {
    PlanePatch wall;
    wall.id = 4;
    wall.normal = {1.0, 0.0, 0.0};
    wall.distance = -2.0;
    wall.centre = {-2.0, 0.0, 0.0};
    wall.outline = {
        {-2.0, -1.0, -1.0}, {-2.0, 1.0, -1.0}, {-2.0, 1.0, 1.0}, {-2.0, -1.0, 1.0}};
    wall.num_points = num_points / 2;
    wall.last_time_ns = kStartNs + 9'990'000'000;
    PlanePatch floor = wall;
    floor.id = 7;
    floor.type = PlaneType::kHorizontal;
    floor.normal = {0.0, 0.0, 1.0};
    const std::vector<PlanePatch> planes = {wall, floor};
    ResultDirectory result(job_.result_directory);
    ResultWriter writer(result);
    StampedPose last;
    last.time_ns = kStartNs + 10'000'000'000;
    StampedPose first;
    first.time_ns = kStartNs;
    writer.WriteTrajectory({first, last});
    writer.WritePlanes(planes);
    writer.WriteTrajectoryCovariance(std::vector<StampedCovariance>(2));
    writer.WritePlaneCovariance({planes, Eigen::MatrixXd::Identity(3, 3)});
    writer.WriteLoopClosures({});
    PointBuffer points;
    for (int i = 0; i < num_points; ++i) points.Add(MakePoint(i, num_points));
    writer.AddMapPoints(points);
    Summary summary;
    summary.start_time_ns = kStartNs;
    summary.warnings = {"</script> is no end"};
    writer.WriteSummary(summary);
    writer.WriteConfig("a: 1\n");
    writer.Finish();
    result.Commit();
  }

  static MapPoint MakePoint(int i, int num_points) {
    MapPoint point;
    point.p_world = {-2.0f, static_cast<float>(std::sin(1000.0 * i * i)), 0.0f};
    point.time_s = 9.99 * i / (num_points - 1);
    point.scanner = i % 2;
    point.plane_id = i % 2 == 0 ? -1 : 4;
    point.residual_m = 0.0105f;
    return point;
  }

  std::string Result(const char* name) const { return job_.result_directory + "/" + name; }
  std::string Fault() const {
    return ErrorOf([this] { WriteReport(job_); });
  }

  // The text in the element of that id.
  static std::string Element(const std::string& html, const std::string& id) {
    const size_t at = html.find("id=\"" + id + "\">");
    if (at == std::string::npos) return "";
    const size_t begin = html.find('>', at) + 1;
    return html.substr(begin, html.find("</script>", begin) - begin);
  }

  static constexpr int64_t kStartNs = 1'700'000'000'123'456'789;
  ReportJob job_;
};

TEST_F(ReportTest, HoldsTheResultAndThePage) {
  const ReportSize size = WriteReport(job_);
  const std::string html = ReadBytes(job_.output);
  EXPECT_EQ(size.points, 2000);
  EXPECT_EQ(size.bytes, static_cast<int64_t>(html.size()));
  EXPECT_THAT(html, StartsWith("<!DOCTYPE html>"));
  EXPECT_THAT(html, HasSubstr("<title>a &lt;b&gt; &amp; &quot;c&quot;</title>"));
  EXPECT_THAT(html, HasSubstr("three.js authors"));
  EXPECT_THAT(html, Not(HasSubstr("</script> is no end")));
  const auto report = nlohmann::json::parse(Element(html, "report"));
  EXPECT_EQ(report["title"], job_.title);
  EXPECT_EQ(report["summary"]["warnings"][0], "</script> is no end");
  EXPECT_EQ(report["planes"][0]["id"], 4);
  EXPECT_EQ(report["covariance_plane_ids"], nlohmann::json({4, 7}));
  EXPECT_NEAR(report["start_s"].get<double>(), 1'700'000'000.123456, 1e-5);
  EXPECT_TRUE(report["evaluation"].is_null());
  EXPECT_EQ(nlohmann::json::parse(Element(html, "points"))["count"], 2000);
  for (const char* section : {"poses", "covariance", "points-x-0", "points-scanner-0"}) {
    EXPECT_NE(Element(html, section), "") << section;
  }
}

TEST_F(ReportTest, StatisticsAreOfAllPoints) {
  job_.max_points = 100;
  EXPECT_EQ(WriteReport(job_).points, 100);
  const auto report = nlohmann::json::parse(Element(ReadBytes(job_.output), "report"));
  const auto& statistics = report["statistics"];
  EXPECT_EQ(statistics["points"], 2000);
  EXPECT_EQ(statistics["histogram"][250 + 10], 1000);
  EXPECT_EQ(statistics["by_second"].size(), 10u);
  EXPECT_EQ(statistics["by_scanner"][0][1], 0);
  EXPECT_EQ(statistics["by_scanner"][1][1], 1000);
  EXPECT_NEAR(statistics["by_scanner"][1][2].get<double>(), 0.0105, 1e-8);
}

TEST_F(ReportTest, LeavesOutPointsUntilTheFileIsSmall) {
  const ReportSize all = WriteReport(job_);
  job_.max_bytes = all.bytes - 1000;
  const ReportSize fewer = WriteReport(job_);
  EXPECT_LE(fewer.bytes, job_.max_bytes);
  EXPECT_LT(fewer.points, all.points);
  EXPECT_GT(fewer.points, all.points / 4);
  job_.max_bytes = 1000;
  EXPECT_THAT(Fault(), HasSubstr(job_.output + ": without any points"));
}

TEST_F(ReportTest, TheSameResultGivesTheSameBytes) {
  WriteReport(job_);
  const std::string first = ReadBytes(job_.output);
  WriteReport(job_);
  EXPECT_TRUE(first == ReadBytes(job_.output));
}

TEST_F(ReportTest, TakesInFloorPlansAndErrors) {
  WriteBytes(Result("floor_plan.svg"), "<svg/>");
  WriteBytes(Result("floor_plan_2.svg"), "<svg/>");
  WriteBytes(Result("floor_plan_4.svg"), "<svg/>");
  job_.evaluation = (directory_ / "evaluation.json").string();
  WriteBytes(job_.evaluation, "{\"planes\": {\"matched\": 2}}");
  WriteReport(job_);
  const std::string html = ReadBytes(job_.output);
  const auto report = nlohmann::json::parse(Element(html, "report"));
  EXPECT_EQ(report["floor_plans"], 2);
  EXPECT_NE(Element(html, "floor-plan-2"), "");
  EXPECT_EQ(Element(html, "floor-plan-4"), "");
  EXPECT_EQ(report["evaluation"]["planes"]["matched"], 2);
}

TEST_F(ReportTest, TakesInTheCalibrationWhereThereIsOne) {
  const auto calibration = [this] {
    WriteReport(job_);
    return nlohmann::json::parse(Element(ReadBytes(job_.output), "report"))["calibration"];
  };
  EXPECT_TRUE(calibration().is_null());
  WriteBytes(Result("calibration.json"), R"({"scanners": [], "unobserved": ["height"]})");
  EXPECT_EQ(calibration()["unobserved"][0], "height");
  WriteBytes(Result("calibration.json"), "{");
  EXPECT_THAT(Fault(), HasSubstr("calibration.json: byte "));
}

TEST_F(ReportTest, NamesWhatIsMissingOrBroken) {
  job_.evaluation = (directory_ / "none.json").string();
  EXPECT_THAT(Fault(), HasSubstr(job_.evaluation + ": can not be read"));
  job_.evaluation.clear();
  WriteBytes(Result("trajectory_covariance.csv"), "t\n1,2,3\n4,5,6\n");
  EXPECT_THAT(Fault(), HasSubstr("trajectory_covariance.csv:2: not a time and 21 numbers"));
  WriteBytes(Result("trajectory_covariance.csv"), "t\n");
  EXPECT_THAT(Fault(), HasSubstr("trajectory_covariance.csv: has 0 poses"));
  WriteResult(10);
  WriteBytes(Result("planes.json"), "[]");
  EXPECT_THAT(Fault(), HasSubstr("map.ply: point 1 lies on plane 4, which planes.json lacks"));
  WriteBytes(Result("summary.json"), "{\"scans\": }");
  EXPECT_THAT(Fault(), HasSubstr("summary.json: byte 11: is not valid JSON"));
  WriteBytes(Result("summary.json"), "[]");
  EXPECT_THAT(Fault(), HasSubstr("summary.json: is not an object"));
  WriteBytes(Result("summary.json"), "{}");
  EXPECT_THAT(Fault(), HasSubstr("summary.json: has no 'start_time'"));
  EXPECT_FALSE(std::filesystem::exists(job_.output));
}

TEST_F(ReportTest, NestedJsonIsAnErrorAndNoCrash) {
  const std::string nested = std::string(200'000, '[') + std::string(200'000, ']');
  for (const char* name : {"summary.json", "planes.json", "loop_closures.json"}) {
    WriteResult(10);
    WriteBytes(Result(name), nested);
    EXPECT_THAT(Fault(), HasSubstr(Result(name) + ": its arrays and objects are nested more"));
  }
}

TEST_F(ReportTest, PointsOutsideTheTrajectoryAreAnError) {
  for (const double time_s : {1e9, 12.0, -3.0}) {
    WriteResult(10);
    std::string map = ReadBytes(Result("map.ply"));
    const size_t first = map.find("end_header\n") + 11;
    std::memcpy(&map[first + 12], &time_s, sizeof(time_s));
    WriteBytes(Result("map.ply"), map);
    EXPECT_THAT(Fault(), HasSubstr("map.ply: point 0 was taken at "));
  }
  WriteResult(10);
  WriteBytes(Result("trajectory.tum"),
             "1700000000.123456789 0 0 0 0 0 0 1\n9100000000.123456789 0 0 0 0 0 0 1\n");
  EXPECT_THAT(Fault(), HasSubstr("trajectory.tum: has a pose 7400000000.000 s after"));
}

TEST_F(ReportTest, LoadsNothingFromAnywhere) {
  WriteReport(job_);
  EXPECT_THAT(ReadBytes(job_.output),
              HasSubstr("<meta http-equiv=\"Content-Security-Policy\" content=\"default-src "
                        "'none'; script-src 'unsafe-inline'; "));
}

TEST_F(ReportTest, NamesReportsOfPartsWhereItStandsBesideThem) {
  WriteReport(job_);
  const auto names_parts = [this] {
    return nlohmann::json::parse(Element(ReadBytes(job_.output), "report"))["part_reports"];
  };
  EXPECT_EQ(names_parts(), false);
  job_.output = Result("report.html");
  WriteReport(job_);
  EXPECT_EQ(names_parts(), true);
}

TEST(ReportTitle, IsTheDirectorysName) {
  EXPECT_EQ(ReportTitle("a/my map"), "my map");
  EXPECT_EQ(ReportTitle("a/my map/"), "my map");
  EXPECT_EQ(ReportTitle("a/b/.."), "a");
}

}  // namespace
}  // namespace plumbline
