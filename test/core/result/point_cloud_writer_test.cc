#include "core/result/point_cloud_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pcl/PCLPointCloud2.h>
#include <pcl/conversions.h>
#include <pcl/io/pcd_io.h>
#include <pcl/point_types.h>

#include <cstring>
#include <sstream>

#include "core/result/e57_pages.h"
#include "core/result/surface_colour.h"
#include "test/testing/known_points.h"
#include "test/testing/temporary_directory.h"

namespace plumbline {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr CloudFormat kAllFormats[] = {CloudFormat::kPly,
                                       CloudFormat::kPcd,
                                       CloudFormat::kLas,
                                       CloudFormat::kLas12,
                                       CloudFormat::kE57};

TEST(PointBufferTest, GivesBackItsPoints) {
  const PointBuffer points = KnownPoints(0, 2500);
  ASSERT_EQ(points.num_points(), 2500);
  EXPECT_EQ(points.num_bytes(), 2500u * 45u);
  for (int i = 0; i < 2500; ++i) EXPECT_TRUE(AreSame(points.At(i), KnownPoint(i))) << i;
}

TEST(SurfaceColourTest, TellsSurfacesApart) {
  EXPECT_THAT(SurfaceColour(0), ElementsAre(255, 64, 64));
  EXPECT_NE(SurfaceColour(1), SurfaceColour(2));
  EXPECT_EQ(PointColour(3), SurfaceColour(3));
  EXPECT_THAT(PointColour(-1), ElementsAre(160, 160, 160));
  EXPECT_THAT(PointColour(kMovingPlaneId), ElementsAre(90, 90, 90));
}

TEST(CloudFormatsTest, NamesAreFormats) {
  EXPECT_THAT(ParseCloudFormats("ply,pcd,las,las12,e57"),
              ElementsAre(CloudFormat::kPly,
                          CloudFormat::kPcd,
                          CloudFormat::kLas,
                          CloudFormat::kLas12,
                          CloudFormat::kE57));
  EXPECT_THAT(ParseCloudFormats(kDefaultCloudFormats),
              ElementsAre(CloudFormat::kPly, CloudFormat::kPcd));
  EXPECT_THAT(ErrorOf([] { ParseCloudFormats("ply,laz"); }),
              HasSubstr("'laz' is none of ply"));
  EXPECT_THAT(ErrorOf([] { ParseCloudFormats("e57,e57"); }),
              HasSubstr("'e57' stands there twice"));
  EXPECT_THAT(ErrorOf([] { ParseCloudFormats(""); }), HasSubstr("name one at least"));
  EXPECT_TRUE(IsCloudFormatList("las"));
  EXPECT_FALSE(
      IsCloudFormatList("las,"
                        ",ply"));
}

TEST(CloudFormatsTest, FilesHaveNamesOfTheirOwn) {
  for (const CloudFormat format : kAllFormats) {
    EXPECT_TRUE(IsCloudFileName(CloudFileName(format)));
  }
  EXPECT_EQ(CloudFileName(CloudFormat::kLas12), "map_las12.las");
  EXPECT_FALSE(IsCloudFileName("planes.ply"));
}

TEST(E57PagesTest, PhysicalOffsetsCountTheChecksums) {
  EXPECT_EQ(E57Pages::PhysicalOffset(0), 0u);
  EXPECT_EQ(E57Pages::PhysicalOffset(1019), 1019u);
  EXPECT_EQ(E57Pages::PhysicalOffset(1020), 1024u);
  EXPECT_EQ(E57Pages::PhysicalOffset(2041), 2049u);
}

class PointCloudWriterTest : public TemporaryDirectoryTest {
 protected:
  // Writes the known points, so many at a time, and returns the file's bytes.
  std::string Write(CloudFormat format, int num_points, int num_at_once) {
    const std::string path = (directory_ / CloudFileName(format)).string();
    const auto writer = CreatePointCloudWriter(format, path, "final");
    for (int i = 0; i < num_points; i += num_at_once) {
      writer->Add(KnownPoints(i, std::min(i + num_at_once, num_points)));
    }
    writer->Finish();
    return ReadBytes(path);
  }
};

TEST_F(PointCloudWriterTest, BytesDoNotDependOnTheCalls) {
  for (const CloudFormat format : kAllFormats) {
    const std::string at_once = Write(format, 3500, 3500);
    EXPECT_TRUE(at_once == Write(format, 3500, 777)) << CloudFileName(format);
    EXPECT_TRUE(at_once == Write(format, 3500, 7)) << CloudFileName(format);
  }
}

TEST_F(PointCloudWriterTest, PclReadsThePoints) {
  constexpr int kNumPoints = 25'000;  // several blocks
  Write(CloudFormat::kPcd, kNumPoints, 1000);
  pcl::PCLPointCloud2 cloud;
  ASSERT_EQ(pcl::PCDReader().read((directory_ / "map.pcd").string(), cloud), 0);
  std::vector<std::string> names;
  for (const pcl::PCLPointField& field : cloud.fields) names.push_back(field.name);
  EXPECT_THAT(names,
              ElementsAre("x",
                          "y",
                          "z",
                          "time",
                          "scanner",
                          "plane_id",
                          "residual",
                          "rgba",
                          "normal_x",
                          "normal_y",
                          "normal_z"));
  EXPECT_EQ(cloud.fields[3].datatype, pcl::PCLPointField::FLOAT64);
  EXPECT_EQ(cloud.fields[4].datatype, pcl::PCLPointField::UINT8);
  EXPECT_EQ(cloud.fields[5].datatype, pcl::PCLPointField::INT32);
  ASSERT_EQ(cloud.width * cloud.height, static_cast<unsigned>(kNumPoints));
  pcl::PointCloud<pcl::PointXYZRGBA> colours;
  pcl::PointCloud<pcl::PointNormal> normals;
  pcl::fromPCLPointCloud2(cloud, colours);
  pcl::fromPCLPointCloud2(cloud, normals);
  for (int i = 0; i < kNumPoints; i += 777) {
    const auto index = static_cast<size_t>(i);
    const MapPoint point = KnownPoint(i);
    EXPECT_EQ(colours[index].getVector3fMap(), point.p_world);
    EXPECT_THAT(PointColour(point.plane_id),
                ElementsAre(colours[index].r, colours[index].g, colours[index].b));
    EXPECT_EQ(colours[index].a, 255);
    EXPECT_EQ(normals[index].getNormalVector3fMap(), point.normal_world);
    double time_s = 0.0;
    int32_t plane_id = 0;
    const uint8_t* bytes = cloud.data.data() + index * cloud.point_step;
    std::memcpy(&time_s, bytes + cloud.fields[3].offset, sizeof(time_s));
    std::memcpy(&plane_id, bytes + cloud.fields[5].offset, sizeof(plane_id));
    EXPECT_EQ(time_s, point.time_s);
    EXPECT_EQ(bytes[cloud.fields[4].offset], point.scanner);
    EXPECT_EQ(plane_id, point.plane_id);
  }
}

TEST_F(PointCloudWriterTest, PlyHeaderDescribesThePoints) {
  constexpr int kNumPoints = 12'345;
  const std::string ply = Write(CloudFormat::kPly, kNumPoints, 1000);
  const std::string end = "end_header\n";
  const size_t start = ply.find(end) + end.size();
  std::istringstream header(ply.substr(0, start));
  std::vector<std::string> lines;
  for (std::string line; std::getline(header, line);) {
    if (line.rfind("comment", 0) != 0) lines.push_back(line);
  }
  // Open3D reads colours and normals only where they stand in this order.
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
                          "property uchar red",
                          "property uchar green",
                          "property uchar blue",
                          "property uchar alpha",
                          "property float nx",
                          "property float ny",
                          "property float nz",
                          "end_header"));
  const PointBuffer points = KnownPoints(0, kNumPoints);
  EXPECT_TRUE(ply.substr(start) == std::string(points.data(), points.num_bytes()));
}

