#include "core/visibility/beam_association.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/surface/landmark_view.h"

namespace plumbline {
namespace {

constexpr double kDegree = M_PI / 180.0;

// The scanner at the origin looks along a wall, y = 1 m, and at a face that begins at its
// edge, x = 3 m. Both are seen in the scan plane and above it.
class BeamAssociationTest : public ::testing::Test {
 protected:
  BeamAssociationTest() {
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
  // range_of: an angle.
  template <typename RangeOf>
  void See(const RangeOf& range_of) {
    for (int beam = 0; beam < 140; ++beam) {
      line_.ranges.push_back(static_cast<float>(range_of(line_.BeamAngle(beam))));
    }
  }

  struct OnPlane {
    bool is_on_face;
    int first_beam;
    int last_beam;
  };
  std::vector<OnPlane> Associate(const Landmark& wall, Landmark face) const {
    face.id = 1;
    const PlaneSet planes({LandmarkView(wall), LandmarkView(face)});
    const std::vector<PlaneOpenings> openings(2);
    const BeamAssociation association(line_, scanner_, placement_, planes, openings);
    std::vector<OnPlane> found;
    for (const BeamAssociation::PlaneBeams& beams :
         association.Associate(1, line_.num_beams() - 2)) {
      found.push_back({beams.plane->landmark == &face, beams.first_beam, beams.last_beam});
    }
    return found;
  }

  ScanLine line_;
  Scanner scanner_;
  ScanPlacement placement_ =
      ScanPlacement::Identity() - Eigen::Vector3d::UnitZ() * Eigen::RowVector3d::UnitZ();
};

// The wall runs on behind the face's line. Beams that just miss the face end on the wall, too
// close behind for their ranges to tell; where it meets the face's plane tells. Where it has
// not been seen there, the edge is known to centimetres only.
TEST_F(BeamAssociationTest, RoundAnEdgeBeamsAreToldByWhereThePlanesMeet) {
  const auto y_on_face = [&](int beam) { return 3.0 * std::tan(line_.BeamAngle(beam)); };
  const Landmark face = Wall({-1.0, 0.0, 0.0}, {3.0, 0.99, -0.1}, {3.0, 1.4, -0.1});
  See([](double angle) { return std::max(1.0 / std::sin(angle), 3.0 / std::cos(angle)); });
  for (const double seen_from_x : {3.0, 4.0}) {
    const Landmark wall = Wall({0.0, -1.0, 0.0}, {seen_from_x, 1.0, -0.1}, {6.0, 1.0, -0.1});
    const std::vector<OnPlane> found = Associate(wall, face);
    ASSERT_EQ(found.size(), 2u);
    EXPECT_FALSE(found[0].is_on_face);
    EXPECT_TRUE(found[1].is_on_face);
    const double first_y = y_on_face(found[1].first_beam);
    if (seen_from_x == 3.0) {
      EXPECT_EQ(found[0].last_beam + 1, found[1].first_beam);
      EXPECT_LT(y_on_face(found[0].last_beam), 1.0);
      EXPECT_GT(first_y, 1.0);
    } else {
      EXPECT_GT(first_y, 1.04);
      EXPECT_LT(first_y, 1.08);
    }
  }
}

// Where the wall ends at the face, all beams of both count.
TEST_F(BeamAssociationTest, InACornerAllBeamsCount) {
  const Landmark wall = Wall({0.0, -1.0, 0.0}, {1.0, 1.0, -0.1}, {3.0, 1.0, -0.1});
  const Landmark face = Wall({-1.0, 0.0, 0.0}, {3.0, 0.0, -0.1}, {3.0, 1.0, -0.1});
  See([](double angle) { return std::min(1.0 / std::sin(angle), 3.0 / std::cos(angle)); });
  const std::vector<OnPlane> found = Associate(wall, face);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_TRUE(found[0].is_on_face);
  EXPECT_FALSE(found[1].is_on_face);
  EXPECT_EQ(found[0].last_beam + 1, found[1].first_beam);
}

// A beam that meets the wall at half a degree tells as much of it as thousands of others. The
// next one passes by: where the wall goes on, its trace tells.
TEST_F(BeamAssociationTest, ABeamAlmostAlongAWallCounts) {
  line_.angle_min = -0.5 * kDegree;
  line_.angle_increment = kDegree;
  line_.ranges = {9.0f, static_cast<float>(0.02 / std::sin(0.5 * kDegree)), 9.0f};
  const Landmark wall = Wall({0.0, -1.0, 0.0}, {1.0, 0.02, -0.1}, {4.0, 0.02, -0.1});
  const Landmark elsewhere = Wall({-1.0, 0.0, 0.0}, {20.0, 5.0, -0.1}, {20.0, 6.0, -0.1});
  const std::vector<OnPlane> found = Associate(wall, elsewhere);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].first_beam, 1);
  EXPECT_EQ(found[0].last_beam, 1);
  const Landmark ends_there = Wall({0.0, -1.0, 0.0}, {1.0, 0.02, -0.1}, {2.3, 0.02, -0.1});
  EXPECT_TRUE(Associate(ends_there, elsewhere).empty()) << "7 cm from a free edge";
}

}  // namespace
}  // namespace plumbline
