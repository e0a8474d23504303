#pragma once

#include <Eigen/Core>
#include <map>

#include "core/cell_grid.h"
#include "core/landmark.h"

namespace plumbline {

// Where planes have openings: counts, on a fine grid over each plane, the beams at segments'
// ends that were taken to lie there and those beside them that went through. Where a wall ends
// at a door, the first beams on its jamb may pass for the wall's, seen from one place; from
// others the beams go through.
class OpeningMap {
 public:
  void CountHit(const Landmark& landmark, const Eigen::Vector3d& p_world);
  void CountPassage(const Landmark& landmark, const Eigen::Vector3d& p_world);
  // Whether more beams went through here than were taken to lie here.
  bool IsOpening(const Landmark& landmark, const Eigen::Vector3d& p_world) const;

 private:
  struct Counts {
    CellGrid hits;
    CellGrid passages;
  };

  std::map<int, Counts> counts_;  // by landmark id
};

}  // namespace plumbline
