#include "core/consistency/likely_cause.h"

#include <gtest/gtest.h>

namespace plumbline {
namespace {

CauseCandidate Candidate(CauseOrder order, double start_s, double strength, const char* name) {
  CauseCandidate candidate;
  candidate.order = order;
  candidate.start_s = start_s;
  candidate.strength = strength;
  candidate.cause.name = name;
  return candidate;
}

TEST(LikelyCause, NothingHasNone) { EXPECT_FALSE(LikeliestCause({}).has_value()); }

TEST(LikelyCause, LiesOfTheRecordingComeBeforeThoseOfMountings) {
  const auto cause = LikeliestCause({Candidate(CauseOrder::kMap, 0.0, 9.0, "map"),
                                     Candidate(CauseOrder::kScanner, 0.0, 9.0, "scanner"),
                                     Candidate(CauseOrder::kRecording, 5.0, 1.0, "clock")});
  EXPECT_EQ(cause->name, "clock");
}

TEST(LikelyCause, TheFirstOfAKindThenTheStrongest) {
  const auto cause = LikeliestCause({Candidate(CauseOrder::kMotion, 7.0, 9.0, "later"),
                                     Candidate(CauseOrder::kMotion, 3.0, 1.0, "weak"),
                                     Candidate(CauseOrder::kMotion, 3.0, 2.0, "strong")});
  EXPECT_EQ(cause->name, "strong");
}

}  // namespace
}  // namespace plumbline
