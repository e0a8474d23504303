#include "core/result/las_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "core/result/surface_colour.h"
#include "test/testing/known_points.h"
#include "test/testing/number_at.h"
#include "test/testing/temporary_directory.h"

namespace plumbline {
namespace {

using ::testing::HasSubstr;

class LasWriterTest : public TemporaryDirectoryTest {
 protected:
  std::string Write(LasVersion version, const PointBuffer& points) {
    const std::string path = (directory_ / "map.las").string();
    LasWriter writer(version, path, "name");
    writer.Add(points);
    writer.Finish();
    return ReadBytes(path);
  }
};

// Offsets: tables 1 and 3 of the LAS specification 1.4 - R15.
TEST_F(LasWriterTest, HeaderStatesVersionNumberAndBounds) {
  PointBuffer points;
  for (const Eigen::Vector3f& p :
       {Eigen::Vector3f(1.5f, -2.0f, 0.25f), Eigen::Vector3f(-0.5f, 3.0f, 0.125f)}) {
    MapPoint point;
    point.p_world = p;
    points.Add(point);
  }
  for (const LasVersion version : {LasVersion::k12, LasVersion::k14}) {
    const bool is_14 = version == LasVersion::k14;
    const std::string las = Write(version, points);
    EXPECT_EQ(las.substr(0, 4), "LASF");
    EXPECT_EQ(las[24], 1);
    EXPECT_EQ(las[25], is_14 ? 4 : 2);
    EXPECT_EQ(NumberAt<uint16_t>(las, 94), is_14 ? 375 : 227);
    EXPECT_EQ(las[104], is_14 ? 7 : 3);
    EXPECT_EQ(NumberAt<uint32_t>(las, 107), is_14 ? 0u : 2u);
    const size_t record = NumberAt<uint16_t>(las, 105);
    EXPECT_EQ(NumberAt<uint32_t>(las, 96) + 2 * record, las.size());
    const double bounds[] = {1.5, -0.5, 3.0, -2.0, 0.25, 0.125};
    for (size_t i = 0; i < 6; ++i)
      EXPECT_NEAR(NumberAt<double>(las, 179 + 8 * i), bounds[i], 1e-12);
    if (is_14) {
      EXPECT_EQ(NumberAt<uint64_t>(las, 247), 2u);
    }
  }
}

// Tables 11 and 16, and the extra bytes that a record of the header describes.
TEST_F(LasWriterTest, PointsHoldWhatTheMapKnows) {
  const int num_points = 50;
  const PointBuffer points = KnownPoints(0, num_points);
  for (const LasVersion version : {LasVersion::k12, LasVersion::k14}) {
    const bool is_14 = version == LasVersion::k14;
    const std::string las = Write(version, points);
    const size_t begin = NumberAt<uint32_t>(las, 96);
    const size_t size = NumberAt<uint16_t>(las, 105);
    for (int i = 0; i < num_points; ++i) {
      const MapPoint point = KnownPoint(i);
      const std::string record = las.substr(begin + static_cast<size_t>(i) * size, size);
      for (int axis = 0; axis < 3; ++axis) {
        const double stored = NumberAt<int32_t>(record, 4 * static_cast<size_t>(axis)) *
                              NumberAt<double>(las, 131 + 8 * static_cast<size_t>(axis));
        EXPECT_NEAR(stored, static_cast<double>(point.p_world[axis]), 0.5e-4 + 1e-9);
      }
      EXPECT_EQ(record[is_14 ? 16 : 15], point.plane_id >= 0 ? 6 : 1);  // a building
      EXPECT_EQ(record[17], point.scanner);
      EXPECT_EQ(NumberAt<double>(record, is_14 ? 22 : 20), point.time_s);
      for (size_t channel = 0; channel < 3; ++channel) {
        EXPECT_EQ(NumberAt<uint16_t>(record, (is_14 ? 30 : 28) + 2 * channel) / 257,
                  PointColour(point.plane_id)[channel]);
      }
      if (!is_14) {
        EXPECT_EQ(NumberAt<uint16_t>(record, 18), std::max(point.plane_id + 1, 0));
        continue;
      }
      EXPECT_EQ(record[36], point.scanner);
      EXPECT_EQ(NumberAt<int32_t>(record, 37), point.plane_id);
      const auto residual = NumberAt<float>(record, 41);
      EXPECT_TRUE(residual == point.residual_m ||
                  (std::isnan(residual) && std::isnan(point.residual_m)));
    }
  }
}

TEST_F(LasWriterTest, MapWithoutPointsIsAHeader) {
  const std::string las = Write(LasVersion::k14, PointBuffer());
  EXPECT_EQ(NumberAt<uint32_t>(las, 96), las.size());
  EXPECT_EQ(NumberAt<uint64_t>(las, 247), 0u);
  EXPECT_EQ(NumberAt<double>(las, 179), 0.0);
}

TEST_F(LasWriterTest, LasHoldsNoPointBeyondItsIntegers) {
  PointBuffer points;
  MapPoint far = KnownPoint(0);
  far.p_world.y() = 300'000.0f;
  points.Add(far);
  LasWriter writer(LasVersion::k14, (directory_ / "a.las").string(), "out/map.las");
  EXPECT_THAT(ErrorOf([&] { writer.Add(points); }),
              HasSubstr("out/map.las: can not be written: a coordinate of 300000"));
}

TEST_F(LasWriterTest, Las12HoldsNoPlaneBeyondItsIntegers) {
  PointBuffer points;
  MapPoint late = KnownPoint(0);
  late.plane_id = 65535;
  points.Add(late);
  LasWriter writer(LasVersion::k12, (directory_ / "a.las").string(), "out/map_las12.las");
  EXPECT_THAT(ErrorOf([&] { writer.Add(points); }),
              HasSubstr("LAS 1.2 has no number for plane 65535"));
}

TEST_F(LasWriterTest, CoordinateThatIsNoNumberIsRefused) {
  PointBuffer points;
  MapPoint bad = KnownPoint(0);
  bad.p_world.z() = std::nanf("");
  points.Add(bad);
  LasWriter writer(LasVersion::k14, (directory_ / "a.las").string(), "out/map.las");
  EXPECT_THAT(ErrorOf([&] { writer.Add(points); }),
              HasSubstr("out/map.las: can not be written: a coordinate of nan m"));
}

// The last number that the format has, and the last coordinate.
TEST_F(LasWriterTest, LimitsCanBeWritten) {
  PointBuffer points;
  MapPoint point = KnownPoint(0);
  point.plane_id = 65534;
  point.p_world.x() = -214'000.0f;
  points.Add(point);
  const std::string las = Write(LasVersion::k12, points);
  EXPECT_EQ(NumberAt<uint16_t>(las, 227 + 18), 65535);
  EXPECT_EQ(NumberAt<int32_t>(las, 227), -2'140'000'000);
}

}  // namespace
}  // namespace plumbline
