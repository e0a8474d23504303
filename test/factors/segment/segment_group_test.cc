#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "factors/segment/linearised_group.h"
#include "factors/segment/segment_measurement.h"
#include "factors/spline/spline.h"
#include "test/testing/segment_scene.h"

namespace plumbline {
namespace {

// The group's rows in the order of the parameter blocks: rotations, positions, planes.
std::vector<int> RowsByBlock(int size) {
  std::vector<int> rows;
  for (const int first : {0, 3}) {
    for (int row = 0; row < 6 * kNumControlPoints; ++row) {
      if (row % 6 / 3 * 3 == first) rows.push_back(row);
    }
  }
  for (int row = 6 * kNumControlPoints; row < size; ++row) rows.push_back(row);
  return rows;
}

Eigen::MatrixXd HessianByBlock(const Eigen::MatrixXd& lower, const std::vector<int>& rows) {
  const Eigen::MatrixXd full = lower.selfadjointView<Eigen::Lower>();
  return full(rows, rows);
}

// Few segments leave directions free, many do not.
TEST(SegmentGroup, ModelEqualsItsSegments) {
  for (const int num_segments : {3, 60}) {
    for (const double huber_width : {0.0, 3.0}) {
      const SegmentScene scene(num_segments);
      const Expected expected = SumOfSegmentFactors(scene, huber_width);
      LinearisedGroup group(scene.Group(huber_width));
      const LinearisedGroup::Model model = group.ModelAt(scene.blocks.pointers().data());
      EXPECT_NEAR(model.cost, expected.cost, 1e-10 * expected.cost);
      const int size = 6 * kNumControlPoints + 3;  // before the plane with a manifold
      const std::vector<int> rows = RowsByBlock(size);
      EXPECT_LT((model.gradient(rows) - expected.gradient.head(size)).norm(),
                1e-8 * expected.gradient.norm());
      EXPECT_LT(
          (HessianByBlock(model.hessian, rows) - expected.hessian.topLeftCorner(size, size))
              .norm(),
          1e-10 * expected.hessian.norm());
    }
  }
}

TEST(SegmentGroup, WithPlanesHeldThePosesRowsAreLeft) {
  const SegmentScene scene(60);
  const Expected expected = SumOfSegmentFactors(scene, 3.0);
  const std::vector<const double*> parameters = scene.blocks.pointers();
  SegmentGroup::Quadratic quadratic;
  scene.Group(3.0).LinearisePoses(parameters.data(), &quadratic);
  const Eigen::Index size = 6 * kNumControlPoints;
  EXPECT_NEAR(quadratic.cost, expected.cost, 1e-10 * expected.cost);
  ASSERT_EQ(quadratic.gradient.size(), size);
  const std::vector<int> rows = RowsByBlock(static_cast<int>(size));
  EXPECT_LT((quadratic.gradient(rows) - expected.gradient.head(size)).norm(),
            1e-8 * expected.gradient.norm());
  EXPECT_LT(
      (HessianByBlock(quadratic.hessian, rows) - expected.hessian.topLeftCorner(size, size))
          .norm(),
      1e-10 * expected.hessian.norm());
}

TEST(SegmentGroup, HuberTouchesSomeSegmentsOnly) {
  const SegmentScene scene(60);
  const double plain = SumOfSegmentFactors(scene, 0.0).cost;
  const double robust = SumOfSegmentFactors(scene, 3.0).cost;
  const double very_wide = SumOfSegmentFactors(scene, 1e6).cost;
  EXPECT_LT(robust, 0.95 * plain);
  EXPECT_EQ(very_wide, plain);
}

// A group remembers its last linearisation: it must not serve parameters far from it.
TEST(SegmentGroup, FollowsItsParameters) {
  SegmentScene scene(30);
  LinearisedGroup group(scene.Group(0.0));
  const double before = group.ModelAt(scene.blocks.pointers().data()).cost;
  scene.blocks[kNumControlPoints][0] += 0.1;
  const double moved = group.ModelAt(scene.blocks.pointers().data()).cost;
  EXPECT_EQ(group.num_linearisations(), 2);
  LinearisedGroup anew(scene.Group(0.0));
  EXPECT_EQ(anew.ModelAt(scene.blocks.pointers().data()).cost, moved);
  scene.blocks[kNumControlPoints][0] -= 0.1;
  EXPECT_NEAR(group.ModelAt(scene.blocks.pointers().data()).cost, before, 1e-9 * before);
}

// Positions enter the residuals of planes linearly, so that the model of a plain sum of
// squares is exact however far they move within its validity.
TEST(SegmentGroup, ModelHoldsNearItsLinearisation) {
  SegmentScene scene(60);
  scene.segments.erase(std::remove_if(scene.segments.begin(),
                                      scene.segments.end(),
                                      [&](const SegmentGroup::Segment& segment) {
                                        const auto plane = static_cast<size_t>(segment.plane);
                                        return scene.planes[plane].model ==
                                               PlaneModel::kCylinder;
                                      }),
                       scene.segments.end());
  LinearisedGroup group(scene.Group(0.0));
  group.ModelAt(scene.blocks.pointers().data());
  scene.blocks[kNumControlPoints][0] += 0.005;
  const LinearisedGroup::Model model = group.ModelAt(scene.blocks.pointers().data());
  EXPECT_EQ(group.num_linearisations(), 1);
  LinearisedGroup anew(scene.Group(0.0));
  const LinearisedGroup::Model exact = anew.ModelAt(scene.blocks.pointers().data());
  EXPECT_NEAR(model.cost, exact.cost, 1e-9 * exact.cost);
  const Eigen::Index size = 6 * kNumControlPoints;
  EXPECT_LT((model.gradient - exact.gradient).head(size).norm(), 0.01 * exact.gradient.norm())
      << "the lever arms have moved by 5 mm";
}

// A scene whose scanners are blocks, off what is stated for them, and seen on planes only.
struct CalibratedScene {
  SegmentScene scene{60};
  std::vector<Eigen::VectorXd> scanner_blocks;

