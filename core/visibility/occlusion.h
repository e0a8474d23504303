#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/geometry/scan_plane_motion.h"
#include "core/map/landmark.h"
#include "core/map/landmark_view.h"
#include "core/map/observation_poses.h"
#include "core/sensor/rig.h"
#include "core/sensor/scan_line.h"
#include "core/visibility/occupancy_grids.h"
#include "core/visibility/plane_trace.h"

namespace plumbline {

// Beams of a segment that can not lie on its plane, whatever their range: the place where they
// meet it is an opening, or behind an edge of the building. At grazing incidence such a beam
// may pass for the plane's, and there a single one weighs as much as thousands of others.
struct Occlusion {
  const ScanLine& scan_line;
  const Scanner& scanner;
  const ObservationPoses& poses;  // of the segment
  const LandmarkView& plane;
  int first_beam;
  int last_beam;  // inclusive

  // Those that meet the plane in an opening of it, and those at grazing incidence near one,
  // which may.
  std::vector<int> InOpenings(const PlaneOpenings& openings) const;
  // Those that meet a floor or ceiling behind two walls at once, both seen close by: between
  // the two faces of a corner that stands into the segment. Without a corner there, nothing is
  // behind both that a beam could reach.
  std::vector<int> BehindCorners(const std::vector<LandmarkView>& others) const;
  // Those that meet a floor or ceiling close behind a single wall, where it has been seen:
  // they end on its face. Tells a corner of which the other face has not come into view yet,
  // at the price of the floor beside a door's jambs.
  std::vector<int> BehindWalls(const std::vector<LandmarkView>& others) const;
  // Counts those that lie on the plane, away from both ends: some stand for all.
  void CountHits(OccupancyGrids* openings) const;

 private:
  // A wall that the segment crosses, at this share of its length.
  struct WallCrossing {
    const LandmarkView* wall;
    double at;
  };
  // All of them, on the way from the segment's first beam to its last.
  struct WallCrossings {
    Eigen::Vector3d start;  // where these two beams meet the plane, in the world
    Eigen::Vector3d end;
    std::vector<WallCrossing> leaving;   // goes behind the wall
    std::vector<WallCrossing> entering;  // comes from behind it

    Eigen::Vector3d PointAt(double share) const { return start + share * (end - start); }
  };

  // Where beams meet the plane.
  struct PlaneView {
    PlaneTrace trace;
    const ScanMotion& motion;
  };

  // Beams in a row, and where the first and the last meet the plane; nothing where that is
  // at grazing incidence.
  struct Stretch {
    int first;
    int last;  // inclusive
    std::optional<Eigen::Vector3d> start;
    std::optional<Eigen::Vector3d> end;
  };

  PlaneView MakePlaneView() const;
  int64_t BeamInstantNs(int beam) const;
  // None where an end is too grazing to tell where it lies.
  WallCrossings FindCrossings(const PlaneView& view,
                              const std::vector<LandmarkView>& others) const;
  // The beam that meets the plane at a share of the segment's length, whole or between two.
  double BeamAt(const WallCrossings& crossings, double share) const;
  // Where a beam along a direction meets the plane, in the world; nothing where the cosine of
  // the angle between beam and normal is below a minimum.
  std::optional<Eigen::Vector3d> IntersectionPoint(const PlaneView& view,
                                                   int beam,
                                                   const Eigen::Vector2d& direction,
                                                   double min_cosine) const;
  std::optional<Eigen::Vector3d> SafeIntersectionPoint(const PlaneView& view, int beam) const;
  // Those of the stretch that InOpenings() finds.
  void AddOpen(const PlaneView& view,
               const PlaneOpenings& openings,
               const Stretch& stretch,
               std::vector<int>* beams) const;
  // Of a beam at grazing incidence.
  bool IsNearOpening(const PlaneView& view,
                     int beam,
                     const Eigen::Vector2d& direction,
                     const PlaneOpenings& openings) const;
};

// The end of a segment on a plane's trace; the beams leave it in steps of +1 or -1.
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

// Counts the segment's last beams, which lie on the plane.
void CountHitsAtEnd(const SegmentEnd& end, OccupancyGrids* openings);
// Counts what the beams beyond the end tell of openings in its plane.
void CountPassages(const SegmentEnd& end, OccupancyGrids* openings);

}  // namespace plumbline
