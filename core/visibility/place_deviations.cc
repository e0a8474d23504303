#include "core/visibility/place_deviations.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "core/association/surface_levels.h"
#include "core/util/quantiles.h"

namespace plumbline {

namespace {

// Sums of places by their weights.
struct PlaceSums {
  double weight = 0.0;
  double value = 0.0;
  Eigen::Vector3d by_surface = Eigen::Vector3d::Zero();

  void Add(const PlaceDeviation& place, double place_weight) {
    weight += place_weight;
    value += place_weight * place.value_m;
    by_surface += place_weight * place.by_surface;
  }
  PlaceSums operator+(const PlaceSums& other) const {
    return {weight + other.weight, value + other.value, by_surface + other.by_surface};
  }
  PlaceSums operator-(const PlaceSums& other) const {
    return {weight - other.weight, value - other.value, by_surface - other.by_surface};
  }
};

int Along(const PlaceDeviation& place, bool along_u) {
  return along_u ? place.cell.first : place.cell.second;
}

// The fit of a surface's parameters to places.
class PlaceFit {
 public:
  void Take(const PlaceDeviation& place, double weight) {
    information_ += weight * place.by_surface * place.by_surface.transpose();
    right_side_ += weight * place.value_m * place.by_surface;
  }
  void Solve() {
    factor_.compute(information_);
    shift_ = factor_.solve(right_side_);
  }
  double ResidualOf(const PlaceDeviation& place) const {
    return place.value_m - place.by_surface.dot(shift_);
  }
  // The part of the weight of places that is redundant: the fit does not adapt to it. None
  // where they alone show a parameter.
  double Redundant(const PlaceSums& sums) const {
    const double redundant = sums.weight - sums.by_surface.dot(factor_.solve(sums.by_surface));
    const double rounding = std::sqrt(std::numeric_limits<double>::epsilon());
    return redundant < rounding * sums.weight ? 0.0 : redundant;
  }
  // The sum of the places' residuals by weight.
  double ResidualOf(const PlaceSums& sums) const {
    return sums.value - sums.by_surface.dot(shift_);
  }

 private:
  Eigen::Matrix3d information_ = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right_side_ = Eigen::Vector3d::Zero();
  Eigen::LDLT<Eigen::Matrix3d> factor_;
  Eigen::Vector3d shift_ = Eigen::Vector3d::Zero();
};

// One search for the levels of a surface.
class LevelSearch {
 public:
  LevelSearch(const SurfacePlaces& places, double unevenness_m)
      : places_(places), unevenness_m_(unevenness_m), levels_(places.size(), kOnSurface) {
    const double noise_factor = kOutlierSigmas / kSignificantStddevs;
    for (const PlaceDeviation& place : places) {
      weights_.push_back(
          1.0 / (noise_factor * noise_factor * place.variance + unevenness_m * unevenness_m));
      fit_.Take(place, weights_.back());
    }
  }

  SurfaceLevels Run() {
    while (true) {
      fit_.Solve();
      Alternative best;
      best.studentised = kSignificantStddevs;
      TestPlaces(&best);
      for (const bool along_u : {true, false}) TestStrips(along_u, &best);
      if (best.kind == Alternative::kNone) return Found();
      Leave(best);
    }
  }

 private:
  // Places that may be off: one, or those from one column, or row, to another.
  struct Alternative {
    enum Kind { kNone, kPlace, kColumns, kRows };
    Kind kind = kNone;
    double studentised = 0.0;
    size_t place = 0;
    int first = 0;
    int last = 0;  // inclusive
  };

