#pragma once

#include "core/estimation/map_covariance.h"
#include "core/map/map_state.h"
#include "core/options/mapper_options.h"
#include "core/sensor/recording.h"
#include "core/sensor/rig.h"
#include "core/trajectory/motion_noise.h"
#include "core/util/progress.h"
#include "core/util/stopwatch.h"

namespace plumbline {

struct BatchReport {
  int rounds = 0;
  int changed_associations = 0;  // in the last round before the final estimation
  MotionNoise motion_noise;      // of the recording, which the final estimate assumes
  double variance_factor = 0.0;  // weighted sum of squares / redundancy
  MapCovariance covariance;      // of the final estimate
  Stopwatch covariance_watch;    // the time it took, part of the batch's
};

// How many segments another round of associations would change, by the rate at which they have
// become fewer from the round before the last to the last; before: 0 where there was none.
double ChangesToCome(int now, int before);

// The final estimation: all segments, control points and planes together, no marginalised
// history. Estimates and associates anew until the associations stand, merges planes that turn
// out to be one, drops those that too few scans support, cuts the segments anew where the
// planes meet (a pass over the recording), where asked to estimates how steadily the rig
// moves, and ends as plain weighted least squares over the segments that agree with their
// planes. Leaves each landmark's covariance (absolute, in the model frame), extent and counts
// as they follow from the final associations.
BatchReport EstimateBatch(const Rig& rig,
                          bool planar,
                          const MapperOptions& options,
                          const ProgressCallback& progress,
                          RecordingReader* recording,
                          MapState* state);

}  // namespace plumbline
