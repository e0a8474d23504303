#include "core/first_planes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace plumbline {
namespace {

constexpr double kDegree = M_PI / 180.0;

// The scanner at the origin looks along a wall, y = 1 m, and at a face that begins at its
// edge, x = 3 m. Both are seen in the scan plane and above it.
class FirstPlanesTest : public ::testing::Test {
 protected:
  FirstPlanesTest() {
    line_.angle_min = 10.0 * kDegree;
    line_.angle_increment = 0.1 * kDegree;
    scanner_.range_noise_m = 0.03;
  }

  static Landmark Wall(const Eigen::Vector3d& normal,
                       const Eigen::Vector3d& from,
                       const Eigen::Vector3d& to) {
    Landmark wall = MakeVerticalLandmark(normal, from);
    wall.extent.AddSegment(from, to);
    wall.extent.AddSegment(from + Eigen::Vector3d::UnitZ(), to + Eigen::Vector3d::UnitZ());
    return wall;
  }
  double AngleOf(int beam) const { return line_.BeamAngle(beam); }
  std::vector<FirstPlanes::Run> Runs(const Landmark& wall, const Landmark& face) const {
    const PlaneSet planes({LandmarkCandidate(wall), LandmarkCandidate(face)});
    const std::vector<PlaneOpenings> openings(2);
    std::vector<FirstPlanes::Run> runs =
        FirstPlanes(line_, scanner_, placement_, planes, openings)
            .RunsWithin(1, line_.num_beams() - 2);
    for (FirstPlanes::Run& run : runs) {
      run.plane = nullptr;  // gone with the set
      is_on_face_.push_back(std::abs(run.trace.normal.x()) > 0.5);
    }
    return runs;
  }

  ScanLine line_;
  Scanner scanner_;
  ScanPlacement placement_ =
      ScanPlacement::Identity() - Eigen::Vector3d::UnitZ() * Eigen::RowVector3d::UnitZ();
  mutable std::vector<bool> is_on_face_;
};

// The wall runs on behind the face's line. Beams that just miss the face end on the wall, too
// close behind for their ranges to tell.
TEST_F(FirstPlanesTest, AFaceTakesNoBeamsThatPassItsEdge) {
  Landmark wall = Wall({0.0, -1.0, 0.0}, {3.0, 1.0, -0.1}, {6.0, 1.0, -0.1});
  Landmark face = Wall({-1.0, 0.0, 0.0}, {3.0, 1.0, -0.1}, {3.0, 1.4, -0.1});
  face.id = 1;
  for (int beam = 0; beam < 140; ++beam) {
    const double angle = AngleOf(beam);
    line_.ranges.push_back(
        static_cast<float>(std::max(1.0 / std::sin(angle), 3.0 / std::cos(angle))));
  }
  const std::vector<FirstPlanes::Run> runs = Runs(wall, face);
  ASSERT_EQ(runs.size(), 2u);
  EXPECT_FALSE(is_on_face_[0]);
  EXPECT_TRUE(is_on_face_[1]);
  EXPECT_GT(3.0 * std::tan(AngleOf(runs[1].first_beam)), 1.04);
  EXPECT_LT(3.0 * std::tan(AngleOf(runs[1].first_beam)), 1.08);
}

// Where the wall ends at the face, all beams of both count.
TEST_F(FirstPlanesTest, InACornerAllBeamsCount) {
  Landmark wall = Wall({0.0, -1.0, 0.0}, {1.0, 1.0, -0.1}, {3.0, 1.0, -0.1});
  Landmark face = Wall({-1.0, 0.0, 0.0}, {3.0, 0.0, -0.1}, {3.0, 1.0, -0.1});
  face.id = 1;
  for (int beam = 0; beam < 140; ++beam) {
    const double angle = AngleOf(beam);
    line_.ranges.push_back(
        static_cast<float>(std::min(1.0 / std::sin(angle), 3.0 / std::cos(angle))));
  }
  const std::vector<FirstPlanes::Run> runs = Runs(wall, face);
  ASSERT_EQ(runs.size(), 2u);
  EXPECT_TRUE(is_on_face_[0]);
  EXPECT_FALSE(is_on_face_[1]);
  EXPECT_EQ(runs[0].last_beam + 1, runs[1].first_beam);
}

}  // namespace
}  // namespace plumbline
