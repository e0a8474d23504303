#include "core/sensor/depth_camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "core/recording/messages.h"

namespace plumbline {
namespace {

// Three rows of four pixels; slopes are (column - 1) / 2 and (row - 1) / 4.
PinholeModel SmallModel() { return {4, 3, 2.0, 4.0, 1.0, 1.0}; }

// An image of that size, a byte longer in each row than its pixels need.
template <typename Pixel>
struct SmallImage {
  explicit SmallImage(const std::string& encoding) {
    message.width = 4;
    message.height = 3;
    message.encoding = encoding;
    message.row_bytes = 4 * sizeof(Pixel) + 1;
    bytes.assign(3 * message.row_bytes, 0);
    message.data = {bytes.data(), bytes.size()};
  }
  void Set(int row, int column, Pixel value) {
    std::memcpy(bytes.data() + static_cast<size_t>(row) * message.row_bytes +
                    static_cast<size_t>(column) * sizeof(Pixel),
                &value,
                sizeof(Pixel));
  }

  std::vector<uint8_t> bytes;
  ImageMessage message;
};

TEST(DepthCamera, RangesAndAnglesOfARowAreThoseComputedByHand) {
  SmallImage<uint16_t> image("16UC1");
  image.Set(2, 0, 1000);
  image.Set(2, 3, 2000);
  const std::vector<float> ranges = RowRanges(image.message, SmallModel(), 2);
  const std::vector<float> angles = RowAngles(SmallModel(), 2);
  ASSERT_EQ(ranges.size(), 4u);
  ASSERT_EQ(angles.size(), 4u);
  // Column 3 is the first beam: slopes 1 and 1/4.
  EXPECT_FLOAT_EQ(ranges[0], 2.0f * std::sqrt(1.0f + 1.0f + 1.0f / 16.0f));
  EXPECT_FLOAT_EQ(angles[0], std::atan2(-1.0f, std::sqrt(17.0f / 16.0f)));
  EXPECT_TRUE(std::isnan(ranges[1]) && std::isnan(ranges[2]));
  EXPECT_FLOAT_EQ(angles[2], 0.0f);
  EXPECT_FLOAT_EQ(ranges[3], std::sqrt(1.0f + 0.25f + 1.0f / 16.0f));
  EXPECT_FLOAT_EQ(angles[3], std::atan2(0.5f, std::sqrt(17.0f / 16.0f)));
}

// Whatever the row and the column, the beam ends where the pixel's depth lies.
TEST(DepthCamera, BeamsEndWhereThePixelsAre) {
  const PinholeModel model = SmallModel();
  SmallImage<float> image("32FC1");
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) {
      image.Set(row, column, 1.5f + 0.25f * static_cast<float>(row + column));
    }
  }
  for (int row = 0; row < 3; ++row) {
    const std::vector<float> ranges = RowRanges(image.message, model, row);
    const std::vector<float> angles = RowAngles(model, row);
    for (int beam = 0; beam < 4; ++beam) {
      const int column = 3 - beam;
      const double depth = 1.5 + 0.25 * (row + column);
      const double angle = angles[static_cast<size_t>(beam)];
      const double range = ranges[static_cast<size_t>(beam)];
      const Eigen::Vector3d p_camera =
          CameraFromRow(model, row) *
          (range * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.0));
      const Eigen::Vector3d expected(
          depth * (column - 1) / 2.0, depth * (row - 1) / 4.0, depth);
      EXPECT_LT((p_camera - expected).norm(), 1e-6) << row << " " << column;
      EXPECT_NEAR(DepthOf(model, row, column, range), depth, 1e-6);
    }
  }
}

TEST(DepthCamera, ZeroNegativeAndNoNumberAreNoDepths) {
  SmallImage<float> image("32FC1");
  image.Set(1, 0, -1.0f);
  image.Set(1, 1, NAN);
  image.Set(1, 2, 3.0f);
  const std::vector<float> ranges = RowRanges(image.message, SmallModel(), 1);
  EXPECT_TRUE(std::isnan(ranges[0]) && std::isnan(ranges[2]) && std::isnan(ranges[3]));
  EXPECT_FLOAT_EQ(ranges[1], 3.0f * std::sqrt(1.25f));
}

TEST(DepthCamera, BytesMayComeInEitherOrder) {
  SmallImage<uint16_t> image("16UC1");
  image.Set(0, 1, 0xe803);  // 1000 with its bytes exchanged
  image.message.is_big_endian = true;
  EXPECT_FLOAT_EQ(RowRanges(image.message, SmallModel(), 0)[2], std::sqrt(17.0f / 16.0f));
}

TEST(DepthCamera, OtherEncodingsHoldNoDepths) {
  EXPECT_TRUE(HoldsDepths(SmallImage<uint16_t>("16UC1").message));
  EXPECT_TRUE(HoldsDepths(SmallImage<float>("32FC1").message));
  EXPECT_FALSE(HoldsDepths(SmallImage<uint16_t>("mono16").message));
}

TEST(DepthCamera, UsedRowsAreSpreadEvenly) {
  const PinholeModel model = ModelOf(320, 240, 1.0, 0.75);
  EXPECT_EQ(ImageRow(model, 0, 20), 6);
  EXPECT_EQ(ImageRow(model, 1, 20), 18);
  EXPECT_EQ(ImageRow(model, 19, 20), 234);
  for (int row = 0; row < 240; ++row) EXPECT_EQ(ImageRow(model, row, 240), row);
}

// From edge to edge: half a pixel beyond the middles of the first and the last.
TEST(DepthCamera, ModelHasTheAnglesThatAreStated) {
  const PinholeModel model = ModelOf(320, 240, 1.0, 0.75);
  EXPECT_DOUBLE_EQ(2.0 * std::atan((model.centre_x + 0.5) / model.focal_x), 1.0);
  EXPECT_DOUBLE_EQ(2.0 * std::atan((model.centre_y + 0.5) / model.focal_y), 0.75);
}

}  // namespace
}  // namespace plumbline
