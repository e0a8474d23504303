#include "core/result/ply_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

#include "test/testing/known_points.h"
#include "test/testing/temporary_directory.h"

namespace plumbline {
namespace {

using ::testing::ElementsAre;

class PlyWriterTest : public TemporaryDirectoryTest {
 protected:
  // Writes the known points, so many at a time, and returns the file's bytes.
  std::string Write(int num_points, int num_at_once) {
    const std::string path = (directory_ / "map.ply").string();
    PlyWriter writer(path, "final");
    for (int i = 0; i < num_points; i += num_at_once) {
      writer.Add(KnownPoints(i, std::min(i + num_at_once, num_points)));
    }
    writer.Finish();
    return ReadBytes(path);
  }
};

TEST_F(PlyWriterTest, HeaderDescribesThePoints) {
  constexpr int kNumPoints = 12'345;
  const std::string ply = Write(kNumPoints, 1000);
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

TEST_F(PlyWriterTest, MapWithoutPointsIsAHeader) {
  const std::string empty = Write(0, 1);
  EXPECT_NE(empty.find("\nelement vertex 0\n"), std::string::npos);
  EXPECT_EQ(empty.find("end_header\n") + 11, empty.size());
  // As long as that of any other map: it was written before the number was known.
  EXPECT_EQ(Write(12'345, 1000).find("end_header\n") + 11, empty.size());
}

}  // namespace
}  // namespace plumbline
