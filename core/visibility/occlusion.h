#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/geometry/scan_plane_motion.h"
#include "core/map/observation_poses.h"
#include "core/sensor/rig.h"
#include "core/sensor/scan_line.h"
#include "core/surface/landmark.h"
#include "core/surface/landmark_view.h"
#include "core/visibility/occupancy_grids.h"
#include "core/visibility/plane_trace.h"

namespace plumbline {

// Finds beams of a segment that can not lie on its plane, whatever their range: the place
// where they meet the plane is an opening, or behind an edge of the building. At grazing
// incidence such a beam may pass for one on the plane, and there a single beam weighs as much
// as thousands of others.
struct Occlusion {
  const ScanLine& scan_line;
  const Scanner& scanner;
  const ObservationPoses& poses;  // of the segment
  const LandmarkView& plane;
  int first_beam;
  int last_beam;  // inclusive

  // The beams that meet the plane in an opening, and those at grazing incidence near one,
  // which may do so.
  std::vector<int> InOpenings(const PlaneOpenings& openings) const;
  // The beams that meet a floor or ceiling behind two walls at once, both seen close by:
  // between the two faces of a corner that stands into the segment. Without a corner there,
  // nothing is behind both that a beam could reach.
  std::vector<int> BehindCorners(const std::vector<LandmarkView>& others) const;
  // The beams that meet a floor or ceiling close behind a single wall, where the wall has been
  // seen: they end on its face. This finds corners of which the other face has not come into
  // view yet, at the price of the floor beside a door's jambs.
  std::vector<int> BehindWalls(const std::vector<LandmarkView>& others) const;
  // Counts the beams that lie on the plane, away from both ends: a few stand for all of them.
  void CountHits(OccupancyGrids* grids) const;

 private:
  // A wall that the segment crosses, and the share of the segment's length where.
  struct WallCrossing {
    const LandmarkView* wall;
    double at;
  };
  // All walls that the segment crosses on the way from its first beam to its last.
  struct WallCrossings {
    Eigen::Vector3d start;  // where these two beams meet the plane, in the world
    Eigen::Vector3d end;
    std::vector<WallCrossing> leaving;   // where the segment goes behind the wall
    std::vector<WallCrossing> entering;  // where it comes from behind the wall

    Eigen::Vector3d PointAt(double share) const { return start + share * (end - start); }
  };

  // The plane as the beams meet it.
  struct PlaneView {
    PlaneTrace trace;
    const ScanMotion& motion;
  };

  // Consecutive beams, and the points where the first and the last meet the plane; nothing
  // where that is at grazing incidence.
  struct BeamSpan {
    int first;
    int last;  // inclusive
    std::optional<Eigen::Vector3d> start;
    std::optional<Eigen::Vector3d> end;
  };

  PlaneView MakePlaneView() const;
  int64_t BeamInstantNs(int beam) const;
  // The walls that a segment on a floor or ceiling crosses; none where an end meets the plane
  // too obliquely for its place to be known.
  WallCrossings FindCrossings(const std::vector<LandmarkView>& others) const;
  // The beam that meets the plane at a share of the segment's length, whole or between two.
  double BeamAt(const WallCrossings& crossings, double share) const;
  // The point in the world where a beam along a direction meets the plane; nothing where the
  // cosine of the angle between beam and normal is below a minimum.
  std::optional<Eigen::Vector3d> IntersectionPoint(const PlaneView& view,
                                                   int beam,
                                                   const Eigen::Vector2d& direction,
                                                   double min_cosine) const;
  std::optional<Eigen::Vector3d> SafeIntersectionPoint(const PlaneView& view, int beam) const;
  // Appends the beams of the span that InOpenings() finds.
  void AddOpen(const PlaneView& view,
               const PlaneOpenings& openings,
               const BeamSpan& span,
               std::vector<int>* beams) const;
  // Whether a beam at grazing incidence may meet the plane in an opening.
  bool IsNearOpening(const PlaneView& view,
                     int beam,
                     const Eigen::Vector2d& direction,
                     const PlaneOpenings& openings) const;
};

// An end of a segment on a plane's trace; the beams leave the segment in steps of +1 or -1.
struct SegmentEnd {
  const ScanLine& scan_line;
  const Scanner& scanner;
  const ScanPlacement& placement;  // at the end's instant
  const Trace& trace;
  const Landmark& landmark;
  int beam;    // the last one
  int step;    // outwards
  int middle;  // of the segment
};

// Counts the segment's last beams, which lie on the plane, as hits.
void CountHitsAtEnd(const SegmentEnd& end, OccupancyGrids* grids);
// Counts the beams beyond the end that pass through the plane, or that something in front of
// it stops.
void CountPassages(const SegmentEnd& end, OccupancyGrids* grids);

}  // namespace plumbline
