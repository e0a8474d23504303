#include "core/recording/damage_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace plumbline {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(CountTextTest, CountsInWords) {
  EXPECT_EQ(CountText(0, "message"), "0 messages");
  EXPECT_EQ(CountText(1, "message"), "1 message");
  EXPECT_EQ(CountText(20, "chunk"), "20 chunks");
}

TEST(DamageLogTest, WithoutDamagesIsEmpty) { EXPECT_THAT(DamageLog().Sentences(), IsEmpty()); }

TEST(DamageLogTest, OneDamageIsSaidWithItsPlace) {
  DamageLog log;
  log.Add("a record is missing", 4117);
  log.Add("a line is too long", 0, 300);
  EXPECT_THAT(log.Sentences(),
              ElementsAre("a record is missing: at byte 4117",
                          "a line is too long: 300 bytes, at byte 0"));
}

TEST(DamageLogTest, DamagesOfAKindAreOneSentenceWithTheFirstPlace) {
  DamageLog log;
  log.Add("second kind of the alphabet", 900, 10);
  log.Add("a kind", 1000);
  log.Add("second kind of the alphabet", 500, 32);
  log.Add("a kind", 1500);
  log.Add("a kind", 2000);
  EXPECT_THAT(log.Sentences(),
              ElementsAre("second kind of the alphabet: 2 times, 42 bytes, first at byte 900",
                          "a kind: 3 times, first at byte 1000"));
}

}  // namespace
}  // namespace plumbline
