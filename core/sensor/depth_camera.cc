#include "core/sensor/depth_camera.h"

#include <glog/logging.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/recording/messages.h"
#include "core/recording/serial_reader.h"

namespace plumbline {
namespace {

// Slope of a row's plane against the optical axis, downwards.
double RowSlope(const PinholeModel& model, int row) {
  return (row - model.centre_y) / model.focal_y;
}

// Slope of a column's direction, to the right.
double ColumnSlope(const PinholeModel& model, int column) {
  return (column - model.centre_x) / model.focal_x;
}

size_t PixelSize(const ImageMessage& image) {
  return image.encoding == "16UC1" ? sizeof(uint16_t) : sizeof(float);
}

// m; NaN where there is none.
double DepthAt(const ImageMessage& image, const uint8_t* pixel) {
  if (image.encoding == "16UC1") {
    const auto depth_mm = NumberAt<uint16_t>(pixel, image.is_big_endian);
    return depth_mm == 0 ? std::numeric_limits<double>::quiet_NaN() : 1e-3 * depth_mm;
  }
  const auto depth_m = NumberAt<float>(pixel, image.is_big_endian);
  return depth_m > 0.0f ? depth_m : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

PinholeModel ModelOf(int width, int height, double across_rad, double upright_rad) {
  return {width,
          height,
          0.5 * width / std::tan(0.5 * across_rad),
          0.5 * height / std::tan(0.5 * upright_rad),
          0.5 * (width - 1),
          0.5 * (height - 1)};
}

int ImageRow(const PinholeModel& model, int used_row, int num_rows) {
  return (2 * used_row + 1) * model.height / (2 * num_rows);
}

Rigid3d CameraFromRow(const PinholeModel& model, int row) {
  const Eigen::Vector3d ahead = Eigen::Vector3d(0.0, RowSlope(model, row), 1.0).normalized();
  const Eigen::Vector3d left = -Eigen::Vector3d::UnitX();
  Eigen::Matrix3d axes;
  axes << ahead, left, ahead.cross(left);
  return {Eigen::Quaterniond(axes), Eigen::Vector3d::Zero()};
}

std::vector<float> RowAngles(const PinholeModel& model, int row) {
  const double ahead = std::hypot(1.0, RowSlope(model, row));
  std::vector<float> angles;
  for (int column = model.width - 1; column >= 0; --column) {
    angles.push_back(static_cast<float>(std::atan2(-ColumnSlope(model, column), ahead)));
  }
  return angles;
}

bool HoldsDepths(const ImageMessage& image) {
  return image.encoding == "16UC1" || image.encoding == "32FC1";
}

size_t BytesOfRow(const ImageMessage& image) { return PixelSize(image) * image.width; }

std::vector<float> RowRanges(const ImageMessage& image, const PinholeModel& model, int row) {
  CHECK(HoldsDepths(image)) << image.encoding;
  CHECK_EQ(static_cast<int>(image.width), model.width);
  CHECK_LE(size_t{image.row_bytes} * static_cast<size_t>(row + 1), image.data.size);
  const size_t pixel_size = PixelSize(image);
  const uint8_t* pixels = image.data.data + size_t{image.row_bytes} * static_cast<size_t>(row);
  const double slope = RowSlope(model, row);
  std::vector<float> ranges;
  for (int column = model.width - 1; column >= 0; --column) {
    const double depth_m = DepthAt(image, pixels + pixel_size * static_cast<size_t>(column));
    ranges.push_back(
        static_cast<float>(depth_m * std::hypot(1.0, slope, ColumnSlope(model, column))));
  }
  return ranges;
}

double DepthOf(const PinholeModel& model, int row, int column, double range_m) {
  return range_m / std::hypot(1.0, RowSlope(model, row), ColumnSlope(model, column));
}

}  // namespace plumbline
