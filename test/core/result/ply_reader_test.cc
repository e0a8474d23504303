#include "core/result/ply_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "core/result/point_cloud_writer.h"
#include "test/testing/known_points.h"
#include "test/testing/temporary_directory.h"

namespace plumbline {
namespace {

using ::testing::HasSubstr;

// Up to the fields that every map has.
constexpr char kHeader[] =
    "ply\nformat binary_little_endian 1.0\nelement vertex 2\nproperty short extra\n"
    "property float x\nproperty float y\nproperty float z\nproperty double time\n"
    "property uchar scanner\nproperty int plane_id\nproperty float residual\n";
constexpr size_t kBareBytes = 31;

class PlyReaderTest : public TemporaryDirectoryTest {
 protected:
  std::string path() const { return (directory_ / "map.ply").string(); }
  void Write(int num_points) {
    const auto writer = CreatePointCloudWriter(CloudFormat::kPly, path(), path());
    writer->Add(KnownPoints(0, num_points));
    writer->Finish();
  }
  std::string ErrorOfReading(const std::string& bytes) {
    WriteBytes(path(), bytes);
    return ErrorOf([&] {
      PlyReader reader(path());
      PointBuffer points;
      while (reader.Next(&points)) continue;
    });
  }
};

TEST_F(PlyReaderTest, ReadsWhatIsWritten) {
  constexpr int kNumPoints = 110'000;  // several blocks
  Write(kNumPoints);
  PlyReader reader(path());
  EXPECT_EQ(reader.num_points(), kNumPoints);
  PointBuffer points;
  int num_read = 0;
  while (reader.Next(&points)) {
    for (int64_t i = 0; i < points.num_points(); i += 97) {
      const int index = num_read + static_cast<int>(i);
      ASSERT_TRUE(AreSame(points.At(i), KnownPoint(index))) << index;
    }
    num_read += static_cast<int>(points.num_points());
  }
  EXPECT_EQ(num_read, kNumPoints);
}

TEST_F(PlyReaderTest, FindsFieldsByName) {
  std::string record(kBareBytes, '\0');
  record[kBareBytes - 8] = 5;  // plane_id
  WriteBytes(path(), kHeader + std::string("end_header\n") + record + record);
  PlyReader reader(path());
  PointBuffer points;
  ASSERT_TRUE(reader.Next(&points));
  ASSERT_EQ(points.num_points(), 2);
  EXPECT_EQ(points.At(1).plane_id, 5);
  EXPECT_EQ(points.At(1).normal_world, Eigen::Vector3f::Zero());
  EXPECT_FALSE(reader.Next(&points));
}

TEST_F(PlyReaderTest, AnEmptyMapHasNoPoints) {
  Write(0);
  PlyReader reader(path());
  PointBuffer points;
  EXPECT_FALSE(reader.Next(&points));
}

TEST_F(PlyReaderTest, NamesWhatIsWrong) {
  EXPECT_THAT(ErrorOf([&] { PlyReader reader(path()); }),
              HasSubstr("map.ply: can not be read: No such file"));
  EXPECT_THAT(ErrorOfReading("solid\n"), HasSubstr("does not begin with 'ply'"));
  EXPECT_THAT(ErrorOfReading("ply\nformat ascii 1.0\n"), HasSubstr("it is not binary"));
  EXPECT_THAT(ErrorOfReading(std::string("ply\n") + std::string(2000, 'x')),
              HasSubstr("a line of its header has no end"));
  EXPECT_THAT(ErrorOfReading(kHeader), HasSubstr("its header has no end"));
  EXPECT_THAT(ErrorOfReading(kHeader + std::string("element face 1\nend_header\n")),
              HasSubstr("'element face 1'"));
  EXPECT_THAT(ErrorOfReading(kHeader + std::string("property list uchar int faces\n")),
              HasSubstr("'property list uchar'"));
  std::string without_time = kHeader;
  without_time.replace(without_time.find("double time"), 11, "double hour");
  EXPECT_THAT(ErrorOfReading(without_time + "end_header\n"),
              HasSubstr("it has no 'property double time'"));
  EXPECT_THAT(ErrorOfReading(kHeader + std::string("end_header\n") + std::string(61, '\0')),
              HasSubstr("ends within its points"));
  std::string negative = kHeader;
  negative.replace(negative.find("vertex 2"), 8, "vertex -2");
  EXPECT_THAT(ErrorOfReading(negative + "end_header\n"), HasSubstr("'element vertex -2'"));
}

TEST_F(PlyReaderTest, PointsThatAreNoNumbersAreAnError) {
  std::string record(kBareBytes, '\0');
  std::string bad = record;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::memcpy(&bad[2], &nan, sizeof(nan));  // x
  EXPECT_THAT(ErrorOfReading(kHeader + std::string("end_header\n") + record + bad),
              HasSubstr("point 1 has a position or time that is no number"));
}

}  // namespace
}  // namespace plumbline
