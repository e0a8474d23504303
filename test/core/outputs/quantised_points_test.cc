#include "core/outputs/quantised_points.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <random>

namespace plumbline {
namespace {

using ::testing::ElementsAre;

// The points as the page reads them.
struct Unpacked {
  std::map<std::string, std::vector<int>> fields;
  nlohmann::json header;
};

int SignedOf(int code) { return code % 2 == 0 ? code / 2 : -(code + 1) / 2; }

Unpacked Unpack(const QuantisedPoints& points) {
  std::map<std::string, std::vector<uint8_t>> sections;
  for (const DataSection& section : points.Sections()) sections[section.name] = section.bytes;
  Unpacked unpacked;
  unpacked.header = nlohmann::json::parse(points.HeaderJson());
  for (const char* field : {"x", "y", "z", "time", "plane"}) {
    const auto& low = sections.at(std::string("points-") + field + "-0");
    const auto& high = sections.at(std::string("points-") + field + "-1");
    EXPECT_EQ(low.size(), high.size());
    int value = 0;
    for (size_t i = 0; i < low.size(); ++i) {
      value = (value + SignedOf(low[i] + 256 * high[i]) + 65536) % 65536;
      unpacked.fields[field].push_back(value);
    }
  }
  for (const uint8_t scanner : sections.at("points-scanner-0")) {
    unpacked.fields["scanner"].push_back(scanner);
  }
  return unpacked;
}

std::vector<MapPoint> RandomPoints(size_t count, float extent_m) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> place(-extent_m / 2.0f, extent_m / 2.0f);
  std::vector<MapPoint> points(count);
  for (size_t i = 0; i < count; ++i) {
    points[i].p_world = {place(random), 0.3f * place(random), 0.1f * place(random)};
    points[i].time_s = 0.01 * static_cast<double>(i);
    points[i].scanner = static_cast<int>(i % 3);
  }
  return points;
}

void ExpectSamePlaces(const std::vector<MapPoint>& points, const Unpacked& unpacked) {
  const double step_m = unpacked.header["step_m"];
  const double time_step_s = unpacked.header["time_step_s"];
  ASSERT_EQ(unpacked.fields.at("x").size(), points.size());
  for (size_t i = 0; i < points.size(); ++i) {
    int axis = 0;
    for (const char* field : {"x", "y", "z"}) {
      const double place = unpacked.header["origin"][static_cast<size_t>(axis)].get<double>() +
                           step_m * unpacked.fields.at(field)[i];
      EXPECT_NEAR(place, points[i].p_world[axis], 0.501 * step_m);
      ++axis;
    }
    EXPECT_NEAR(time_step_s * unpacked.fields.at("time")[i], points[i].time_s, time_step_s);
    EXPECT_EQ(unpacked.fields.at("scanner")[i], points[i].scanner);
  }
}

TEST(QuantisedPoints, AreReadBackWithinHalfAStep) {
  for (const float extent_m : {0.0f, 10.0f, 500.0f}) {
    const std::vector<MapPoint> points = RandomPoints(1000, extent_m);
    const Unpacked unpacked = Unpack({points, std::vector<uint16_t>(points.size(), 0)});
    EXPECT_LE(unpacked.header["step_m"].get<double>(), std::max(0.0005, extent_m / 65000.0));
    ExpectSamePlaces(points, unpacked);
  }
}

TEST(QuantisedPoints, KeepTheirSurfaces) {
  const std::vector<uint16_t> fields = {QuantisedPoints::kOnNoPlane, 65535, 2, 3, 1, 40000, 5};
  const Unpacked unpacked = Unpack({RandomPoints(fields.size(), 5.0f), fields});
  EXPECT_THAT(unpacked.fields.at("plane"), ElementsAre(0, 65535, 2, 3, 1, 40000, 5));
}

TEST(QuantisedPoints, ASelectionIsEven) {
  const std::vector<MapPoint> points = RandomPoints(1000, 5.0f);
  const QuantisedPoints all(points, std::vector<uint16_t>(points.size(), 0));
  const QuantisedPoints selection = all.Selection(250);
  EXPECT_EQ(selection.size(), 250);
  std::vector<MapPoint> expected;
  for (size_t i = 0; i < points.size(); i += 4) expected.push_back(points[i]);
  ExpectSamePlaces(expected, Unpack(selection));
  EXPECT_EQ(all.Selection(5000).size(), 1000);
  EXPECT_EQ(all.Selection(0).size(), 0);
}

TEST(QuantisedPoints, MayBeNone) {
  const Unpacked unpacked = Unpack({{}, {}});
  EXPECT_EQ(unpacked.header["count"], 0);
  EXPECT_TRUE(unpacked.fields.empty());
}

}  // namespace
}  // namespace plumbline
