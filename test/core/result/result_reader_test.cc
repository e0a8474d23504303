#include "core/result/result_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/result/result_text.h"
#include "core/result/result_writer.h"
#include "test/testing/temporary_directory.h"

namespace plumbline {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

class ResultReaderTest : public TemporaryDirectoryTest {
 protected:
  void SetUp() override {
    TemporaryDirectoryTest::SetUp();
    path_ = (directory_ / "file").string();
  }

  std::string TrajectoryError(const std::string& text) {
    WriteBytes(path_, text);
    return ErrorOf([this] { ReadTrajectory(path_); });
  }

  std::string PlanesError(const std::string& text) {
    WriteBytes(path_, text);
    return ErrorOf([this] { ReadPlanes(path_); });
  }

  std::string path_;
};

PlanePatch MakePlane() {
  PlanePatch plane;
  plane.id = 12;
  plane.type = PlaneType::kGeneral;
  plane.normal = Eigen::Vector3d(1.0, 2.0, -3.0).normalized();
  plane.distance = -1.0 / 3.0;
  plane.sigma_angle_rad = 1e-4;
  plane.sigma_distance_m = 2e-3;
  plane.centre = {0.1, 0.2, 0.3};
  plane.outline = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0.7}};
  plane.num_points = 1234567890123;
  plane.num_segments = 42;
  plane.first_time_ns = 1'600'000'000'123'456'789;
  plane.last_time_ns = 1'600'000'001'987'654'321;
  return plane;
}

TEST_F(ResultReaderTest, ReadsTheStartToTheNanosecond) {
  Summary summary;
  for (const int64_t time_ns : {int64_t{1'600'000'000'123'456'789}, int64_t{-5}}) {
    summary.start_time_ns = time_ns;
    WriteBytes(path_, FormatSummary(summary));
    EXPECT_EQ(ReadStartTime(path_), time_ns);
  }
  const auto error = [this](const std::string& text) {
    WriteBytes(path_, text);
    return ErrorOf([this] { ReadStartTime(path_); });
  };
  EXPECT_THAT(error("{}"), StartsWith(path_ + ": has no 'start_time'"));
  EXPECT_THAT(error("[]"), StartsWith(path_ + ": is not an object"));
  for (const char* value : {"\"1\"", "1e30", "null"}) {
    EXPECT_THAT(error(std::string("{\"start_time\": ") + value + "}"),
                HasSubstr("must be a time in seconds"))
        << value;
  }
}

TEST_F(ResultReaderTest, ReadsTheTrajectoryThatWasWritten) {
  std::vector<StampedPose> written;
  for (int i = 0; i < 20; ++i) {
    StampedPose pose;
    pose.time_ns = 1'600'000'000'123'456'789 + i * int64_t{24'999'999};
    pose.world_from_body.translation = Eigen::Vector3d(1.0 / 3.0, -2.0, 0.1) * i;
    pose.world_from_body.rotation = RotationFromRollPitchYaw(0.1 * i, -0.05 * i, 0.4 * i);
    written.push_back(pose);
  }
  WriteBytes(path_, FormatTrajectory(written));
  const std::vector<StampedPose> read = ReadTrajectory(path_);
  ASSERT_EQ(read.size(), written.size());
  for (size_t i = 0; i < read.size(); ++i) {
    EXPECT_EQ(read[i].time_ns, written[i].time_ns);
    const Rigid3d difference = written[i].world_from_body.Inverse() * read[i].world_from_body;
    EXPECT_LT(difference.translation.norm(), 1e-9);  // three roundings to 0.5e-9
    EXPECT_LT(difference.rotation.vec().norm(), 2e-12);
    EXPECT_GE(read[i].world_from_body.rotation.w(), 0.0);
  }
}

TEST_F(ResultReaderTest, ReadsTrajectoriesOfOtherTools) {
  WriteBytes(path_,
             "# t x y z qx qy qz qw\n\n"
             " 1.600000000123456789e+09 1 2 3 0 0 0 1\r\n1600000001 1 2 3 0 0 -1e0 0\n");
  const std::vector<StampedPose> poses = ReadTrajectory(path_);
  ASSERT_EQ(poses.size(), 2u);
  EXPECT_EQ(poses[0].time_ns, 1'600'000'000'123'456'789);
  EXPECT_EQ(poses[1].time_ns, 1'600'000'001'000'000'000);
}

TEST_F(ResultReaderTest, NamesTheLineOfABadPose) {
  const std::string good = "1 0 0 0 0 0 0 1\n";
  EXPECT_EQ(TrajectoryError(good + "2 0 0 0 0 0 1\n"),
            path_ + ":2: not the eight numbers t x y z qx qy qz qw");
  EXPECT_THAT(TrajectoryError(good + "2 0 0 0 0 0 0 1 5\n"), StartsWith(path_ + ":2: not"));
  EXPECT_THAT(TrajectoryError(good + "2 0 0 zero 0 0 0 1\n"), StartsWith(path_ + ":2: not"));
  EXPECT_THAT(TrajectoryError(good + "2 0 0 0 0 0 0 1 m\n"), StartsWith(path_ + ":2: not"));
  EXPECT_EQ(TrajectoryError(good + "2 nan 0 0 0 0 0 1\n"),
            path_ + ":2: a number is not finite");
  EXPECT_EQ(TrajectoryError(good + "1e11 0 0 0 0 0 0 1\n"), path_ + ":2: time out of range");
  EXPECT_EQ(TrajectoryError(good + "\n" + good), path_ + ":3: time does not increase");
  EXPECT_EQ(TrajectoryError("1 0 0 0 0 0 0 0.9\n"),
            path_ + ":1: qx qy qz qw is not a unit quaternion");
  EXPECT_EQ(TrajectoryError("# nothing\n"), path_ + ": holds no poses");
  EXPECT_EQ(TrajectoryError(""), path_ + ": holds no poses");
}

