#include "core/result/result_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <set>

#include "core/result/result_files.h"
#include "core/result/result_reader.h"
#include "test/testing/temporary_directory.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

MapPoint MakePoint(int i) {
  MapPoint point;
  const float value = static_cast<float>(i);
  point.p_world = {value, -0.5f * value, 0.25f * value};
  point.time_s = 1e-9 * i;
  point.scanner = i % 3;
  point.plane_id = i % 5 - 1;
  point.residual_m =
      point.plane_id < 0 ? std::numeric_limits<float>::quiet_NaN() : 0.125f * value;
  return point;
}

class ResultWriterTest : public TemporaryDirectoryTest {
 protected:
  void SetUp() override {
    TemporaryDirectoryTest::SetUp();
    output_ = directory_ / "deep" / "result";
  }

  void WriteAll(ResultWriter* writer, int num_points) {
    writer->WriteTrajectory({StampedPose()});
    writer->WritePlanes({PlanePatch()});
    PointBuffer points;
    for (int i = 0; i < num_points; ++i) {
      points.Add(MakePoint(i));
      if (i % 1000 < 999 && i + 1 < num_points) continue;
      writer->AddMapPoints(points);
      points.Clear();
    }
    writer->WriteSummary(Summary());
    writer->WriteConfig("a: 1");
  }

  void WriteResult(const fs::path& output, int num_points) {
    ResultDirectory result(output.string());
    ResultWriter writer(result);
    WriteAll(&writer, num_points);
    writer.Finish();
    result.Commit();
  }

  static std::set<std::string> FilesIn(const fs::path& directory) {
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(directory)) {
      names.insert(entry.path().filename().string());
    }
    return names;
  }

  fs::path output_;
};

TEST_F(ResultWriterTest, WritesAllFiles) {
  WriteResult(output_, 10);
  EXPECT_THAT(FilesIn(output_),
              ElementsAre("config_used.yaml",
                          "map.pcd",
                          "map.ply",
                          "planes.json",
                          "planes.ply",
                          "summary.json",
                          "trajectory.tum"));
  EXPECT_EQ(ReadBytes(output_ / "config_used.yaml"), "a: 1\n");
  EXPECT_EQ(ReadTrajectory((output_ / "trajectory.tum").string()).size(), 1u);
  EXPECT_EQ(ReadPlanes((output_ / "planes.json").string()).size(), 1u);
}

TEST_F(ResultWriterTest, TheLastWordOnAFileCounts) {
  ResultDirectory result(output_.string());
  ResultWriter writer(result);
  WriteAll(&writer, 20);
  writer.WriteConfig("b: 2\n");
  writer.Finish();
  result.Commit();
  EXPECT_EQ(ReadBytes(output_ / "config_used.yaml"), "b: 2\n");
}

TEST_F(ResultWriterTest, PartsAreFoundInTheirOrder) {
  for (const char* name : {"part_10", "part_2", "part_01", "parts", "part_1"}) {
    fs::create_directories(output_ / name);
  }
  WriteBytes(output_ / "part_3", "");
  EXPECT_THAT(PartsOf(output_.string()), ElementsAre("part_1", "part_2", "part_10"));
}

TEST_F(ResultWriterTest, WritesAPartIntoAFolderOfItsOwn) {
  ResultDirectory result(output_.string());
  {
    ResultWriter writer(result, "part_2");
    WriteAll(&writer, 10);
    writer.Finish();
  }
  result.Commit();
  EXPECT_THAT(FilesIn(output_), ElementsAre("part_2"));
  EXPECT_EQ(FilesIn(output_ / "part_2").size(), 7u);
}

TEST_F(ResultWriterTest, WritesTheSameBytesEachTime) {
  for (const char* name : {"a", "b"}) {
    WriteResult(directory_ / name, 30'000);
  }
  for (const std::string& name : FilesIn(directory_ / "a")) {
    EXPECT_TRUE(ReadBytes(directory_ / "a" / name) == ReadBytes(directory_ / "b" / name))
        << name;
  }
}

TEST_F(ResultWriterTest, WritesThePointsInTheFormatsAskedFor) {
  ResultDirectory result(output_.string());
  ResultWriter writer(result, "", {CloudFormat::kLas, CloudFormat::kE57});
  WriteAll(&writer, 10);
  writer.Finish();
  result.Commit();
  EXPECT_THAT(FilesIn(output_),
              ElementsAre("config_used.yaml",
                          "map.e57",
                          "map.las",
                          "planes.json",
                          "planes.ply",
                          "summary.json",
                          "trajectory.tum"));
}

TEST_F(ResultWriterTest, AnEarlierResultsCloudsGo) {
  {
    ResultDirectory result(output_.string());
    ResultWriter writer(result, "", {CloudFormat::kLas12});
    writer.Finish();
    result.Commit();
  }
  EXPECT_THAT(FilesIn(output_), ElementsAre("map_las12.las"));
  WriteResult(output_, 10);
  EXPECT_EQ(FilesIn(output_).count("map_las12.las"), 0u);
}

TEST_F(ResultWriterTest, AMapWithoutPointsIsWhole) {
  ResultDirectory result(output_.string());
  ResultWriter writer(result);
  writer.Finish();
  result.Commit();
  EXPECT_THAT(ReadBytes(output_ / "map.ply"), HasSubstr("element vertex 0\n"));
  EXPECT_THAT(ReadBytes(output_ / "map.pcd"), HasSubstr("POINTS 0\n"));
}

TEST_F(ResultWriterTest, FullDiskIsAnErrorAndLeavesNothing) {
  // Large enough for all but the map; it shows while points are added or only at the end.
  for (const int num_points : {30'000, 700}) {
    const std::string error = ErrorOf([&] {
      const FileSizeLimit limit(20'000);
      WriteResult(output_, num_points);
    });
    EXPECT_THAT(error, HasSubstr(output_.string() + "/map.ply: can not be written: File too large"));
    EXPECT_TRUE(fs::is_empty(directory_));
  }
}

}  // namespace
}  // namespace plumbline
