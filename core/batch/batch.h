#pragma once

#include <optional>
#include <vector>

#include "core/batch/batch_estimator.h"
#include "core/map/map_state.h"
#include "core/options/mapper_options.h"
#include "core/result/result_types.h"
#include "core/sensor/recording.h"
#include "core/sensor/rig.h"
#include "core/util/progress.h"

namespace plumbline {

// The batch's final estimate, and how many rounds led to it.
struct BatchReport : FinalEstimate {
  int rounds = 0;
  int changed_associations = 0;            // in the last round before the final estimation
  std::vector<LoopClosure> closures = {};  // accepted and rejected, in the order of time
  std::optional<double> drift_m = {};      // that was corrected (CorrectDrift)
};

// Returns the number of segments that another round of associations would change, by the rate
// at which the changes have become fewer from the round before the last (`before`, 0 where
// there was none) to the last one (`now`).
double ChangesToCome(int now, int before);

// Estimates all control points and planes together from all segments; nothing is marginalised.
// Estimates and associates anew until the associations hardly change, merges planes that turn
// out to be one, drops planes that the rules of core/batch/batch_policies.h refute, cuts the
// segments anew where the planes intersect (a pass over the recording), and ends with
// plain weighted least squares over the segments that agree with their planes. Leaves each
// landmark's covariance (absolute, in the model frame), extent and counts as they follow from
// the final associations.
BatchReport EstimateBatch(const Rig& rig,
                          bool planar,
                          const MapperOptions& options,
                          const ProgressCallback& progress,
                          RecordingReader* recording,
                          MapState* state);

}  // namespace plumbline
