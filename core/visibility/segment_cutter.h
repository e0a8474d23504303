#pragma once

#include <deque>
#include <optional>
#include <utility>
#include <vector>

#include "core/association/association.h"
#include "core/geometry/matrix_types.h"
#include "core/map/landmark_view.h"
#include "core/map/observation.h"
#include "core/options/mapper_options.h"
#include "core/sensor/rig.h"
#include "core/sensor/scan_line.h"
#include "core/trajectory/trajectory.h"
#include "core/visibility/occupancy_grids.h"
#include "core/visibility/plane_intersections.h"
#include "core/visibility/plane_set.h"
#include "core/visibility/plane_trace.h"

namespace plumbline {

// Cuts the segments of single scan lines anew where their planes meet others: what cutting has
// in common in the batch and while the rig is tracked (core/visibility/resegmentation.h).
class SegmentCutter {
 public:
  struct Range {
    int first;
    int last;
  };
  // Where a segment ends now.
  struct NewEnd {
    int beam;
    std::optional<Trace> trace = std::nullopt;  // of its own plane, if it has one
    bool is_met = false;                        // by another plane
  };
  struct Ends {
    NewEnd first;
    NewEnd last;
  };

  // The trajectory stays as it is meanwhile. openings: of the landmarks, by id; nullptr while
  // the rig is tracked: none is known yet, nor is every face of a corner. counted: counts them
  // anew; may be nullptr.
  SegmentCutter(const Rig& rig,
                const MapperOptions& options,
                const Trajectory& trajectory,
                const std::vector<PlaneOpenings>* openings,
                OccupancyGrids* counted);

  // The planes that may bound segments, their own included.
  void SetViews(std::vector<LandmarkView> candidates) {
    views_ = PlaneSet(std::move(candidates));
  }
  const PlaneSet& candidates() const { return views_; }
  const LandmarkView* Find(int landmark_id) const;
  PoseSampler* sampler() { return &sampler_; }
  SharedPoses* poses() { return &poses_; }

  // Where the observations [first, last) of a scan line end, each at both sides.
  std::vector<Ends> FindEnds(const ScanLine& scan_line,
                             const std::deque<Observation>& observations,
                             size_t first,
                             size_t last);
  // The last beam, from the end's on, up to `to` for as long as the ranges lie on the trace.
  int Extend(const ScanLine& scan_line, const Trace& trace, const FreeEnd& end, int to) const;
  // The range between the ends, shorter where the beams there can not lie on the segment's
  // plane or are off it; other such beams are left out. Returns whether the segment is another
  // one then.
  bool ExcludeOccluded(const ScanLine& scan_line,
                       const Ends& ends,
                       Range* range,
                       Observation* observation);
  // Makes the observation anew of the beams in the range, on its plane's trace. It loses its
  // landmark where it has no beams left, lies on its plane no more, or the plane is none of
  // the candidates.
  void Replace(const ScanLine& scan_line,
               const Range& range,
               const Matrix6d& pose_covariance,
               Observation* observation);

 private:
  struct TracedEnd;
  struct Bounds;
  struct IntersectionsAtEnd;

  NewEnd FindEnd(const ScanLine& scan_line,
                 const Observation& observation,
                 const FreeEnd& end);
  // The end with the trace of its plane `own` and the intersections of the trace.
  TracedEnd TraceEnd(const ScanLine& scan_line,
                     const Observation& observation,
                     const LandmarkView& own,
                     const FreeEnd& end);
  static Bounds FindBounds(const TracedEnd& traced, double far_m);
  // The intersections within a beam of last_beam, where the segment ends now.
  static IntersectionsAtEnd IntersectionsAt(const TracedEnd& traced, int last_beam);
  // Counts what the beams on both sides of the end show of openings in its plane.
  void CountAtEnd(const TracedEnd& traced, int last_beam, const IntersectionsAtEnd& at_end);
  void CountHits(const ScanLine& scan_line, const Observation& observation, const Ends& ends);
  bool IsOff(const ScanLine& scan_line, const Trace& trace, int beam) const;
  // Those between two beams of an observation, on this plane.
  std::vector<int> OccludedBeamsOf(const ScanLine& scan_line,
                                   const Observation& observation,
                                   const LandmarkView& own,
                                   const Range& range);

  const Rig& rig_;
  const MapperOptions& options_;
  const std::vector<PlaneOpenings>* openings_;
  OccupancyGrids* counted_;
  PoseSampler sampler_;
  SharedPoses poses_;
  PlaneSet views_;
};

}  // namespace plumbline
