#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/geometry/matrix_types.h"
#include "core/geometry/rigid3.h"
#include "core/geometry/scan_plane_motion.h"
#include "core/map/observation.h"
#include "core/sensor/rig.h"
#include "core/trajectory/trajectory.h"

namespace plumbline {

// The covariance of the body's pose at an instant, surfaces held: world-frame rotation (rad)
// and position (m).
using PoseCovarianceAt = std::function<Matrix6d(int64_t time_ns)>;

// Longest span over which three poses stand for the scan plane's motion. What their quadratic
// misses of it grows with the third power of the span: for 20 ms and a jerk of 100 rad/s^3 it
// is 0.007 mrad.
inline constexpr int64_t kMaxQuadraticSpanNs = 25'000'000;

// The poses of rig and scanner while an observation was made: at its middle interpolation
// node, and the scan plane's motion through all three nodes.
struct ObservationPoses {
  std::array<int64_t, 3> times_ns;
  Rigid3d world_from_body;
  Rigid3d world_from_scanner;
  ScanMotion motion;
  double range_excess_m;  // of the scanner's ranges, as it is estimated

  // world_from_body: the rig's poses at the three nodes.
  ObservationPoses(const std::array<int64_t, 3>& times_ns,
                   const std::array<Rigid3d, 3>& world_from_body,
                   const Scanner& scanner);
  ObservationPoses(const std::array<int64_t, 3>& times_ns,
                   const Scanner& scanner,
                   PoseSampler* poses);
  ObservationPoses(const Trajectory& trajectory,
                   const Scanner& scanner,
                   const Observation& observation);
};

// Computes the poses of observations, once for those of the same few scan lines. The
// trajectory stays as it is meanwhile.
class SharedPoses {
 public:
  SharedPoses(const Rig& rig, const Trajectory& trajectory)
      : rig_(rig), sampler_(trajectory) {}

  // The poses of an observation; the reference is valid until the next call.
  const ObservationPoses& Of(const Observation& observation);

 private:
  static constexpr size_t kNumKept = 4;  // scan lines; a scan's are asked for in any order

  struct Kept {
    int scanner_index;
    double delay_s;
    std::array<Rigid3d, 3> world_from_body;
    ObservationPoses poses;
  };

  // The rig's poses at a scanner's nodes; another one's line of the same instants has the same
  // ones.
  std::array<Rigid3d, 3> BodiesAt(const std::array<int64_t, 3>& times_ns, double delay_s);

  const Rig& rig_;
  PoseSampler sampler_;
  std::vector<Kept> kept_;
  size_t next_ = 0;
};

}  // namespace plumbline
