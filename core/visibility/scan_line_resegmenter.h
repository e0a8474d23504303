#pragma once

#include <deque>
#include <optional>
#include <utility>
#include <vector>

#include "core/association/association.h"
#include "core/geometry/matrix_types.h"
#include "core/map/observation.h"
#include "core/options/mapper_options.h"
#include "core/sensor/rig.h"
#include "core/sensor/scan_line.h"
#include "core/surface/landmark_view.h"
#include "core/trajectory/trajectory.h"
#include "core/visibility/occupancy_grids.h"
#include "core/visibility/plane_intersections.h"
#include "core/visibility/plane_set.h"
#include "core/visibility/plane_trace.h"

namespace plumbline {

// Resegments single scan lines: finds the new ends of their segments where the planes
// intersect, and makes the observations anew (core/visibility/resegmentation.h). The batch and
// the tracked scan share it.
class ScanLineResegmenter {
 public:
  // Beams first .. last.
  struct BeamRange {
    int first;
    int last;
  };
  // The new end of a segment.
  struct NewEnd {
    int beam;
    std::optional<Trace> trace = std::nullopt;  // of its own plane, if it has one
    bool is_met = false;                        // whether another plane meets it there
  };
  // Both new ends of a segment.
  struct Ends {
    NewEnd first;
    NewEnd last;
  };

  // The trajectory stays as it is meanwhile. openings: of the landmarks, by id; nullptr while
  // the rig is tracked: none is known yet, nor is every face of a corner. counted: takes the
  // counts for new openings; may be nullptr.
  ScanLineResegmenter(const Rig& rig,
                      const MapperOptions& options,
                      const Trajectory& trajectory,
                      const std::vector<PlaneOpenings>* openings,
                      OccupancyGrids* counted);

  // Sets the planes that may bound segments, their own included.
  void SetViews(std::vector<LandmarkView> views) { views_ = PlaneSet(std::move(views)); }
  const PlaneSet& views() const { return views_; }
  // The view of a landmark; nullptr where there is none.
  const LandmarkView* Find(int landmark_id) const;
  PoseSampler* sampler() { return &sampler_; }
  SharedPoses* poses() { return &poses_; }

  // Finds the new ends of the observations [first, last) of a scan line.
  std::vector<Ends> FindEnds(const ScanLine& scan_line,
                             const std::deque<Observation>& observations,
                             size_t first,
                             size_t last);
  // Extends a segment from its end's beam to the last one, up to `to`, for as long as the
  // ranges lie on the trace; returns that beam.
  int Extend(const ScanLine& scan_line, const Trace& trace, const FreeEnd& end, int to) const;
  // Computes the range between the ends, shorter where the beams there can not lie on the
  // segment's plane or are off it; other such beams are excluded. Returns whether the segment
  // is another one then.
  bool ExcludeOccluded(const ScanLine& scan_line,
                       const Ends& ends,
                       BeamRange* range,
                       Observation* observation);
  // Makes the observation anew from the beams in the range, on its plane's trace. It loses its
  // landmark where it has no beams left, lies on its plane no more, or the plane is none of
  // the views.
  void Replace(const ScanLine& scan_line,
               const BeamRange& range,
               const Matrix6d& pose_covariance,
               Observation* observation);

  // Where the surface is an arc, makes its observation anew from the beams in the range, each
  // where it meets the arc; those off it are left out. Lines through chords chose their beams
  // by another measure: they took beams towards the chord from the bow's middle and its ends.
  // Returns whether it is an arc.
  bool TakeToArc(const ScanLine& scan_line,
                 const Landmark& surface,
                 const BeamRange& range,
                 Observation* observation);

 private:
  struct TracedEnd;
  struct Bounds;
  struct IntersectionsAtEnd;

  // Finds the new end of an observation at one side.
  NewEnd FindEnd(const ScanLine& scan_line,
                 const Observation& observation,
                 const FreeEnd& end);
  // The end with the trace of its plane `own` and the intersections of the trace.
  TracedEnd TraceEnd(const ScanLine& scan_line,
                     const Observation& observation,
                     const LandmarkView& own,
                     const FreeEnd& end);
  // The beams that the intersections leave to the segment; far_m: see the definition.
  static Bounds FindBounds(const TracedEnd& traced, double far_m);
  // The intersections within a beam of last_beam, where the segment ends now.
  static IntersectionsAtEnd IntersectionsAt(const TracedEnd& traced, int last_beam);
  // Counts what the beams on both sides of the end show of openings in its plane.
  void CountAtEnd(const TracedEnd& traced, int last_beam, const IntersectionsAtEnd& at_end);
  // Counts the beams between the ends that lie on the observation's plane.
  void CountHits(const ScanLine& scan_line, const Observation& observation, const Ends& ends);
  // Whether a beam is too far from the plane to be the last one at a free end.
  bool IsOff(const ScanLine& scan_line, const Trace& trace, int beam) const;
  // The beams of an observation in the range that can not lie on its plane `own`.
  std::vector<int> OccludedBeamsOf(const ScanLine& scan_line,
                                   const Observation& observation,
                                   const LandmarkView& own,
                                   const BeamRange& range);

  const Rig& rig_;
  const MapperOptions& options_;
  const std::vector<PlaneOpenings>* openings_;
  OccupancyGrids* counted_;
  PoseSampler sampler_;
  SharedPoses poses_;
  PlaneSet views_;
};

}  // namespace plumbline
