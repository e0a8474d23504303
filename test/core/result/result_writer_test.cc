#include "core/result/result_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pcl/PCLPointCloud2.h>
#include <pcl/io/pcd_io.h>

#include <cmath>
#include <cstring>
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

constexpr size_t kPointBytes = 29;

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

// What the packed bytes of a point say.
MapPoint UnpackPoint(const char* bytes) {
  MapPoint point;
  float position[3];
  uint8_t scanner = 0;
  int32_t plane_id = 0;
  std::memcpy(position, bytes, 12);
  std::memcpy(&point.time_s, bytes + 12, 8);
  std::memcpy(&scanner, bytes + 20, 1);
  std::memcpy(&plane_id, bytes + 21, 4);
  std::memcpy(&point.residual_m, bytes + 25, 4);
  point.p_world = {position[0], position[1], position[2]};
  point.scanner = scanner;
  point.plane_id = plane_id;
  return point;
}

void ExpectSamePoint(const MapPoint& a, const MapPoint& b) {
  EXPECT_EQ(a.p_world, b.p_world);
  EXPECT_EQ(a.time_s, b.time_s);
  EXPECT_EQ(a.scanner, b.scanner);
  EXPECT_EQ(a.plane_id, b.plane_id);
  if (b.plane_id < 0) {
    EXPECT_TRUE(std::isnan(a.residual_m));
  } else {
    EXPECT_EQ(a.residual_m, b.residual_m);
  }
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

TEST_F(ResultWriterTest, PclReadsTheMap) {
  constexpr int kNumPoints = 25'000;  // several blocks
  WriteResult(output_, kNumPoints);
  pcl::PCLPointCloud2 cloud;
  ASSERT_EQ(pcl::PCDReader().read((output_ / "map.pcd").string(), cloud), 0);
  std::vector<std::string> names;
  for (const pcl::PCLPointField& field : cloud.fields) names.push_back(field.name);
  EXPECT_THAT(names, ElementsAre("x", "y", "z", "time", "scanner", "plane_id", "residual"));
  EXPECT_EQ(cloud.fields[3].datatype, pcl::PCLPointField::FLOAT64);
  EXPECT_EQ(cloud.fields[4].datatype, pcl::PCLPointField::UINT8);
  EXPECT_EQ(cloud.fields[5].datatype, pcl::PCLPointField::INT32);
  ASSERT_EQ(cloud.width * cloud.height, static_cast<unsigned>(kNumPoints));
  ASSERT_EQ(cloud.point_step, kPointBytes);
  for (int i = 0; i < kNumPoints; i += 777) {
    const uint8_t* bytes = cloud.data.data() + static_cast<size_t>(i) * kPointBytes;
    ExpectSamePoint(UnpackPoint(reinterpret_cast<const char*>(bytes)), MakePoint(i));
  }
}

TEST_F(ResultWriterTest, PlyHeaderDescribesThePoints) {
  constexpr int kNumPoints = 12'345;
  WriteResult(output_, kNumPoints);
  const std::string ply = ReadBytes(output_ / "map.ply");
  const std::string end = "end_header\n";
  const size_t start = ply.find(end) + end.size();
  std::istringstream header(ply.substr(0, start));
  std::vector<std::string> lines;
  for (std::string line; std::getline(header, line);) {
    if (line.rfind("comment", 0) != 0) lines.push_back(line);
  }
  EXPECT_THAT(lines,
              ElementsAre("ply",
                          "format binary_little_endian 1.0",
                          "element vertex 12345",
                          "property float x",
                          "property float y",
                          "property float z",
                          "property double time",
                          "property uchar scanner",
                          "property int plane_id",
                          "property float residual",
                          "end_header"));
  ASSERT_EQ(ply.size(), start + kNumPoints * kPointBytes);
  for (int i = 0; i < kNumPoints; i += 777) {
    const char* bytes = ply.data() + start + static_cast<size_t>(i) * kPointBytes;
    ExpectSamePoint(UnpackPoint(bytes), MakePoint(i));
  }
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
