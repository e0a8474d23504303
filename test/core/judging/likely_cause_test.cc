#include "core/judging/likely_cause.h"

#include <gtest/gtest.h>

namespace plumbline {
namespace {

CauseCandidate Candidate(CauseOrder order, double start_s, const char* name) {
  CauseCandidate candidate;
  candidate.order = order;
  candidate.start_s = start_s;
  candidate.cause.name = name;
  return candidate;
}

TEST(LikelyCause, NothingHasNone) { EXPECT_FALSE(LikeliestCause({}).has_value()); }

TEST(LikelyCause, AWrongScannerComesBeforeWhatItBringsForth) {
  const auto cause = LikeliestCause({Candidate(CauseOrder::kMap, 0.0, "map"),
                                     Candidate(CauseOrder::kMotion, 0.0, "motion"),
                                     Candidate(CauseOrder::kScanner, 5.0, "scanner")});
  EXPECT_EQ(cause->name, "scanner");
}

TEST(LikelyCause, IsTheFirstOfItsKind) {
  const auto cause = LikeliestCause({Candidate(CauseOrder::kMotion, 7.0, "later"),
                                     Candidate(CauseOrder::kMotion, 3.0, "first")});
  EXPECT_EQ(cause->name, "first");
}

}  // namespace
}  // namespace plumbline