  CalibratedScene() {
    TestRandom random(5);
    std::vector<SegmentGroup::Segment>& segments = scene.segments;
    segments.erase(
        std::remove_if(
            segments.begin(), segments.end(), [](const auto& s) { return s.plane == 3; }),
        segments.end());
    for (SegmentGroup::Scanner& scanner : scene.scanners) {
      scanner.estimated = true;
      Eigen::VectorXd block(kScannerBlockSize);
      block << random.Vector(0.2), random.Vector(0.1), random.Uniform(-0.003, 0.003),
          random.Uniform(-0.5, 0.5), random.Uniform(-0.01, 0.01);
      scanner_blocks.push_back(block);
    }
  }

  std::vector<const double*> Parameters() const {
    std::vector<const double*> parameters = scene.blocks.pointers();
    for (const Eigen::VectorXd& block : scanner_blocks) parameters.push_back(block.data());
    return parameters;
  }

  // A segment's factor with its scanner where the block has it, and the factor's blocks.
  Eigen::VectorXd Residuals(const SegmentGroup::Segment& segment,
                            const Eigen::VectorXd& scanner_block,
                            Eigen::MatrixXd* jacobian = nullptr) const {
    const auto plane = static_cast<size_t>(segment.plane);
    const ScannerPose scanner =
        PoseOfScanner(scene.scanners[static_cast<size_t>(segment.scanner)].body_from_scanner,
                      scanner_block.data());
    std::array<SplineNode, 3> nodes = segment.nodes;
    for (SplineNode& node : nodes) node.u += scanner_block[kScannerDelayAt] / kKnotInterval;
    TestBlocks blocks;
    TestRandom random(11);
    blocks.AddSpline(kNumControlPoints, 0.2, &random);
    blocks.AddRotation(Eigen::Quaterniond(scanner.rotation));
    blocks.AddEuclidean(scanner.translation);
    blocks.AddEuclidean(scene.plane_parameters[plane]);
    // What a range bias leaves of the offsets, and its own row.
    const double range_bias_m = scanner_block[kScannerRangeAt];
    SegmentMeasurement measurement = segment.measurement->Unpack();
    measurement.rows.col(9) -= range_bias_m * measurement.range();
    for (int k = 0; k < 3; ++k) measurement.rows.middleCols<2>(3 * k) *= scanner.range_scale;
    const auto factor = CreateSegmentFactor(measurement,
                                            nodes,
                                            kNumControlPoints,
                                            scene.planes[plane].model,
                                            scene.planes[plane].chart,
                                            segment.weights);
    const Eigen::VectorXd of_factor = blocks.Residuals(*factor);
    Eigen::VectorXd residuals(of_factor.size() + 1);
    residuals << of_factor, segment.weights.offset * (measurement.range_offset -
                                                      range_bias_m * measurement.range_rest);
    if (jacobian != nullptr) {
      *jacobian = blocks.TangentJacobian(*factor);
      jacobian->conservativeResize(residuals.size(), Eigen::NoChange);
      jacobian->bottomRows<1>().setZero();
    }
    return residuals;
  }

