#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <vector>

#include "core/surface/landmark.h"
#include "core/surface/patch_extent.h"

namespace plumbline {

// What the beams at one place of a surface deviate by from it.
struct PlaceDeviation {
  double value_m = 0.0;   // weighted mean
  double variance = 0.0;  // m^2, of the beams' noise and the surface's unevenness
  Eigen::Vector3d by_surface = Eigen::Vector3d::Zero();  // by the surface's parameters
};

// Tells which places do not lie on the surface that the others show: data snooping (Baarda
// 1968, "A testing procedure for use in geodetic networks"). The surface's parameters are
// fitted to the places, the place of the largest studentised residual is left out where that
// is above kSignificantStddevs, and so on. A place that alone shows a parameter is not tested.
// Returns one element per place.
std::vector<bool> FindPlacesOff(const std::vector<PlaceDeviation>& places);

// PlaceDeviations collects what beams deviate by from a surface, place by place: a recess, a
// door leaf or a cupboard close to a wall passes the test of each beam and of each segment,
// whose noise is larger, and turns the wall. A place is a cell of the surface's extent, in
// which unevenness is alike.
class PlaceDeviations {
 public:
  // Counts a beam that meets the surface at a point in its extent's axes. deviation_m: along
  // the normal; stddev_m: of its noise along the normal.
  void Add(const Eigen::Vector2d& uv, double deviation_m, double stddev_m);
  // Adds the counts of another's beams on the same surface.
  void Add(const PlaceDeviations& other);
  // The places that do not lie on the surface (FindPlacesOff). flatness_m: its unevenness.
  std::vector<PatchExtent::Cell> CellsOff(const Landmark& surface, double flatness_m) const;

 private:
  // Whole numbers: their sums are the same in any order.
  struct Sums {
    int64_t weight = 0;       // 1/m^2
    int64_t micrometres = 0;  // weighted deviations
  };
  std::map<PatchExtent::Cell, Sums> places_;
};

}  // namespace plumbline
