#include "core/sensor/mount_collector.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace plumbline {
namespace {

constexpr int64_t kStep = 10'000'000;  // ns

class MountCollectorTest : public testing::Test {
 protected:
  MountCollectorTest() {
    rig_.scanners.resize(2);
    rig_.scanners[0].name = "fixed";
    rig_.scanners[1].name = "nodding";
    rig_.scanners[1].mount.emplace();
    rig_.scanners[1].mount->joint_topic = "/angle";
    topic_.name = "/angle";
    topic_.kind = MessageKind::kNumber;
  }

  // A reading every step but one.
  MountCollector Collect() const {
    MountCollector collector(rig_);
    for (int i = 0; i < 100; ++i) {
      if (i >= 40 && i < 60) continue;
      collector.Add(topic_, {i * kStep, {""}, {0.01 * i}});
    }
    collector.Finish("a.bag", {topic_}, "");
    return collector;
  }

  Rig rig_;
  RecordingTopic topic_;
};

TEST_F(MountCollectorTest, TakesTheAnglesOfItsTopics) {
  EXPECT_TRUE(MountCollector(rig_).Wants(topic_));
  RecordingTopic other = topic_;
  other.name = "/other";
  EXPECT_FALSE(MountCollector(rig_).Wants(other));
  other = topic_;
  other.kind = MessageKind::kOther;
  EXPECT_FALSE(MountCollector(rig_).Wants(other));
  const MountCollector collector = Collect();
  EXPECT_EQ(collector.angles()[0], nullptr);
  ASSERT_NE(collector.angles()[1], nullptr);
  EXPECT_NEAR(collector.angles()[1]->At(20 * kStep).angle_rad, 0.2, 1e-12);
}

TEST_F(MountCollectorTest, CountsLinesDuringWhichNothingTellsTheAngle) {
  MountCollector collector = Collect();
  EXPECT_FALSE(collector.PassesOver(0, 50 * kStep, 0.02)) << "it is fixed";
  EXPECT_FALSE(collector.PassesOver(1, 20 * kStep, 0.02));
  std::vector<std::string> warnings;
  collector.AddWarnings(&warnings);
  EXPECT_TRUE(warnings.empty());
  EXPECT_TRUE(collector.PassesOver(1, 38 * kStep, 0.05)) << "it ends in the gap";
  EXPECT_TRUE(collector.PassesOver(1, 50 * kStep, 0.02));
  collector.AddLost(topic_, {5'000'000'000, 0, 0, 0, 0});
  collector.AddWarnings(&warnings);
  ASSERT_EQ(warnings.size(), 2u);
  EXPECT_EQ(warnings[0],
            "the mount of scanner 'nodding': 1 message is lost that can not be decoded, the "
            "first recorded at 5.000000000 s");
  EXPECT_EQ(warnings[1].rfind("scanner 'nodding': 2 scan lines are passed over as nothing "
                              "tells the angle of the mount then, the first stamped "
                              "0.380000000 s",
                              0),
            0u)
      << warnings[1];
}

}  // namespace
}  // namespace plumbline
