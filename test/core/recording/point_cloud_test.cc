#include "core/recording/point_cloud.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "test/core/recording/cdr_text.h"

namespace plumbline {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr int64_t kStampNs = 1'600'000'000'000'000'000;
constexpr uint8_t kUint32 = 6, kFloat32 = 7, kFloat64 = 8;

struct CloudPoint {
  double angle;
  double range;
  double time_s = 0.0;
  double z = 0.0;
};

// A cloud as it is written; what a test does not name is as drivers write it.
struct Cloud {
  std::vector<CloudPoint> points;
  uint8_t coordinate_type = kFloat32;
  std::string time_name;  // empty: no times
  uint8_t time_type = kFloat32;
  std::function<double(double)> time_as_written = [](double time_s) { return time_s; };
  bool is_big_endian = false;
  int missing_bytes = 0;
  uint32_t width_factor = 1;
};

template <typename Number>
void Append(double value, bool is_big_endian, std::vector<uint8_t>* bytes) {
  const auto number = static_cast<Number>(value);
  uint8_t ordered[sizeof(Number)];
  std::memcpy(ordered, &number, sizeof(Number));
  if (is_big_endian) std::reverse(std::begin(ordered), std::end(ordered));
  bytes->insert(bytes->end(), std::begin(ordered), std::end(ordered));
}

void Append(uint8_t type, double value, bool is_big_endian, std::vector<uint8_t>* bytes) {
  if (type == kUint32) Append<uint32_t>(value, is_big_endian, bytes);
  if (type == kFloat32) Append<float>(value, is_big_endian, bytes);
  if (type == kFloat64) Append<double>(value, is_big_endian, bytes);
}

bool Read(const Cloud& cloud, ScanLineMessage* message, bool with_ranges = true) {
  const uint32_t size = cloud.coordinate_type == kFloat64 ? 8 : 4;
  std::vector<uint8_t> data;
  for (const CloudPoint& point : cloud.points) {
    for (const double value :
         {point.range * std::cos(point.angle), point.range * std::sin(point.angle), point.z}) {
      Append(cloud.coordinate_type, value, cloud.is_big_endian, &data);
    }
    if (cloud.time_name.empty()) continue;
    Append(cloud.time_type, cloud.time_as_written(point.time_s), cloud.is_big_endian, &data);
  }
  const auto num_points = static_cast<uint32_t>(cloud.points.size());
  const uint32_t step =
      num_points > 0 ? static_cast<uint32_t>(data.size()) / num_points : 3 * size;
  data.resize(data.size() - static_cast<size_t>(cloud.missing_bytes));
  CdrText text(cloud.is_big_endian);
  text.Add(int32_t{1'600'000'000}).Add(uint32_t{0}).Add(std::string("laser"));
  text.Add(uint32_t{1}).Add(num_points * cloud.width_factor);
  text.Add(uint32_t{cloud.time_name.empty() ? 3u : 4u});
  uint32_t offset = 0;
  const auto add_field = [&](const std::string& name, uint8_t type) {
    text.Add(name).Add(offset).Add(type).Add(uint32_t{1});
    offset += type == kFloat64 ? 8 : 4;
  };
  for (const char* name : {"x", "y", "z"}) add_field(name, cloud.coordinate_type);
  if (!cloud.time_name.empty()) add_field(cloud.time_name, cloud.time_type);
  text.Add(static_cast<uint8_t>(cloud.is_big_endian)).Add(step).Add(step * num_points);
  text.AddBytes(data).Add(uint8_t{1});
  SerialReader reader;
  return SerialReader::ForCdr(text.view(), &reader) &&
         ReadPointCloud2(reader, with_ranges, message);
}

// Beams 0.1 rad and 1 ms apart, beam b at 1 + 0.1 b m; those that are left out have no return.
Cloud RegularCloud(int num_beams, const std::vector<int>& left_out = {}) {
  Cloud cloud;
  for (int beam = 0; beam < num_beams; ++beam) {
    if (std::count(left_out.begin(), left_out.end(), beam) > 0) continue;
    cloud.points.push_back({-1.0 + 0.1 * beam, 1.0 + 0.1 * beam, 0.001 * beam});
  }
  return cloud;
}

void ExpectRegular(const ScanLineMessage& message, int num_beams, bool has_times) {
  EXPECT_TRUE(message.IsUsable());
  EXPECT_THAT(message.angles, IsEmpty());
  EXPECT_NEAR(message.angle_min, -1.0, 1e-6);
  EXPECT_NEAR(message.angle_increment, 0.1, 1e-6);
  EXPECT_NEAR(message.time_increment, has_times ? 0.001 : 0.0, 1e-8);
  EXPECT_NEAR(static_cast<double>(message.stamp_ns - kStampNs), 0.0, 1000.0);
  ASSERT_THAT(message.ranges, SizeIs(static_cast<size_t>(num_beams)));
}

TEST(PointCloudTest, WithoutTimesAllIsMeasuredAtOnce) {
  ScanLineMessage message;
  ASSERT_TRUE(Read(RegularCloud(20, {4, 5, 11}), &message));
  ExpectRegular(message, 20, false);
  for (int beam = 0; beam < 20; ++beam) {
    const float range = message.ranges[static_cast<size_t>(beam)];
    if (beam == 4 || beam == 5 || beam == 11) {
      EXPECT_TRUE(std::isnan(range)) << beam;
    } else {
      EXPECT_NEAR(range, 1.0 + 0.1 * beam, 1e-6);
    }
  }
  EXPECT_TRUE(message.is_planar);
}

TEST(PointCloudTest, TimesMayBeWrittenInManyWays) {
  struct Way {
    const char* name;
    uint8_t type;
    std::function<double(double)> as_written;
  };
  for (const Way& way :
       {Way{"time", kFloat32, [](double t) { return t; }},
        Way{"t", kUint32, [](double t) { return t * 1e9 + 0.5; }},
        Way{"timestamp", kFloat64, [](double t) { return 1.6e9 + t; }},
        Way{"timestamp", kFloat64, [](double t) { return 1.6e18 + t * 1e9; }},
        Way{"time_offset", kFloat64, [](double t) { return t; }},
        Way{"offset_time", kUint32, [](double t) { return t * 1e9 + 0.5; }}}) {
    for (const bool is_big_endian : {false, true}) {
      Cloud cloud = RegularCloud(20, {7});
      cloud.time_name = way.name;
      cloud.time_type = way.type;
      cloud.time_as_written = way.as_written;
      cloud.is_big_endian = is_big_endian;
      cloud.coordinate_type = way.type == kFloat64 ? kFloat64 : kFloat32;
      ScanLineMessage message;
      ASSERT_TRUE(Read(cloud, &message)) << way.name;
      ExpectRegular(message, 20, true);
    }
  }
}

// Velodyne's newer drivers stamp a cloud with the time of its last point.
TEST(PointCloudTest, TimesBeforeTheStampMoveIt) {
  Cloud cloud = RegularCloud(20);
  cloud.time_name = "time";
  cloud.time_as_written = [](double time_s) { return time_s - 0.019; };
  ScanLineMessage message;
  ASSERT_TRUE(Read(cloud, &message));
  EXPECT_NEAR(static_cast<double>(message.stamp_ns - kStampNs), -19e6, 1000.0);
}

// The scanner's uptime, or a simulator's time: another clock than the stamp's.
TEST(PointCloudTest, TimesOfAnotherClockCountFromTheFirst) {
  for (const double clock_s : {37.0, 5000.0, 86'400.0}) {
    Cloud cloud = RegularCloud(20);
    cloud.time_name = "timestamp";
    cloud.time_type = kFloat64;
    cloud.time_as_written = [clock_s](double time_s) { return clock_s + time_s; };
    ScanLineMessage message;
    ASSERT_TRUE(Read(cloud, &message));
    EXPECT_NEAR(static_cast<double>(message.stamp_ns - kStampNs), 0.0, 1e3);
    EXPECT_NEAR(message.time_increment, 0.001, 1e-6);
  }
}

TEST(PointCloudTest, PointsMayComeInAnyOrder) {
  for (const char* time_name : {"", "time"}) {
    Cloud cloud = RegularCloud(20, {3});
    cloud.time_name = time_name;
    std::swap(cloud.points[2], cloud.points[9]);
    std::swap(cloud.points[0], cloud.points[17]);
    ScanLineMessage message;
    ASSERT_TRUE(Read(cloud, &message));
    ExpectRegular(message, 20, cloud.time_name == "time");
    EXPECT_NEAR(message.ranges[9], 1.9, 1e-6);
  }
}

TEST(PointCloudTest, BeamsMayGoRoundClockwiseAndAcrossTheBack) {
  Cloud cloud;
  for (int beam = 0; beam < 50; ++beam) cloud.points.push_back({-2.0 - 0.1 * beam, 3.0});
  ScanLineMessage message;
  ASSERT_TRUE(Read(cloud, &message));
  EXPECT_TRUE(message.IsUsable());
  EXPECT_THAT(message.angles, IsEmpty());
  EXPECT_NEAR(message.angle_min, -2.0, 1e-6);
  EXPECT_NEAR(message.angle_increment, -0.1, 1e-6);
}

TEST(PointCloudTest, FirstOfTwoPointsInOneDirectionCounts) {
  Cloud cloud = RegularCloud(20);
  cloud.points.insert(cloud.points.begin() + 6, {cloud.points[5].angle, 9.0, 0.005});
  ScanLineMessage message;
  ASSERT_TRUE(Read(cloud, &message));
  ExpectRegular(message, 20, false);
  EXPECT_NEAR(message.ranges[5], 1.5, 1e-6);
}

// Regular in time, the gap is known; else the points are neighbours.
TEST(PointCloudTest, GapsOfIrregularBeamsAreFilledWhereTimesShowThem) {
  Cloud cloud;
  for (int beam = 0; beam < 20; ++beam) {
    if (beam == 7) continue;
    cloud.points.push_back(
        {-1.0 + 0.1 * beam + 0.03 * std::sin(2.0 * beam), 2.0, 0.001 * beam});
  }
  ScanLineMessage message;
  ASSERT_TRUE(Read(cloud, &message));
  EXPECT_THAT(message.angles, SizeIs(19));
  EXPECT_TRUE(message.IsUsable());
  cloud.time_name = "time";
  ASSERT_TRUE(Read(cloud, &message));
  ASSERT_THAT(message.angles, SizeIs(20));
  EXPECT_TRUE(std::isnan(message.ranges[7]));
  EXPECT_GT(message.angles[7], message.angles[6]);
  EXPECT_LT(message.angles[7], message.angles[8]);
  EXPECT_NEAR(message.angles[8], -0.2 + 0.03 * std::sin(16.0), 1e-6);
  EXPECT_TRUE(message.IsUsable());
}

TEST(PointCloudTest, WhatIsNoScanLineIsNotUsable) {
  ScanLineMessage message;
  Cloud tilted = RegularCloud(20);
  for (CloudPoint& point : tilted.points) point.z = 0.1 * point.range;
  ASSERT_TRUE(Read(tilted, &message));
  EXPECT_FALSE(message.is_planar);

  Cloud back_and_forth = RegularCloud(20);
  back_and_forth.time_name = "time";
  std::swap(back_and_forth.points[3].angle, back_and_forth.points[12].angle);
  ASSERT_TRUE(Read(back_and_forth, &message));
  EXPECT_TRUE(message.is_planar);
  EXPECT_FALSE(message.IsUsable());

  Cloud ever_slower = RegularCloud(20);
  ever_slower.time_name = "time";
  for (CloudPoint& point : ever_slower.points)
    point.time_s += 400.0 * point.time_s * point.time_s;
  ASSERT_TRUE(Read(ever_slower, &message));
  EXPECT_FALSE(message.IsUsable());

  for (const int num_points : {0, 1}) {
    ASSERT_TRUE(Read(RegularCloud(num_points), &message));
    EXPECT_FALSE(message.IsUsable()) << num_points;
  }
}

TEST(PointCloudTest, PointsWithoutAReturnAreLeftOut) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Cloud cloud = RegularCloud(20);
  cloud.points[5].range = nan;
  cloud.points[6].range = 0.0;
  cloud.points[7].z = nan;
  ScanLineMessage message;
  ASSERT_TRUE(Read(cloud, &message));
  ExpectRegular(message, 20, false);
  for (size_t beam = 5; beam < 8; ++beam) EXPECT_TRUE(std::isnan(message.ranges[beam]));
}

TEST(PointCloudTest, LengthsThatContradictEachOtherAreRefused) {
  ScanLineMessage message;
  Cloud cloud = RegularCloud(20);
  cloud.missing_bytes = 1;
  EXPECT_FALSE(Read(cloud, &message));
  cloud = RegularCloud(20);
  cloud.width_factor = 2;
  EXPECT_FALSE(Read(cloud, &message));
  cloud.width_factor = 200'000'000;  // beyond 32 bits
  EXPECT_FALSE(Read(cloud, &message));
  cloud = RegularCloud(20);
  cloud.coordinate_type = 9;
  EXPECT_FALSE(Read(cloud, &message));
}

TEST(PointCloudTest, WithoutRangesTheRestIsTheSame) {
  ScanLineMessage message;
  ASSERT_TRUE(Read(RegularCloud(20, {3}), &message, false));
  EXPECT_THAT(message.ranges, IsEmpty());
  EXPECT_EQ(message.num_beams, 20u);
  EXPECT_TRUE(message.IsUsable());
}

}  // namespace
}  // namespace plumbline
