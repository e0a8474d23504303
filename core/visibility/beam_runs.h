#pragma once

#include <functional>
#include <vector>

#include "core/geometry/scan_plane_motion.h"
#include "core/map/observation.h"
#include "core/sensor/rig.h"
#include "core/sensor/scan_line.h"
#include "core/visibility/beam_association.h"
#include "core/visibility/occupancy_grids.h"
#include "core/visibility/plane_set.h"

namespace plumbline {

// All beams of a scan line by the surfaces that they lie on.
struct BeamRuns {
  // Runs of beams, each on one surface, in their order. Runs on a cylinder are as short as
  // segments have to be.
  std::vector<BeamAssociation::PlaneBeams> runs;
  // The few beams within a run that do not lie on its surface.
  std::vector<int> between;

  // The longest run on an observation's surface, among its beams, that is not taken;
  // runs.size() where there is none.
  size_t RunOf(const Observation& observation, const std::vector<bool>& is_taken) const;
};

// Finds which surface each beam of a scan line lies on. It serves planes and cylinders alike:
// corners, edges, openings and what hides what follow from which surface a beam meets first
// where that has been seen. placement_at: the scan plane's at the instant of a beam; openings:
// of the landmarks, by id.
BeamRuns FindBeamRuns(const ScanLine& scan_line,
                      const Scanner& scanner,
                      const std::function<ScanPlacement(int beam)>& placement_at,
                      const PlaneSet& surfaces,
                      const std::vector<PlaneOpenings>& openings);

}  // namespace plumbline