TEST_F(ResultReaderTest, NamesFilesThatCanNotBeRead) {
  EXPECT_EQ(ErrorOf([this] { ReadTrajectory(path_); }),
            path_ + ": can not be read: No such file or directory");
  EXPECT_EQ(ErrorOf([this] { ReadPlanes(directory_.string()); }),
            directory_.string() + ": can not be read: Is a directory");
}

TEST_F(ResultReaderTest, ReadsThePlanesThatWereWritten) {
  PlanePatch floor;
  floor.type = PlaneType::kHorizontal;
  floor.sigma_distance_m = std::numeric_limits<double>::quiet_NaN();
  const PlanePatch written = MakePlane();
  WriteBytes(path_, FormatPlanes({written, floor}));
  const std::vector<PlanePatch> planes = ReadPlanes(path_);
  ASSERT_EQ(planes.size(), 2u);
  const PlanePatch& read = planes[0];
  EXPECT_EQ(read.id, written.id);
  EXPECT_EQ(read.type, written.type);
  EXPECT_LT((read.normal - written.normal).norm(), 1e-15);
  EXPECT_EQ(read.distance, written.distance);
  EXPECT_DOUBLE_EQ(read.sigma_angle_rad, written.sigma_angle_rad);
  EXPECT_EQ(read.sigma_distance_m, written.sigma_distance_m);
  EXPECT_EQ(read.centre, written.centre);
  EXPECT_EQ(read.outline, written.outline);
  EXPECT_EQ(read.num_points, written.num_points);
  EXPECT_EQ(read.num_segments, written.num_segments);
  EXPECT_EQ(read.first_time_ns, written.first_time_ns);
  EXPECT_EQ(read.last_time_ns, written.last_time_ns);
  EXPECT_EQ(planes[1].type, PlaneType::kHorizontal);
  EXPECT_TRUE(planes[1].outline.empty());
  EXPECT_TRUE(std::isnan(planes[1].sigma_distance_m));
}

TEST_F(ResultReaderTest, NamesTheByteWhereJsonBreaks) {
  EXPECT_EQ(PlanesError("[{\"id\": 1,}]"), path_ + ": byte 11: is not valid JSON");
  EXPECT_THAT(PlanesError(""), StartsWith(path_ + ": byte 1: "));
  EXPECT_EQ(PlanesError("{}"), path_ + ": is not an array of planes");
  EXPECT_EQ(PlanesError("[5]"), path_ + ": element 0 is not an object");
}

// The axis on the side that was seen, and on the other one.
TEST_F(ResultReaderTest, ReadsTheCylindersThatWereWritten) {
  for (const double curvature : {-0.25, 0.8}) {
    PlanePatch written = MakePlane();
    written.type = PlaneType::kCylinder;
    written.normal = {0.6, 0.8, 0.0};
    written.distance = written.normal.dot(written.centre);
    written.curvature = curvature;
    written.sigma_radius_m = 0.003;
    written.radius_turn_correlation = -0.4;
    WriteBytes(path_, FormatPlanes({written}));
    const std::vector<PlanePatch> planes = ReadPlanes(path_);
    ASSERT_EQ(planes.size(), 1u);
    EXPECT_EQ(planes[0].type, PlaneType::kCylinder);
    EXPECT_NEAR(planes[0].curvature, curvature, 1e-12);
    EXPECT_EQ(planes[0].sigma_radius_m, 0.003);
    EXPECT_EQ(planes[0].radius_turn_correlation, -0.4);
    EXPECT_LT((planes[0].AxisPoint() - written.AxisPoint()).norm(), 1e-12);
    EXPECT_NEAR(planes[0].SignedDistance(written.centre + 0.1 * written.normal), 0.1, 1e-12);
  }
}

TEST_F(ResultReaderTest, NamesThePlaneAndKeyAtFault) {
  const nlohmann::json good = nlohmann::json::parse(FormatPlanes({MakePlane()}))[0];
  for (const auto& [key, value] : good.items()) {
    nlohmann::json json = good;
    json.erase(key);
    EXPECT_THAT(PlanesError(nlohmann::json::array({good, json}).dump()),
                HasSubstr(path_ + ": element 1"));
    EXPECT_THAT(PlanesError(nlohmann::json::array({json}).dump()),
                HasSubstr(": has no '" + key + "'"));
    json[key] = true;
    EXPECT_THAT(PlanesError(nlohmann::json::array({json}).dump()),
                HasSubstr(": '" + key + "' must be "));
  }
  const auto error_with = [&](const std::string& key, const nlohmann::json& value) {
    nlohmann::json json = good;
    json[key] = value;
    return PlanesError(nlohmann::json::array({json}).dump());
  };
  EXPECT_EQ(error_with("type", "oblique"),
            path_ +
                ": element 0 (plane 12): 'type' must be horizontal, vertical, general or "
                "cylinder");
  EXPECT_THAT(error_with("normal", {1.0, 1.0, 0.0}),
              HasSubstr("'normal' must be a unit vector"));
  EXPECT_THAT(error_with("normal", {1.0, 0.0}), HasSubstr("made of three numbers"));
  EXPECT_THAT(error_with("sigma_angle_deg", -1.0), HasSubstr("zero or positive"));
  EXPECT_THAT(error_with("num_segments", 1.5), HasSubstr("an integer from 0"));
  EXPECT_THAT(error_with("num_segments", 1ll << 40), HasSubstr("an integer from 0"));
  EXPECT_THAT(error_with("first_time", 1e20), HasSubstr("a time in seconds"));
}

}  // namespace
}  // namespace plumbline
