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
  PatchExtent::Cell cell;
  double value_m = 0.0;   // weighted mean
  double variance = 0.0;  // m^2, of the beams' noise
  Eigen::Vector3d by_surface = Eigen::Vector3d::Zero();  // by the surface's parameters
};
using SurfacePlaces = std::vector<PlaceDeviation>;

// Returns by how much, m, the places of surfaces deviate from these besides their noise: the
// median over all of them, as a standard deviation, so that the few that lie on other surfaces
// do not count.
double EstimateUnevenness(const std::vector<SurfacePlaces>& surfaces);

// Where a place lies: on the surface that the others show, alone off it, or, from 1 on, on a
// level that it shares with a strip of others.
enum : int { kOffAlone = -1, kOnSurface = 0 };
struct SurfaceLevels {
  std::vector<int> of_place;
  std::vector<double> steps_m;  // of the level 1, 2, ... from the surface
};

// Tells which places do not lie on the surface that the others show: data snooping (Baarda
// 1968, "A testing procedure for use in geodetic networks"). The surface's parameters are
// fitted to the places, and the alternative of the largest studentised step is taken where
// that is significant, and so on. The alternatives: a place is off alone; the columns or rows
// of places from one to another are a level of their own, as where a wall goes on behind a
// cupboard's doors. What is lighter leaves. unevenness_m: it moves a level as much as a place;
// significant is a step of kSignificantStddevs of it, and of kOutlierSigmas of the noise,
// which is to explain none of a map's thousands of places. A place that alone shows a
// parameter is not tested.
SurfaceLevels FindLevels(const SurfacePlaces& places, double unevenness_m);

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
  // The places of the surface.
  SurfacePlaces PlacesOn(const Landmark& surface) const;

 private:
  // Whole numbers: their sums are the same in any order.
  struct Sums {
    int64_t weight = 0;       // 1/m^2
    int64_t micrometres = 0;  // weighted deviations
  };
  std::map<PatchExtent::Cell, Sums> places_;
};

}  // namespace plumbline
