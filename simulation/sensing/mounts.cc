#include "simulation/sensing/mounts.h"

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/geometry/angles.h"
#include "core/util/time.h"
#include "simulation/world/random.h"

namespace plumbline {
namespace {

// Two directions across an axis, as calibration.json counts them.
Eigen::Matrix<double, 3, 2> Across(const Eigen::Vector3d& axis) {
  Eigen::Matrix<double, 3, 2> across;
  across.col(0) = axis.unitOrthogonal();
  across.col(1) = axis.cross(across.col(0));
  return across;
}

MountTruth DrawTruth(const Scanner& scanner, double errors, Random* random) {
  const MountUncertainty& stated = scanner.mount->uncertainty;
  MountTruth truth;
  truth.scanner = scanner.name;
  truth.zero_rad = errors * stated.zero_rad * random->Gaussian();
  truth.late_s = errors * stated.time_s * random->Gaussian();
  truth.rate = errors * stated.rate * random->Gaussian();
  for (int i = 0; i < 2; ++i) truth.tilts[i] = errors * stated.axis_rad * random->Gaussian();
  for (int i = 0; i < 2; ++i) truth.shifts[i] = errors * stated.point_m * random->Gaussian();
  return truth;
}

// The mount as it is, driven as stated.
Mount TrueMount(Mount mount, const MountTruth& truth) {
  const Eigen::Matrix<double, 3, 2> across = Across(mount.axis);
  mount.axis = (mount.axis + across * truth.tilts).normalized();
  mount.point += across * truth.shifts;
  mount.zero_rad += truth.zero_rad;
  return mount;
}

// What the drive does at every instant of the recording.
class Drive {
 public:
  Drive(const Mount& stated, const MountTruth& truth, int64_t first_line_ns)
      : mount_(stated), is_read_(stated.IsRead()) {
    mount_.joint_topic.clear();
    mount_.start_ns = first_line_ns;
    mount_.rate_excess = truth.rate;
    mount_.delay_s = is_read_ ? 0.0 : truth.late_s;
    if (is_read_) mount_.time_offset_s = 0.0;
  }

  double At(int64_t time_ns) const {
    return mount_.StatedAt(time_ns, mount_.Earlier(time_ns)).angle_rad;
  }

 private:
  Mount mount_;
  bool is_read_;
};

}  // namespace

MountOptions ReadMountOptions(const YamlNode& node) {
  MountOptions options;
  node.Optional("rate_hz", &options.rate_hz, 1.0, 10000.0);
  node.Optional("errors", &options.errors, 0.0, 1000.0);
  double jitter_deg = 0.0;
  double backlash_deg = 0.0;
  node.Optional("jitter_deg", &jitter_deg, 0.0, 10.0);
  node.Optional("backlash_deg", &backlash_deg, 0.0, 10.0);
  options.jitter_rad = jitter_deg * kRadiansPerDegree;
  options.backlash_rad = backlash_deg * kRadiansPerDegree;
  node.RejectUnreadKeys();
  return options;
}

SimulatedMounts SimulateMounts(const MountOptions& options,
                               int64_t first_line_ns,
                               int64_t start_ns,
                               int64_t end_ns,
                               uint64_t seed,
                               Rig* rig) {
  SimulatedMounts simulated;
  const int64_t step_ns = NanosecondsFromSeconds(0.001);
  const int64_t shake_ns = NanosecondsFromSeconds(0.02);
  const int64_t margin_ns = NanosecondsFromSeconds(0.2);
  for (size_t i = 0; i < rig->scanners.size(); ++i) {
    Scanner& scanner = rig->scanners[i];
    if (!scanner.mount) continue;
    // Apart from all others' random numbers.
    Random random({seed, 0x6d6f756e, static_cast<uint64_t>(i)});
    const Mount stated = *scanner.mount;
    const MountTruth truth = DrawTruth(scanner, options.errors, &random);
    const Drive drive(stated, truth, first_line_ns);
    std::vector<JointSample> samples;
    double angle = drive.At(start_ns - margin_ns);
    double shake_before = 0.0;
    double shake_after = 0.0;
    const double shake = stated.IsRead() ? 0.0 : options.jitter_rad;
    for (int64_t time_ns = start_ns - margin_ns; time_ns <= end_ns + margin_ns;
         time_ns += step_ns) {
      const double driven = drive.At(time_ns);
      angle = std::clamp(
          angle, driven - 0.5 * options.backlash_rad, driven + 0.5 * options.backlash_rad);
      const int64_t since_ns = (time_ns - start_ns + margin_ns) % shake_ns;
      if (since_ns == 0) {
        shake_before = std::exchange(shake_after, shake * random.Gaussian());
      }
      const double share = static_cast<double>(since_ns) / static_cast<double>(shake_ns);
      samples.push_back(
          {time_ns, angle + shake_before + share * (shake_after - shake_before)});
    }
    const int64_t period_ns = NanosecondsFromSeconds(1.0 / options.rate_hz);
    const int64_t offset_ns = NanosecondsFromSeconds(stated.time_offset_s + truth.late_s);
    for (int64_t time_ns = start_ns - margin_ns;
         stated.IsRead() && time_ns <= end_ns + margin_ns;
         time_ns += period_ns) {
      simulated.readings.push_back(
          {time_ns - offset_ns,
           i,
           drive.At(time_ns) + options.jitter_rad * random.Gaussian()});
    }
    scanner.mount = TrueMount(stated, truth);
    scanner.mount->joint_topic = "truth";
    scanner.mount->angles = std::make_shared<const JointAngles>(std::move(samples));
    simulated.truths.push_back(truth);
  }
  std::stable_sort(
      simulated.readings.begin(),
      simulated.readings.end(),
      [](const MountReading& a, const MountReading& b) { return a.stamp_ns < b.stamp_ns; });
  return simulated;
}

std::string FormatMountTruth(const std::vector<MountTruth>& truths) {
  nlohmann::ordered_json scanners = nlohmann::ordered_json::array();
  for (const MountTruth& truth : truths) {
    scanners.push_back({{"name", truth.scanner},
                        {"mount_zero_deg", truth.zero_rad * kDegreesPerRadian},
                        {"mount_time_s", truth.late_s},
                        {"mount_rate", truth.rate},
                        {"mount_tilt_1_deg", truth.tilts.x() * kDegreesPerRadian},
                        {"mount_tilt_2_deg", truth.tilts.y() * kDegreesPerRadian},
                        {"mount_shift_1_m", truth.shifts.x()},
                        {"mount_shift_2_m", truth.shifts.y()}});
  }
  return nlohmann::ordered_json({{"scanners", scanners}}).dump(1) + "\n";
}

}  // namespace plumbline
