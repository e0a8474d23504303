#include "core/result/point_cloud_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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
