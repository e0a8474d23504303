#include "core/result/pcd_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pcl/PCLPointCloud2.h>
#include <pcl/conversions.h>
#include <pcl/io/pcd_io.h>
#include <pcl/point_types.h>

#include <algorithm>
#include <cstring>
#include <string>
#include <vector>

#include "core/result/surface_colour.h"
#include "test/testing/known_points.h"
#include "test/testing/temporary_directory.h"

namespace plumbline {
namespace {

using ::testing::ElementsAre;

class PcdWriterTest : public TemporaryDirectoryTest {
 protected:
  // Writes the known points, so many at a time, and returns the file's bytes.
  std::string Write(int num_points, int num_at_once) {
    const std::string path = (directory_ / "map.pcd").string();
    PcdWriter writer(path, "final");
    for (int i = 0; i < num_points; i += num_at_once) {
      writer.Add(KnownPoints(i, std::min(i + num_at_once, num_points)));
    }
    writer.Finish();
    return ReadBytes(path);
  }
};

TEST_F(PcdWriterTest, PclReadsThePoints) {
  constexpr int kNumPoints = 25'000;  // several blocks
  Write(kNumPoints, 1000);
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
  for (int i = 0; i < kNumPoints; i += 776) {
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

// The number of points is filled in at the end, over the header that was written first.
TEST_F(PcdWriterTest, HeaderIsAsLongForEveryNumberOfPoints) {
  for (const int num_points : {0, 1, 12'345}) {
    const std::string bytes = Write(num_points, 1000);
    const std::string mark = "\nDATA binary\n";
    const size_t begin = bytes.find(mark) + mark.size();
    EXPECT_EQ(bytes.size() - begin,
              static_cast<size_t>(num_points) * PointBuffer::kPointBytes);
    EXPECT_EQ(begin, Write(7, 7).find(mark) + mark.size());
    EXPECT_NE(bytes.find("\nPOINTS " + std::to_string(num_points) + "\n"), std::string::npos);
    EXPECT_NE(bytes.find("\nWIDTH " + std::to_string(num_points) + "\n"), std::string::npos);
  }
}

}  // namespace
}  // namespace plumbline