  // Of a segment's residuals by its scanner's block, by differences.
  Eigen::MatrixXd ByScanner(const SegmentGroup::Segment& segment) const {
    constexpr double kStep = 1e-5;
    const Eigen::VectorXd& block = scanner_blocks[static_cast<size_t>(segment.scanner)];
    Eigen::MatrixXd jacobian(Residuals(segment, block).size(), kScannerBlockSize);
    for (int i = 0; i < kScannerBlockSize; ++i) {
      Eigen::VectorXd up = block;
      Eigen::VectorXd down = block;
      up[i] += kStep;
      down[i] -= kStep;
      jacobian.col(i) = (Residuals(segment, up) - Residuals(segment, down)) / (2.0 * kStep);
    }
    return jacobian;
  }
};

TEST(SegmentGroup, ScannersAreBlocksOfItsModel) {
  const CalibratedScene calibrated;
  const SegmentScene& scene = calibrated.scene;
  SegmentGroup::Quadratic quadratic;
  scene.Group(0.0).Linearise(calibrated.Parameters().data(), &quadratic);
  const int poses = 6 * kNumControlPoints;
  const int scanners = poses + 1 + 2 + 3 + 3;
  const int size = scanners + 2 * kScannerBlockSize;
  ASSERT_EQ(quadratic.gradient.size(), size);
  const int plane_at[] = {poses, poses + 1, poses + 3};
  const int plane_size[] = {1, 2, 3};
  double cost = 0.0;
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(size);
  Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(size, size);
  for (const SegmentGroup::Segment& segment : scene.segments) {
    Eigen::MatrixXd of_factor;
    const auto scanner = static_cast<size_t>(segment.scanner);
    const Eigen::VectorXd residuals =
        calibrated.Residuals(segment, calibrated.scanner_blocks[scanner], &of_factor);
    Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(residuals.size(), size);
    jacobian(Eigen::all, RowsByBlock(poses)) = of_factor.leftCols(poses);
    jacobian.middleCols(plane_at[segment.plane], plane_size[segment.plane]) =
        of_factor.rightCols(plane_size[segment.plane]);
    jacobian.middleCols<kScannerBlockSize>(scanners + kScannerBlockSize * segment.scanner) =
        calibrated.ByScanner(segment);
    cost += 0.5 * residuals.squaredNorm();
    gradient += jacobian.transpose() * residuals;
    hessian += jacobian.transpose() * jacobian;
  }
  EXPECT_NEAR(quadratic.cost, cost, 1e-9 * cost);
  EXPECT_LT((quadratic.gradient - gradient).norm(), 1e-7 * gradient.norm());
  const Eigen::MatrixXd full = quadratic.hessian.selfadjointView<Eigen::Lower>();
  // Of the scanners apart: a delay's derivatives are hundreds of times the others'.
  const Eigen::VectorXd scale = hessian.diagonal().cwiseMax(1e-9).cwiseSqrt().cwiseInverse();
  EXPECT_LT((scale.asDiagonal() * (full - hessian) * scale.asDiagonal()).cwiseAbs().maxCoeff(),
            1e-6);
}

TEST(SegmentGroup, ConstantScannersAreThoseOfZeroBlocks) {
  CalibratedScene calibrated;
  for (Eigen::VectorXd& block : calibrated.scanner_blocks) block.setZero();
  SegmentGroup::Quadratic estimated;
  calibrated.scene.Group(0.0).Linearise(calibrated.Parameters().data(), &estimated);
  for (SegmentGroup::Scanner& scanner : calibrated.scene.scanners) scanner.estimated = false;
  SegmentGroup::Quadratic constant;
  calibrated.scene.Group(0.0).Linearise(calibrated.Parameters().data(), &constant);
  for (const SegmentGroup::Segment& segment : calibrated.scene.segments) {
    const double own_row = segment.weights.offset * segment.measurement->range_offset();
    constant.cost += 0.5 * own_row * own_row;
  }
  const Eigen::Index size = constant.gradient.size();
  EXPECT_NEAR(estimated.cost, constant.cost, 1e-12 * constant.cost);
  EXPECT_LT((estimated.gradient.head(size) - constant.gradient).norm(),
            1e-10 * constant.gradient.norm());
  EXPECT_LT((estimated.hessian.topLeftCorner(size, size) - constant.hessian).norm(),
            1e-10 * constant.hessian.norm());
}

TEST(SegmentGroup, WithPlanesHeldItsModelIsAboutThePoses) {
  const SegmentScene scene(60);
  LinearisedGroup group(scene.Group(3.0), true);
  const LinearisedGroup::Model model = group.ModelAt(scene.blocks.pointers().data());
  const Expected expected = SumOfSegmentFactors(scene, 3.0);
  const int size = 6 * kNumControlPoints;
  ASSERT_EQ(model.gradient.size(), size);
  EXPECT_NEAR(model.cost, expected.cost, 1e-10 * expected.cost);
  EXPECT_LT((model.gradient(RowsByBlock(size)) - expected.gradient.head(size)).norm(),
            1e-8 * expected.gradient.norm());
}

// One segment with one residual, of an estimated scanner on a mount.
struct MountedScene {
  SegmentScene scene{3};
  Eigen::VectorXd scanner_block{kMountedBlockSize};
  std::vector<SegmentGroup::MountAtNodes> motions;

