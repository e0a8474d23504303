#include "simulation/world/unevenness.h"

#include <algorithm>
#include <cmath>

#include "simulation/world/random.h"

namespace plumbline {
namespace {

constexpr int kNumWaves = 32;
// A beam that grazes a wall sees its bumps rather than slides along them.
constexpr double kMinCosine = 0.1;

}  // namespace

Unevenness::Unevenness(const UnevennessOptions& options,
                       const Building& building,
                       uint64_t seed) {
  if (options.stddev_m == 0.0) return;
  amplitude_m_ = options.stddev_m * std::sqrt(2.0 / kNumWaves);
  for (const Face& face : building.faces) {
    normals_.push_back(face.normal);
    std::vector<Wave>& waves = waves_.emplace_back(kNumWaves);
    Random random({seed, 0x756e6576, static_cast<uint64_t>(face.id)});
    for (Wave& wave : waves) {
      for (double& component : wave.vector) {
        component = random.Gaussian() / options.correlation_m;
      }
      wave.phase_rad = 2 * M_PI * random.Uniform();
    }
  }
}

double Unevenness::RangeError(int face_id,
                              const Eigen::Vector3d& p_world,
                              const Eigen::Vector3d& direction_world) const {
  if (amplitude_m_ == 0.0 || face_id < 0) return 0.0;
  const auto index = static_cast<size_t>(face_id);
  double deviation = 0.0;
  for (const Wave& wave : waves_[index]) {
    deviation += amplitude_m_ * std::cos(wave.vector.dot(p_world) + wave.phase_rad);
  }
  const double cosine = normals_[index].dot(direction_world);
  return deviation / std::copysign(std::max(std::abs(cosine), kMinCosine), cosine);
}

}  // namespace plumbline
