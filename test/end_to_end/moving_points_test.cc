// Points on somebody who walks through a room are marked in the map, and points on the walls
// are not.

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "core/result/point_buffer.h"
#include "core/result/result_reader.h"
#include "test/testing/scenario.h"

namespace plumbline {
namespace {

struct Point {
  Eigen::Vector3d p;
  int plane_id = 0;
};

// map.ply's records, see PointBuffer.
std::vector<Point> ReadPoints(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(file)), {});
  const std::string end = "end_header\n";
  std::vector<Point> points;
  for (size_t at = bytes.find(end) + end.size(); at < bytes.size();
       at += PointBuffer::kPointBytes) {
    float xyz[3];
    int32_t plane_id = 0;
    std::memcpy(xyz, bytes.data() + at, sizeof(xyz));
    std::memcpy(&plane_id,
                bytes.data() + at + sizeof(xyz) + sizeof(double) + sizeof(uint8_t),
                sizeof(plane_id));
    points.push_back({{xyz[0], xyz[1], xyz[2]}, plane_id});
  }
  return points;
}

class MovingPointsTest : public MappingTest {
 protected:
  Summary MapRoom(const std::string& moving) {
    Scenario scenario;
    scenario.building = HexagonalRoom();
    scenario.scanners = TiltedRig();
    scenario.path = HexagonWalk(8.0, 0.8);
    scenario.more = moving;
    WriteRecording(Simulate(scenario));
    return Map();
  }
};

TEST_F(MovingPointsTest, SomebodyWhoWalksIsMarked) {
  const Summary summary =
      MapRoom("moving:\n  people: [{walks: [[2.5, 2.5], [5.5, 2.5]], speed_m_s: 1.0}]\n");
  EXPECT_EQ(summary.consistency.verdict, Verdict::kConsistent);
  const std::vector<PlanePatch> planes = ReadPlanes(Path("result/planes.json"));
  int64_t num_moving = 0;
  int64_t num_at_surfaces = 0;
  for (const Point& point : ReadPoints(Path("result/map.ply"))) {
    const bool is_marked = point.plane_id == kMovingPlaneId;
    bool is_at_surface = false;
    for (const PlanePatch& plane : planes) {
      is_at_surface = is_at_surface || plane.SignedDistance(point.p) < 0.15;
    }
    if (is_marked) ++num_moving;
    if (is_marked && is_at_surface) ++num_at_surfaces;
  }
  EXPECT_EQ(num_moving, summary.points_moving);
  EXPECT_GT(num_moving, 500);
  EXPECT_LT(num_at_surfaces, num_moving / 20);
}

TEST_F(MovingPointsTest, InAnEmptyRoomNothingMoves) {
  const Summary summary = MapRoom("");
  EXPECT_LT(summary.points_moving, summary.points / 1000);
}

}  // namespace
}  // namespace plumbline