TEST_F(PointCloudWriterTest, LasHoldsNoPointBeyondItsIntegers) {
  PointBuffer points;
  MapPoint far = KnownPoint(0);
  far.p_world.y() = 300'000.0f;
  points.Add(far);
  const auto writer = CreatePointCloudWriter(
      CloudFormat::kLas, (directory_ / "a.las").string(), "out/map.las");
  EXPECT_THAT(ErrorOf([&] { writer->Add(points); }),
              HasSubstr("out/map.las: can not be written: a coordinate of 300000"));
}

TEST_F(PointCloudWriterTest, Las12HoldsNoPlaneBeyondItsIntegers) {
  PointBuffer points;
  MapPoint late = KnownPoint(0);
  late.plane_id = 65535;
  points.Add(late);
  const auto writer = CreatePointCloudWriter(
      CloudFormat::kLas12, (directory_ / "a.las").string(), "out/map_las12.las");
  EXPECT_THAT(ErrorOf([&] { writer->Add(points); }),
              HasSubstr("LAS 1.2 has no number for plane 65535"));
}

TEST_F(PointCloudWriterTest, FullDiskIsAnError) {
  for (const CloudFormat format : kAllFormats) {
    const std::string error = ErrorOf([&] {
      const FileSizeLimit limit(20'000);
      Write(format, 2000, 100);
    });
    EXPECT_EQ(error, "final: can not be written: File too large") << CloudFileName(format);
  }
}

}  // namespace
}  // namespace plumbline
