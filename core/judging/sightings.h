#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <utility>
#include <vector>

#include "core/map/map_state.h"
#include "core/sensor/rig.h"
#include "core/surface/cell_grid.h"

namespace plumbline {

// Counts of the beams of one second in one cell of a plane's patch: how many ended on it, and
// how many went through it.
struct Sighting {
  int32_t landmark_id = 0;
  CellGrid::Cell cell;
  int32_t second = 0;  // of the recording
  int32_t num_hits = 0;
  int32_t num_passages = 0;

  // Whether the cell was a surface in this second, or was none: a few beams that say so, and
  // hardly one that says otherwise.
  bool is_solid() const { return num_hits >= kFew && num_hits >= kMajority * num_passages; }
  bool is_passed() const {
    return num_passages >= kFew && num_passages >= kMajority * num_hits;
  }

  // One beam may graze an edge.
  static constexpr int kFew = 2;
  static constexpr int kMajority = 4;
};

// All sightings of a finished map's planes, by plane, cell and second.
class Sightings {
 public:
  Sightings() = default;
  // Sorts them.
  explicit Sightings(std::vector<Sighting> all);

  const std::vector<Sighting>& all() const { return all_; }
  // Calls visit(first, last) for the sightings of each cell, in order of time.
  template <typename Visit>
  void ForEachCell(Visit visit) const {
    size_t first = 0;
    while (first < all_.size()) {
      size_t last = first + 1;
      while (last < all_.size() && all_[last].landmark_id == all_[first].landmark_id &&
             all_[last].cell == all_[first].cell) {
        ++last;
      }
      visit(all_.data() + first, all_.data() + last);
      first = last;
    }
  }
  // The sightings [first, last) of one cell.
  std::pair<const Sighting*, const Sighting*> Of(int landmark_id,
                                                 const CellGrid::Cell& cell) const;
  // The sightings [first, last) of one plane.
  std::pair<const Sighting*, const Sighting*> Of(int landmark_id) const;
  int num_seconds() const { return num_seconds_; }

 private:
  std::vector<Sighting> all_;
  int num_seconds_ = 0;
};

// The place of an observation in the finished map.
struct PlacedSegment {
  Eigen::Vector3d scanner_world;
  Eigen::Vector3d start_world;
  Eigen::Vector3d end_world;
  // Vector from the chord of an arc to its middle.
  Eigen::Vector3d bow_world = Eigen::Vector3d::Zero();
  // The share of the bow at the middle: of its regression line, which begins and ends beside
  // the arc, a third.
  double at_middle = 1.0 / 3.0;

  Eigen::Vector3d At(double share) const {
    const double from_middle = share - 0.5;
    return start_world + share * (end_world - start_world) +
           (at_middle - 4.0 * from_middle * from_middle) * bow_world;
  }
};

PlacedSegment Place(const Observation& observation,
                    const std::deque<Landmark>& landmarks,
                    SharedPoses* poses);

// The second of the recording that an instant lies in.
int SecondOf(int64_t start_ns, int64_t time_ns);

// The positions [first, last) in state.observations of each second. The observations are in
// the order of time, as the mapper leaves them.
std::vector<std::pair<size_t, size_t>> ObservationsBySecond(int64_t start_ns,
                                                            const MapState& state);

// Casts the beams of all segments, with or without a plane, through the finished map, each
// from the place that the finished trajectory gives its scanner. Of a segment a few beams
// stand for all. A beam passes through a plane if it begins and ends well away from it on both
// sides, where the plane has been seen all around. Works on the threads of the caller's
// tbb::task_arena. start_ns: of the recording.
Sightings CollectSightings(const Rig& rig, const MapState& state, int64_t start_ns);

}  // namespace plumbline
