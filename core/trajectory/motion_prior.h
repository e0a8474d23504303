#pragma once

#include <set>

#include "core/options/mapper_options.h"
#include "core/trajectory/motion_noise.h"

namespace plumbline {

// MotionPrior gives the noise of the motion prior on three control points while the rig is
// followed. The usual one is weak, so that no motion is held back, less so in height, since
// what carries the rig stands on a floor: on stairs, where for seconds one tread or another is
// all that shows the height, a weak one lets the rig slip by a tread. Where the motion alone
// has to bridge what no scan shows, it is that of a rig that keeps its pace: after some
// seconds the usual one would let the rig be anywhere, and any wall take hold of it.
class MotionPrior {
 public:
  explicit MotionPrior(const TrajectoryOptions& options);

  // Of the control points first .. first + 2.
  MotionNoise At(int first) const;
  // Makes the motion bridge the control points first .. end - 1.
  void Bridge(int first, int end);

 private:
  MotionNoise usual_;
  MotionNoise bridging_;
  std::set<int> bridged_;
};

}  // namespace plumbline
