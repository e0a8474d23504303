#include "core/recording/ros1_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "test/core/recording/bag_text.h"
#include "test/testing/temporary_directory.h"

namespace plumbline {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class Ros1FileTest : public TemporaryDirectoryTest {};

TEST_F(Ros1FileTest, ConnectionsAreTopicsAndMessagesCanBeReadAgain) {
  const std::string first =
      BagConnectionText(
          3, "/scan", "sensor_msgs/LaserScan", "90c7ef2dc6895d81024acba2ac42f369") +
      BagMessageText(3, 10, "a");
  const std::string second = BagConnectionText(8, "/scan", "sensor_msgs/LaserScan", "other") +
                             BagMessageText(8, 11, "bc") + BagMessageText(3, 12, "def");
  const std::string path = (directory_ / "file").string();
  WriteBytes(path,
             BagHeaderText(0, 0, 0) + BagChunkText("none", first.size(), first) +
                 BagChunkText("none", second.size(), second));
  Ros1File file("name", path);
  EXPECT_EQ(file.path(), "name");
  EXPECT_EQ(file.format(), "ROS 1 bag");
  std::vector<MessageRef> messages;
  file.Scan([](const RecordingTopic& topic) { return topic.HasScanLines(); },
            [&](const MessageRef& message, ByteView) {
              messages.push_back(message);
              return true;
            });
  ASSERT_EQ(file.topics().size(), 2u);
  EXPECT_EQ(file.topics()[0].kind, MessageKind::kLaserScan);
  EXPECT_EQ(file.topics()[0].encoding, MessageEncoding::kRos1);
  EXPECT_EQ(file.topics()[0].num_messages, 2u);
  // Another definition of the type is another kind.
  EXPECT_EQ(file.topics()[1].kind, MessageKind::kOther);
  EXPECT_EQ(file.topics()[1].definition, "other");
  EXPECT_EQ(file.topics()[1].num_messages, 1u);
  ASSERT_EQ(messages.size(), 2u);
  EXPECT_EQ(messages[1].receipt_ns, 12'000'000'000u);
  EXPECT_EQ(TextOf(file.Read(messages[1])), "def");
  EXPECT_EQ(TextOf(file.Read(messages[0])), "a");
  EXPECT_THAT(file.warnings(), ElementsAre(HasSubstr("the bag was never closed")));
}

}  // namespace
}  // namespace plumbline
