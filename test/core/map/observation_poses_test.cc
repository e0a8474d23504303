#include "core/map/observation_poses.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/surface/landmark.h"
#include "factors/segment/segment_measurement.h"

namespace plumbline {
namespace {

constexpr int64_t kStart = 1'400'000'000'000'000'000;
constexpr int64_t kMillisecond = 1'000'000;

// A turn about the scanner's z axis at 2 rad/s while it moves, for 20 ms.
class ScanMotionTest : public testing::Test {
 protected:
  static Rigid3d PoseAt(double seconds) {
    return {RotationFromRollPitchYaw(0.1, 0.7, 0.0) *
                RotationFromRollPitchYaw(0.0, 0.0, 2.0 * seconds),
            Eigen::Vector3d(1.5 * seconds, 0.2, 1.0)};
  }
  static double Seconds(int64_t ms) { return 1e-3 * static_cast<double>(ms); }

  ScanMotion motion_{{kStart, kStart + 10 * kMillisecond, kStart + 20 * kMillisecond},
                     {PoseAt(0.0), PoseAt(0.01), PoseAt(0.02)}};
};

// The quadratic is right to the turn's third power.
TEST_F(ScanMotionTest, PlacesPointsBetweenItsPoses) {
  const Eigen::Vector2d p(10.0, -4.0);
  for (const int64_t ms : {0, 3, 10, 17, 20}) {
    const Eigen::Vector3d expected = PoseAt(Seconds(ms)) * Eigen::Vector3d(p.x(), p.y(), 0.0);
    const double tolerance = ms % 10 == 0 ? 1e-12 : 1e-5;
    EXPECT_LT((motion_.ToWorld(p, kStart + ms * kMillisecond) - expected).norm(), tolerance);
    EXPECT_LT((motion_.At(kStart + ms * kMillisecond) * p.homogeneous() - expected).norm(),
              tolerance);
  }
}

TEST_F(ScanMotionTest, TraceIsWhereThePlaneMeetsTheScanPlane) {
  const Eigen::Vector3d normal = Eigen::Vector3d(0.6, -0.8, 0.0);
  const double distance = -2.5;
  const PlaneTrace trace = motion_.TraceOf(normal, distance);
  for (const int64_t ms : {0, 3, 10, 17, 20}) {
    const Eigen::Vector3d line = trace.At(kStart + ms * kMillisecond);
    const Eigen::Vector2d on_line = line.z() / line.head<2>().squaredNorm() * line.head<2>();
    const Eigen::Vector2d along(-line.y(), line.x());
    for (const double away : {-3.0, 0.0, 5.0}) {
      const Eigen::Vector2d p = on_line + away * along;
      const Eigen::Vector3d p_world = PoseAt(Seconds(ms)) * Eigen::Vector3d(p.x(), p.y(), 0.0);
      EXPECT_NEAR(normal.dot(p_world), distance, ms % 10 == 0 ? 1e-12 : 1e-5) << ms;
    }
  }
}

// Scan lines of three scanners, two of them at the same instants.
TEST(SharedPoses, AreThoseOfEachObservation) {
  Rig rig;
  for (const double yaw : {0.0, 1.0, 2.0}) {
    Scanner scanner;
    scanner.body_from_scanner = {RotationFromRollPitchYaw(0.2, 0.6, yaw), {0.1, yaw, 0.3}};
    rig.scanners.push_back(scanner);
  }
  Trajectory trajectory(kStart, 50 * kMillisecond, Rigid3d());
  trajectory.ExtendTo(kStart + 400 * kMillisecond);
  for (int i = 0; i < trajectory.num_control_points(); ++i) {
    ControlPoint& control_point = trajectory.control_point(i);
    Eigen::Map<Eigen::Quaterniond>(control_point.rotation.data()) =
        RotationFromRollPitchYaw(0.02 * i, 0.01 * i * i, 0.1 * i);
    Eigen::Map<Eigen::Vector3d>(control_point.position.data()) << 0.1 * i, 0.01 * i * i, 1.0;
  }
  SharedPoses shared(rig, trajectory);
  for (const int scan : {0, 0, 1, 5, 0}) {
    for (const int scanner : {2, 0, 1, 1, 2}) {
      const int64_t start_ns = kStart + (25 * scan + (scanner == 2 ? 7 : 0)) * kMillisecond;
      Observation observation;
      observation.scanner_index = scanner;
      SegmentMeasurement nodes;
      nodes.node_times_ns = NodesOfSpan(start_ns, start_ns + 20 * kMillisecond);
      observation.measurement = PackedSegment(nodes, {});
      const Scanner& one = rig.scanners[static_cast<size_t>(scanner)];
      const Rigid3d& body_from_scanner = one.body_from_scanner;
      const ObservationPoses& poses = shared.Of(observation);
      const ObservationPoses alone(trajectory, one, observation);
      const Rigid3d body = trajectory.WorldFromBody(start_ns + 10 * kMillisecond);
      EXPECT_EQ(poses.times_ns, nodes.node_times_ns);
      EXPECT_LT((poses.world_from_body.translation - body.translation).norm(), 1e-12);
      EXPECT_LT(
          (poses.world_from_scanner.translation - body * body_from_scanner.translation).norm(),
          1e-12);
      for (size_t k = 0; k < 3; ++k) {
        const Rigid3d at_node =
            trajectory.WorldFromBody(nodes.node_times_ns[k]) * body_from_scanner;
        EXPECT_LT((poses.motion.nodes()[k] - PlacementOf(at_node)).norm(), 1e-12);
        EXPECT_LT((alone.motion.nodes()[k] - PlacementOf(at_node)).norm(), 1e-12);
      }
    }
  }
}

}  // namespace
}  // namespace plumbline
