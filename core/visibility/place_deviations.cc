#include "core/visibility/place_deviations.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>

#include "core/association/surface_levels.h"
#include "core/util/quantiles.h"

namespace plumbline {

std::vector<bool> FindPlacesOff(const std::vector<PlaceDeviation>& places) {
  std::vector<bool> is_off(places.size(), false);
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right_side = Eigen::Vector3d::Zero();
  const auto take = [&](const PlaceDeviation& place, double times) {
    const Eigen::Vector3d weighted = times / place.variance * place.by_surface;
    information += weighted * place.by_surface.transpose();
    right_side += place.value_m * weighted;
  };
  for (const PlaceDeviation& place : places) take(place, 1.0);
  while (true) {
    const Eigen::LDLT<Eigen::Matrix3d> factor(information);
    const Eigen::Vector3d shift = factor.solve(right_side);
    double largest = kSignificantStddevs;
    size_t worst = places.size();
    for (size_t i = 0; i < places.size(); ++i) {
      if (is_off[i]) continue;
      const PlaceDeviation& place = places[i];
      const double fitted = place.by_surface.dot(factor.solve(place.by_surface));
      const double redundant = place.variance - fitted;
      const double rounding = std::sqrt(std::numeric_limits<double>::epsilon());
      if (redundant < rounding * place.variance) continue;  // it alone shows a parameter
      const double residual_m = place.value_m - place.by_surface.dot(shift);
      const double studentised = std::abs(residual_m) / std::sqrt(redundant);
      if (studentised <= largest) continue;
      largest = studentised;
      worst = i;
    }
    if (worst == places.size()) return is_off;
    is_off[worst] = true;
    take(places[worst], -1.0);
  }
}

void PlaceDeviations::Add(const Eigen::Vector2d& uv, double deviation_m, double stddev_m) {
  const double weight = 1.0 / (stddev_m * stddev_m);
  Sums& sums = places_[PatchExtent::CellAt(uv)];
  sums.weight += std::llround(weight);
  sums.micrometres += std::llround(1e6 * weight * deviation_m);
}

void PlaceDeviations::Add(const PlaceDeviations& other) {
  for (const auto& [cell, more] : other.places_) {
    Sums& sums = places_[cell];
    sums.weight += more.weight;
    sums.micrometres += more.micrometres;
  }
}

std::vector<PatchExtent::Cell> PlaceDeviations::CellsOff(const Landmark& surface,
                                                         double flatness_m) const {
  // A map has thousands of cells: the noise is to explain none of those found, at the level of
  // outliers, unevenness at the usual one, that of FindPlacesOff.
  const double noise_factor = kOutlierSigmas / kSignificantStddevs;
  std::vector<PlaceDeviation> places;
  for (const auto& [cell, sums] : places_) {
    const Eigen::Vector2d centre(cell.first + 0.5, cell.second + 0.5);
    const Eigen::Vector3d at_world = surface.extent.ToWorld(PatchExtent::kCellSize * centre);
    const auto weight = static_cast<double>(sums.weight);
    places.push_back(
        {1e-6 * static_cast<double>(sums.micrometres) / weight,
         noise_factor * noise_factor / weight + flatness_m * flatness_m,
         surface.DeviationJacobian(at_world, surface.extent.axes().u).row(0).transpose()});
  }
  const std::vector<bool> is_off = FindPlacesOff(places);
  std::vector<PatchExtent::Cell> cells;
  size_t i = 0;
  for (const auto& [cell, sums] : places_) {
    if (is_off[i++]) cells.push_back(cell);
  }
  return cells;
}

}  // namespace plumbline
