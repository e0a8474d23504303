#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/map/landmark.h"
#include "core/map/landmark_view.h"
#include "core/sensor/rig.h"
#include "core/sensor/scan_line.h"
#include "core/visibility/occupancy_grids.h"
#include "core/visibility/plane_set.h"
#include "core/visibility/plane_trace.h"

namespace plumbline {

// Associates the single beams of a scan line with the known planes: each lies on the plane
// that it meets first, or on none.
class BeamAssociation {
 public:
  // Consecutive beams that lie on one plane.
  struct PlaneBeams {
    const LandmarkView* plane;
    Trace trace;
    int first_beam;
    int last_beam;  // inclusive
  };

  // placement: at the instant of the beams asked for. openings: of the landmarks, by id.
  BeamAssociation(const ScanLine& scan_line,
                  const Scanner& scanner,
                  const ScanPlacement& placement,
                  const PlaneSet& planes,
                  const std::vector<PlaneOpenings>& openings)
      : scan_line_(scan_line),
        scanner_(scanner),
        placement_(placement),
        planes_(planes),
        ranges_(planes, placement),
        openings_(openings) {}

  // Finds, among the beams first .. last, those whose ranges agree with the plane that they
  // meet first. Where a plane ends at an edge of which the other side has not been seen, beams
  // that meet it close to the edge are left out: they may lie on the face round the corner.
  std::vector<PlaneBeams> Associate(int first_beam, int last_beam) const;

 private:
  // The plane that the beam lies on; nullptr where the range agrees with none.
  const LandmarkView* PlaneOf(int beam) const;
  // Whether the plane has been seen at the point, and no opening there.
  bool IsSolidAt(const LandmarkView& plane,
                 const Eigen::Vector3d& p_world,
                 double margin_m) const;
  // Whether the plane ends close by at another one's edge, and the point lies beyond: in front
  // of the other, where nothing has been seen of the plane.
  bool EndsBefore(const LandmarkView& plane, const Eigen::Vector3d& p_world) const;
  // Whether the plane is solid at the point, and does not end before it; p: scanner frame.
  bool IsSeenAt(const LandmarkView& plane, const Eigen::Vector2d& p) const;
  // Whether the plane goes on close beyond the beam, or ends there at an edge that is known.
  bool GoesOn(const LandmarkView& plane, int beam, int step) const;
  // Whether the plane `beyond`, which the next beam beyond the end lies on, stands in front of
  // the plane and hides the rest of it. How far a plane was seen to a free edge is known to
  // centimetres only.
  bool IsMet(const LandmarkView& plane, const LandmarkView* beyond, int end, int step) const;

  const ScanLine& scan_line_;
  const Scanner& scanner_;
  const ScanPlacement& placement_;
  const PlaneSet& planes_;
  PlaneRanges ranges_;
  const std::vector<PlaneOpenings>& openings_;
};

}  // namespace plumbline
