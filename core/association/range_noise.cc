#include "core/association/range_noise.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/association/line_deviation.h"
#include "core/geometry/angles.h"
#include "core/map/observation_poses.h"
#include "core/surface/landmark_view.h"

namespace plumbline {
namespace {

// Fewer degrees of freedom show a standard deviation to worse than 5 %.
constexpr double kMinFreedom = 200.0;
constexpr double kIncidenceBin = 15.0;  // degrees

// Sum of squared whitened residuals that a free line leaves, their degrees of freedom, and how
// much more noise is stated for them than at range 0, m times the degrees of freedom.
struct Scatter {
  double chi2 = 0.0;
  double freedom = 0.0;
  double growth_m = 0.0;

  void Add(const Scatter& other) {
    chi2 += other.chi2;
    freedom += other.freedom;
    growth_m += other.growth_m;
  }
  // stated_m: at range 0.
  double Noise(double stated_m) const {
    return (stated_m + growth_m / freedom) * std::sqrt(chi2 / freedom);
  }
};

struct ScannerScatter {
  Scatter all;
  std::map<int, Scatter> by_octave;  // of the range in metres
  std::map<int, Scatter> by_incidence;
};

Scatter ScatterOf(const Observation& observation,
                  const Scanner& scanner,
                  const ObservationPoses& poses,
                  const LandmarkView& surface) {
  const LineDeviation deviation = DeviationFromPlane(observation, poses, surface);
  const double of_line =
      deviation.value.dot(deviation.covariance.ldlt().solve(deviation.value));
  const double freedom = observation.num_points - 2.0;
  const double growth_m =
      scanner.RangeStddev(observation.centroid().norm()) - scanner.range_noise_m;
  return {deviation.chi2 - of_line, freedom, growth_m * freedom};
}

double IncidenceDegrees(const Eigen::Vector2d& centroid,
                        const ObservationPoses& poses,
                        const LandmarkView& surface) {
  const Eigen::Vector3d p_scanner(centroid.x(), centroid.y(), 0.0);
  const Eigen::Vector3d beam = poses.world_from_scanner.rotation * p_scanner.normalized();
  const double cosine =
      beam.dot(surface.landmark->NormalNear(poses.world_from_scanner * p_scanner));
  return std::acos(std::min(1.0, std::abs(cosine))) * kDegreesPerRadian;
}

template <typename EdgeOf>
std::vector<NoiseBin> BinsOf(const std::map<int, Scatter>& scatters,
                             double stated_m,
                             const EdgeOf& edge_of) {
  std::vector<NoiseBin> bins;
  for (const auto& [bin, scatter] : scatters) {
    if (scatter.freedom < kMinFreedom) continue;
    bins.push_back({edge_of(bin), edge_of(bin + 1), scatter.Noise(stated_m)});
  }
  return bins;
}

}  // namespace

std::vector<ScannerNoise> EstimateRangeNoise(const Rig& rig, const MapState& state) {
  std::vector<ScannerScatter> scatters(rig.scanners.size());
  const std::vector<LandmarkView> surfaces(state.landmarks.begin(), state.landmarks.end());
  SharedPoses shared_poses(rig, state.trajectory);
  for (const Observation& observation : state.observations) {
    if (observation.landmark_id < 0 || observation.num_points <= 2) continue;
    const LandmarkView& surface = surfaces[static_cast<size_t>(observation.landmark_id)];
    const ObservationPoses& poses = shared_poses.Of(observation);
    const Eigen::Vector2d centroid = observation.centroid();
    const auto scanner = static_cast<size_t>(observation.scanner_index);
    const Scatter scatter = ScatterOf(observation, rig.scanners[scanner], poses, surface);
    ScannerScatter& of_scanner = scatters[scanner];
    of_scanner.all.Add(scatter);
    of_scanner.by_octave[std::ilogb(centroid.norm())].Add(scatter);
    of_scanner
        .by_incidence[static_cast<int>(IncidenceDegrees(centroid, poses, surface) /
                                       kIncidenceBin)]
        .Add(scatter);
  }
  std::vector<ScannerNoise> noises;
  for (size_t i = 0; i < scatters.size(); ++i) {
    const double stated_m = rig.scanners[i].range_noise_m;
    const ScannerScatter& scatter = scatters[i];
    ScannerNoise noise{rig.scanners[i].name, stated_m, {}, {}, {}};
    if (scatter.all.freedom >= kMinFreedom) noise.noise_m = scatter.all.Noise(stated_m);
    noise.by_range = BinsOf(
        scatter.by_octave, stated_m, [](int octave) { return std::ldexp(1.0, octave); });
    noise.by_incidence =
        BinsOf(scatter.by_incidence, stated_m, [](int bin) { return kIncidenceBin * bin; });
    noises.push_back(std::move(noise));
  }
  return noises;
}

}  // namespace plumbline