  // The step of places from the fitted surface over its standard deviation; extra: its
  // variance besides that of the places.
  double Studentised(const PlaceSums& sums, double extra) const {
    const double redundant = fit_.Redundant(sums);
    if (redundant == 0.0) return 0.0;
    return std::abs(fit_.ResidualOf(sums)) / redundant / std::sqrt(1.0 / redundant + extra);
  }
  void TestPlaces(Alternative* best) const {
    for (size_t i = 0; i < places_.size(); ++i) {
      if (levels_[i] != kOnSurface) continue;
      PlaceSums sums;
      sums.Add(places_[i], weights_[i]);
      const double studentised = Studentised(sums, 0.0);
      if (studentised <= best->studentised) continue;
      *best = {Alternative::kPlace, studentised, i, 0, 0};
    }
  }
  void TestStrips(bool along_u, Alternative* best) const {
    std::map<int, PlaceSums> strips;
    for (size_t i = 0; i < places_.size(); ++i) {
      if (levels_[i] != kOnSurface) continue;
      strips[Along(places_[i], along_u)].Add(places_[i], weights_[i]);
    }
    std::vector<int> at;
    std::vector<PlaceSums> up_to = {PlaceSums()};
    for (const auto& [index, sums] : strips) {
      at.push_back(index);
      up_to.push_back(up_to.back() + sums);
    }
    for (size_t first = 0; first < at.size(); ++first) {
      for (size_t end = first + 1; end <= at.size(); ++end) {
        if (end - first == at.size()) continue;
        const double studentised =
            Studentised(up_to[end] - up_to[first], unevenness_m_ * unevenness_m_);
        if (studentised <= best->studentised) continue;
        *best = {along_u ? Alternative::kColumns : Alternative::kRows,
                 studentised,
                 0,
                 at[first],
                 at[end - 1]};
      }
    }
  }
  // Takes from the surface what an alternative says: of a strip and the rest, the lighter one;
  // what lies before and behind a strip are two levels.
  void Leave(const Alternative& found) {
    if (found.kind == Alternative::kPlace) {
      levels_[found.place] = kOffAlone;
      fit_.Take(places_[found.place], -weights_[found.place]);
      return;
    }
    const bool along_u = found.kind == Alternative::kColumns;
    const auto is_in = [&](size_t i) {
      const int at = Along(places_[i], along_u);
      return at >= found.first && at <= found.last;
    };
    double balance = 0.0;
    for (size_t i = 0; i < places_.size(); ++i) {
      if (levels_[i] == kOnSurface) balance += (is_in(i) ? 1.0 : -1.0) * weights_[i];
    }
    const bool strip_leaves = balance <= 0.0;
    for (size_t i = 0; i < places_.size(); ++i) {
      if (levels_[i] != kOnSurface || is_in(i) != strip_leaves) continue;
      const bool is_behind = !strip_leaves && Along(places_[i], along_u) > found.last;
      levels_[i] = num_levels_ + (is_behind ? 2 : 1);
      fit_.Take(places_[i], -weights_[i]);
    }
    num_levels_ += 2;
  }
  SurfaceLevels Found() const {
    std::vector<PlaceSums> sums(static_cast<size_t>(num_levels_));
    for (size_t i = 0; i < places_.size(); ++i) {
      if (levels_[i] <= kOnSurface) continue;
      sums[static_cast<size_t>(levels_[i]) - 1].Add(places_[i], weights_[i]);
    }
    SurfaceLevels found{levels_, {}};
    for (const PlaceSums& of_level : sums) {
      found.steps_m.push_back(
          of_level.weight > 0.0 ? fit_.ResidualOf(of_level) / of_level.weight : 0.0);
    }
    return found;
  }

  const SurfacePlaces& places_;
  const double unevenness_m_;
  std::vector<double> weights_;
  std::vector<int> levels_;
  int num_levels_ = 0;
  PlaceFit fit_;
};

}  // namespace

double EstimateUnevenness(const std::vector<SurfacePlaces>& surfaces) {
  struct Residual {
    double square = 0.0;    // m^2
    double variance = 0.0;  // of the noise
  };
  std::vector<Residual> residuals;
  for (const SurfacePlaces& places : surfaces) {
    PlaceFit fit;
    for (const PlaceDeviation& place : places) fit.Take(place, 1.0 / place.variance);
    fit.Solve();
    for (const PlaceDeviation& place : places) {
      const double residual_m = fit.ResidualOf(place);
      residuals.push_back({residual_m * residual_m, place.variance});
    }
  }
  // What unevenness^2 would make a residual as large as the median of a normal variable: the
  // median of that over all of them.
  const double half = TwoSidedNormalQuantile(0.5);
  std::vector<double> needed;
  for (const Residual& residual : residuals) {
    needed.push_back(residual.square / (half * half) - residual.variance);
  }
  return std::sqrt(std::max(0.0, Median(std::move(needed))));
}

SurfaceLevels FindLevels(const SurfacePlaces& places, double unevenness_m) {
  return LevelSearch(places, unevenness_m).Run();
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

SurfacePlaces PlaceDeviations::PlacesOn(const Landmark& surface) const {
  SurfacePlaces places;
  for (const auto& [cell, sums] : places_) {
    if (sums.weight == 0) continue;  // noise of more than a metre
    const Eigen::Vector2d centre(cell.first + 0.5, cell.second + 0.5);
    const Eigen::Vector3d at_world = surface.extent.ToWorld(PatchExtent::kCellSize * centre);
    const auto weight = static_cast<double>(sums.weight);
    places.push_back(
        {cell,
         1e-6 * static_cast<double>(sums.micrometres) / weight,
         1.0 / weight,
         surface.DeviationJacobian(at_world, surface.extent.axes().u).row(0).transpose()});
  }
  return places;
}

}  // namespace plumbline
