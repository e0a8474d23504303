#include "core/result/plane_covariance.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/result/result_reader.h"
#include "core/result/result_text.h"
#include "core/util/atomic_file.h"
#include "core/util/error.h"
#include "test/testing/temporary_directory.h"

namespace plumbline {
namespace {

PlanePatch Wall(int id, double angle, double distance) {
  PlanePatch wall;
  wall.id = id;
  wall.type = PlaneType::kVertical;
  wall.normal = {std::cos(angle), std::sin(angle), 0.0};
  wall.distance = distance;
  wall.centre = distance * wall.normal;
  return wall;
}

PlanePatch Floor(int id, double height) {
  PlanePatch floor;
  floor.id = id;
  floor.type = PlaneType::kHorizontal;
  floor.normal = Eigen::Vector3d::UnitZ();
  floor.distance = height;
  floor.centre = {0.0, 0.0, height};
  return floor;
}

PlanePatch Roof(int id) {
  PlanePatch roof;
  roof.id = id;
  roof.type = PlaneType::kGeneral;
  roof.normal = {-0.48, 0.36, -0.8};
  roof.centre = {3.0, -2.0, 2.5};
  roof.distance = roof.normal.dot(roof.centre);
  return roof;
}

// A plane as its three parameters have it: turns of the normal, and a shift at the centre.
PlanePatch Turned(const PlanePatch& plane, const Eigen::Vector3d& error) {
  PlanePatch turned = plane;
  const Eigen::Vector3d u = Eigen::Vector3d::UnitZ().cross(plane.normal).normalized();
  turned.normal += error[0] * u + error[1] * plane.normal.cross(u);
  turned.normal.normalize();
  turned.distance = turned.normal.dot(plane.centre) + error[2];
  return turned;
}

// Two walls and a floor whose parameters all depend on each other.
PlaneCovariance Example() {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd root(5, 5);
  for (double& value : root.reshaped()) value = 1e-3 * normal(random);
  return PlaneCovariance({Wall(2, 0.3, -4.0), Floor(5, -1.5), Wall(9, 0.3 + M_PI, -2.0)},
                         root * root.transpose());
}

// Standard deviation of a quantity of the parameters, by drawing them.
template <typename Quantity>
double SampledStddev(const PlaneCovariance& example, Quantity quantity) {
  std::mt19937_64 random(4);
  std::normal_distribution<double> normal;
  const Eigen::MatrixXd root = example.covariance().llt().matrixL();
  double sum = 0.0;
  double sum_squares = 0.0;
  constexpr int kDraws = 20000;
  for (int draw = 0; draw < kDraws; ++draw) {
    Eigen::VectorXd white(5);
    for (double& value : white) value = normal(random);
    const Eigen::VectorXd error = root * white;
    const double value = quantity(Wall(2, 0.3 + error[0], -4.0 + error[1]),
                                  Wall(9, 0.3 + M_PI + error[3], -2.0 + error[4]));
    sum += value;
    sum_squares += value * value;
  }
  const double mean = sum / kDraws;
  return std::sqrt(sum_squares / kDraws - mean * mean);
}

// The sampled standard deviations are good to 1 / sqrt(2 * 20000) = 0.5 %: four sigmas.
constexpr double kTolerance = 0.02;

TEST(PlaneCovariance, AngleBetweenWalls) {
  const PlaneCovariance example = Example();
  const double expected = SampledStddev(example, [](const PlanePatch& a, const PlanePatch& b) {
    const double angle =
        std::atan2(b.normal.y(), b.normal.x()) - std::atan2(a.normal.y(), a.normal.x());
    return std::remainder(angle - M_PI, 2.0 * M_PI);
  });
  EXPECT_NEAR(example.AngleStddev(2, 9) / expected, 1.0, kTolerance);
  EXPECT_EQ(example.AngleStddev(2, 5), 0.0);
}

TEST(PlaneCovariance, DistanceOfAPoint) {
  const PlaneCovariance example = Example();
  const Eigen::Vector3d point(1.0, 7.0, 2.0);
  const double expected = SampledStddev(example, [&](const PlanePatch&, const PlanePatch& b) {
    return b.SignedDistance(point);
  });
  EXPECT_NEAR(example.DistanceStddev(point, 9) / expected, 1.0, kTolerance);
  EXPECT_NEAR(example.DistanceStddev(point, 5), std::sqrt(example.covariance()(2, 2)), 1e-12);
}

TEST(PlaneCovariance, SeparationOfWalls) {
  const PlaneCovariance example = Example();
  const Eigen::Vector3d point(-3.0, 5.0, 0.0);
  const double expected =
      SampledStddev(example, [&](const PlanePatch& a, const PlanePatch& b) {
        // Where the fixed line through the point, along the first wall's normal, meets it.
        const Eigen::Vector3d along(std::cos(0.3), std::sin(0.3), 0.0);
        const Eigen::Vector3d on_a =
            point - a.SignedDistance(point) / a.normal.dot(along) * along;
        return b.SignedDistance(on_a);
      });
  EXPECT_NEAR(example.SeparationStddev(point, 2, 9) / expected, 1.0, kTolerance);
}

TEST(PlaneCovariance, AngleAndDistanceOfARoof) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd root(5, 5);
  for (double& value : root.reshaped()) value = 1e-3 * normal(random);
  const PlaneCovariance example({Wall(2, 0.3, -4.0), Roof(7)}, root * root.transpose());
  const Eigen::Vector3d point(1.0, 7.0, 2.0);
  double sum_angles = 0.0;
  double sum_distances = 0.0;
  constexpr int kDraws = 20000;
  const auto angle_of = [](const PlanePatch& a, const PlanePatch& b) {
    return std::acos(a.normal.dot(b.normal));
  };
  for (int draw = 0; draw < kDraws; ++draw) {
    Eigen::VectorXd white(5);
    for (double& value : white) value = normal(random);
    const Eigen::VectorXd error = root * white;
    const PlanePatch wall = Wall(2, 0.3 + error[0], -4.0 + error[1]);
    const PlanePatch roof = Turned(Roof(7), error.tail<3>());
    sum_angles += std::pow(angle_of(wall, roof) - angle_of(Wall(2, 0.3, -4.0), Roof(7)), 2);
    sum_distances += std::pow(roof.SignedDistance(point) - Roof(7).SignedDistance(point), 2);
  }
  EXPECT_NEAR(example.AngleStddev(2, 7) / std::sqrt(sum_angles / kDraws), 1.0, kTolerance);
  EXPECT_NEAR(
      example.DistanceStddev(point, 7) / std::sqrt(sum_distances / kDraws), 1.0, kTolerance);
  EXPECT_EQ(example.AngleStddev(7, 7), 0.0);
}

// A column's half: radius 0.5 m about (4, 1), seen from the west and best known there.
PlanePatch Column(int id) {
  PlanePatch column;
  column.id = id;
  column.type = PlaneType::kCylinder;
  column.normal = {-1.0, 0.0, 0.0};
  column.curvature = 2.0;
  column.centre = {3.5, 1.0, 1.2};
  column.distance = column.normal.dot(column.centre);
  return column;
}

// A cylinder as its three parameters have it: turn of the normal at the centre, radius, and a
// shift along that normal.
PlanePatch Bent(const PlanePatch& cylinder, const Eigen::Vector3d& error) {
  PlanePatch bent = cylinder;
  const Eigen::Vector3d u = Eigen::Vector3d::UnitZ().cross(cylinder.normal);
  bent.normal = (cylinder.normal + error[0] * u).normalized();
  bent.curvature = std::copysign(1.0 / (cylinder.Radius() + error[1]), cylinder.curvature);
  bent.centre += error[2] * cylinder.normal;
  bent.distance = bent.normal.dot(bent.centre);
  return bent;
}

// Where a line through a point meets a surface, near the point.
Eigen::Vector3d Meet(const PlanePatch& surface,
                     Eigen::Vector3d point,
                     const Eigen::Vector3d& along) {
  for (int round = 0; round < 10; ++round) {
    point -= surface.SignedDistance(point) / surface.NormalAt(point).dot(along) * along;
  }
  return point;
}

// Measured where its normal is 60 degrees off that at the centre.
TEST(PlaneCovariance, SeparationOfAWallAndACurvedOne) {
  std::mt19937_64 random(6);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd root(5, 5);
  for (double& value : root.reshaped()) value = 1e-3 * normal(random);
  const Eigen::MatrixXd covariance = root * root.transpose();
  const PlaneCovariance example({Wall(2, 0.3, -4.0), Column(8)}, covariance);
  const Eigen::Vector3d point =
      Column(8).AxisPoint() +
      0.7 * Eigen::Vector3d(-std::cos(M_PI / 3), std::sin(M_PI / 3), 0);
  const auto separation = [&](const Eigen::VectorXd& error, bool from_column) {
    const PlanePatch wall = Wall(2, 0.3 + error[0], -4.0 + error[1]);
    const PlanePatch column = Bent(Column(8), error.tail<3>());
    if (from_column) {
      return wall.SignedDistance(Meet(column, point, Column(8).NormalAt(point)));
    }
    return column.SignedDistance(Meet(wall, point, Wall(2, 0.3, -4.0).normal));
  };
  for (const bool from_column : {true, false}) {
    Eigen::VectorXd derivative(5);
    for (int i = 0; i < 5; ++i) {
      const Eigen::VectorXd step = 1e-5 * Eigen::VectorXd::Unit(5, i);
      derivative[i] = (separation(step, from_column) - separation(-step, from_column)) / 2e-5;
    }
    const double expected = std::sqrt(derivative.dot(covariance * derivative));
    const double stated = from_column ? example.SeparationStddev(point, 8, 2)
                                      : example.SeparationStddev(point, 2, 8);
    EXPECT_NEAR(stated / expected, 1.0, 1e-6) << from_column;
  }
}

TEST(PlaneCovariance, LargestCorrelationIsFound) {
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Identity(5, 5);
  covariance(2, 4) = covariance(4, 2) = -0.9;  // floor and second wall's distance
  const PlaneCovariance example(
      {Wall(2, 0.3, -4.0), Floor(5, -1.5), Wall(9, 0.3 + M_PI, -2.0)}, covariance);
  const auto found = example.LargestCorrelations(1);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].plane_a, 5);
  EXPECT_EQ(found[0].plane_b, 9);
  EXPECT_FALSE(found[0].angle_a);
  EXPECT_FALSE(found[0].angle_b);
  EXPECT_NEAR(found[0].value, -0.9, 1e-12);
}

