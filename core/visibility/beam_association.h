#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/sensor/rig.h"
#include "core/sensor/scan_line.h"
#include "core/surface/landmark.h"
#include "core/surface/landmark_view.h"
#include "core/visibility/occupancy_grids.h"
#include "core/visibility/plane_set.h"
#include "core/visibility/plane_trace.h"

namespace plumbline {

// Associates the single beams of a scan line with the known surfaces: each lies on the one
// that it meets first, or on none.
class BeamAssociation {
 public:
  // Consecutive beams that lie on one surface.
  struct PlaneBeams {
    const LandmarkView* plane;
    Trace trace;  // of a cylinder at the first beam
    int first_beam;
    int last_beam;  // inclusive
    // Whether another surface meets this one at the end.
    bool is_first_met = true;
    bool is_last_met = true;
  };
  // The beams that are associated.
  enum class Kind {
    // Beams that no segment has: what puts one on a surface is its range alone.
    kLeftOver,
    // All beams of a scan line. A run as long as a segment lies on its surface as a whole: it
    // is bounded as segments are, and its beams may be farther off.
    kWholeLine,
  };

  // placement: at the instant of the beams asked for. openings: of the landmarks, by id.
  BeamAssociation(const ScanLine& scan_line,
                  const Scanner& scanner,
                  const ScanPlacement& placement,
                  const PlaneSet& planes,
                  const std::vector<PlaneOpenings>& openings,
                  Kind kind = Kind::kLeftOver)
      : scan_line_(scan_line),
        scanner_(scanner),
        placement_(placement),
        planes_(planes),
        ranges_(planes, placement),
        openings_(openings),
        kind_(kind) {}

  // Finds, among the beams first .. last, those whose ranges agree with the surface that they
  // meet first. Where a surface ends at an edge of which the other side has not been seen,
  // beams that meet it close to the edge are left out: they may lie on the face round the
  // corner.
  std::vector<PlaneBeams> Associate(int first_beam, int last_beam) const;

 private:
  // The range of a beam along a direction on the surface; infinite where it does not meet it.
  double RangeAlong(const LandmarkView& surface, const Eigen::Vector2d& direction) const;
  // The trace of the surface, of a cylinder near the place where the beam meets it.
  Trace TraceAt(const LandmarkView& surface, int beam) const;
  // The plane that the beam lies on; nullptr where the range agrees with none.
  const LandmarkView* PlaneOf(int beam) const;
  // Whether the surface, at this range, goes over into another without a corner, as a wall
  // into an arc: which of them a beam lies on can not be told over metres.
  bool GoesOverInto(const LandmarkView& surface,
                    const Eigen::Vector2d& direction,
                    double range) const;
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
  Kind kind_;
};

}  // namespace plumbline
