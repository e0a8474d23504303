#include "core/result/symptoms.h"

#include <gtest/gtest.h>

namespace plumbline {
namespace {

TEST(Symptoms, AreGroupedByIntervalEachReasonOnce) {
  const std::vector<SymptomGroup> groups = GroupSymptoms({{4.0, 6.0, "it jumps"},
                                                          {3.0, 12.0, "beams pass"},
                                                          {9.0, 12.0, "it jumps"},
                                                          {20.0, 22.0, "beams pass"}});
  ASSERT_EQ(groups.size(), 2u);
  EXPECT_EQ(groups[0].start_s, 3.0);
  EXPECT_EQ(groups[0].end_s, 12.0);
  ASSERT_EQ(groups[0].symptoms.size(), 2u);
  EXPECT_EQ(SymptomText(groups[0].symptoms[0], groups[0]), "beams pass");
  EXPECT_EQ(SymptomText(groups[0].symptoms[1], groups[0]),
            "it jumps (from 4 to 6 s, from 9 to 12 s)");
  ASSERT_EQ(groups[1].symptoms.size(), 1u);
  EXPECT_EQ(groups[1].start_s, 20.0);
  EXPECT_EQ(groups[1].end_s, 22.0);
}

TEST(Symptoms, OfIntervalsThatTouchAreOneGroup) {
  const std::vector<SymptomGroup> groups = GroupSymptoms({{0.0, 5.0, "a"}, {5.0, 7.0, "b"}});
  ASSERT_EQ(groups.size(), 1u);
  EXPECT_EQ(groups[0].end_s, 7.0);
  EXPECT_EQ(SymptomText(groups[0].symptoms[1], groups[0]), "b (from 5 to 7 s)");
  EXPECT_TRUE(GroupSymptoms({}).empty());
}

}  // namespace
}  // namespace plumbline