TEST(PlaneCovariance, UnknownPlaneIsAnError) {
  EXPECT_THROW(Example().AngleStddev(2, 3), Error);
}

class PlaneCovarianceFileTest : public TemporaryDirectoryTest {
 protected:
  void Write(const std::string& name, const std::string& text) {
    WriteFileAtomically((directory_ / name).string(), text);
  }
};

TEST_F(PlaneCovarianceFileTest, ReadsBackWhatIsWritten) {
  const PlaneCovariance example = Example();
  Write("planes.json", FormatPlanes(example.planes()));
  Write("plane_covariance.csv", FormatPlaneCovariance(example));
  const PlaneCovariance read = ReadPlaneCovariance(directory_.string());
  ASSERT_EQ(read.planes().size(), 3u);
  EXPECT_LT((read.covariance() - example.covariance()).norm(),
            1e-9 * example.covariance().norm());
}

TEST_F(PlaneCovarianceFileTest, ErrorsNameTheLine) {
  const PlaneCovariance example = Example();
  Write("planes.json", FormatPlanes(example.planes()));
  std::string text = FormatPlaneCovariance(example);
  text.resize(text.rfind('\n', text.size() - 2) + 1);  // the last line is gone
  Write("plane_covariance.csv", text);
  try {
    ReadPlaneCovariance(directory_.string());
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("plane_covariance.csv:6:"));
  }
}

}  // namespace
}  // namespace plumbline