  // i: the scene's segment, which is on that one of its planes.
  explicit MountedScene(int i) {
    TestRandom random(5);
    SegmentGroup::Segment segment = scene.segments[static_cast<size_t>(i)];
    SegmentMeasurement measurement = segment.measurement->Unpack();
    measurement.num_nodes = 3;
    measurement.node_times_ns = {0, 1, 2};
    measurement.rows.setZero(1, SegmentMeasurement::kColumns);
    for (double& value : measurement.rows.reshaped()) value = random.Uniform(-1.0, 1.0);
    measurement.range_rest = measurement.range_offset = 0.0;
    segment.measurement =
        &scene.measurements.emplace_back(measurement, segment.measurement->frame());
    segment.mount_motion = 0;
    scene.segments = {segment};
    SegmentGroup::Scanner& scanner = scene.scanners[static_cast<size_t>(segment.scanner)];
    scanner.estimated = true;
    scanner.mount = {random.Vector(1.0).normalized(), random.Vector(0.2), 0.1};
    motions.push_back({MountMotion{0.5, 3.0, -10.0, 8.0, 0.001},
                       MountMotion{0.53, 2.9, -10.0, 8.01, 0.001},
                       MountMotion{0.56, 2.8, -10.0, 8.02, 0.001}});
    scanner_block << random.Vector(0.2), random.Vector(0.1), random.Uniform(-0.003, 0.003),
        random.Uniform(-0.5, 0.5), random.Uniform(-0.01, 0.01), random.Uniform(-0.05, 0.05),
        random.Uniform(-0.003, 0.003), random.Uniform(-0.0003, 0.0003), 0.02, -0.03, 0.01,
        0.02;
  }

  SegmentGroup::Quadratic At(const Eigen::VectorXd& block) const {
    const SegmentGroup group(kNumControlPoints,
                             kKnotInterval,
                             scene.scanners,
                             scene.planes,
                             scene.segments,
                             0.0,
                             motions);
    std::vector<const double*> parameters = scene.blocks.pointers();
    parameters.push_back(block.data());
    SegmentGroup::Quadratic quadratic;
    group.Linearise(parameters.data(), &quadratic);
    return quadratic;
  }
};

TEST(SegmentGroup, ScannersOnMountsAreBlocksOfItsModel) {
  constexpr double kStep = 1e-6;
  for (const int plane : {0, 1, 2}) {
    MountedScene mounted(plane);
    const SegmentGroup::Quadratic at = mounted.At(mounted.scanner_block);
    ASSERT_EQ(at.gradient.size(), 6 * kNumControlPoints + 9 + kMountedBlockSize);
    const Eigen::VectorXd gradient = at.gradient.tail<kMountedBlockSize>();
    EXPECT_GT(gradient.norm(), 0.0);
    for (int k = 0; k < kMountedBlockSize; ++k) {
      Eigen::VectorXd less = mounted.scanner_block;
      Eigen::VectorXd more = mounted.scanner_block;
      less[k] -= kStep;
      more[k] += kStep;
      EXPECT_NEAR(gradient[k],
                  (mounted.At(more).cost - mounted.At(less).cost) / (2.0 * kStep),
                  1e-5 * gradient.norm())
          << "parameter " << k;
    }
    // The matrix of a single residual r with the gradient r j is j j^T.
    const Eigen::MatrixXd expected = at.gradient * at.gradient.transpose() / (2.0 * at.cost);
    const Eigen::MatrixXd full = at.hessian.selfadjointView<Eigen::Lower>();
    EXPECT_LT((full - expected).norm(), 1e-6 * expected.norm());
  }
}

TEST(SegmentGroup, AMountThatStandsIsAnotherPose) {
  MountedScene mounted(2);
  for (SegmentGroup::Scanner& scanner : mounted.scene.scanners) scanner.estimated = false;
  const auto index = static_cast<size_t>(mounted.scene.segments[0].scanner);
  mounted.motions[0].fill(MountMotion{0.5, 0.0, 0.0, 0.0, 0.0});
  const SegmentGroup::Quadratic moving = mounted.At(mounted.scanner_block);
  SegmentGroup::Scanner& scanner = mounted.scene.scanners[index];
  scanner.body_from_scanner =
      TurnedBy(0.5 + scanner.mount->zero_rad, *scanner.mount, scanner.body_from_scanner);
  scanner.mount.reset();
  mounted.scene.segments[0].mount_motion = -1;
  const SegmentGroup::Quadratic standing = mounted.At(mounted.scanner_block);
  EXPECT_NEAR(moving.cost, standing.cost, 1e-12 * standing.cost);
  EXPECT_LT((moving.gradient - standing.gradient).norm(), 1e-10 * standing.gradient.norm());
}

}  // namespace
}  // namespace plumbline
