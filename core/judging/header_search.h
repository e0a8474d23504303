#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/judging/topic_survey.h"
#include "core/judging/view_comparison.h"
#include "core/sensor/rig.h"

namespace plumbline {

// Headers that the drivers may have meant, under which the scanners agree.
struct OtherHeader {
  std::vector<Scanner> scanners;  // whose headers are other, as the rig file has to state them
  std::string words;              // "time_increment is wrong ..."
  std::string advice;
  double share_as_stated = 0.0;  // of the places that two scanners see, within 1.5 cm
  double share_so = 0.0;
  std::vector<std::vector<SampledLine>> sample;  // with these headers
};

// Tries headers as drivers get them wrong, of all scanners and of each: angles that are one
// beam's share too far apart or too near, beams that are measured faster, slower or the other
// way round than time_increment says. Returns the one under which the scanners agree clearly
// better than as the recording says; nothing where there is none.
//   topics   of the sample
//   scanners of the rig, as the rig file states them
std::optional<OtherHeader> FindOtherHeader(const std::vector<std::vector<SampledLine>>& sample,
                                           const std::vector<TopicSurvey>& topics,
                                           const MountedRig& rig,
                                           const std::vector<Scanner>& scanners);

// The rig file that states these headers instead of the recording's.
Rig WithHeaders(Rig rig, const OtherHeader& headers);

// The number of places that any two scanners see, and the share that they see within 1.5 cm of
// each other.
size_t NumPlaces(const std::vector<std::vector<SampledLine>>& sample, const MountedRig& rig);
double NearShareOfAll(const std::vector<std::vector<SampledLine>>& sample,
                      const MountedRig& rig);

// Returns the least difference of two shares of num_places places that is significant.
double SignificantDifference(double share_a, double share_b, size_t num_places);

}  // namespace plumbline
