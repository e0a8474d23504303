#include "core/recording/sqlite_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "test/core/recording/byte_text.h"
#include "test/core/recording/database.h"
#include "test/core/recording/scanned_messages.h"
#include "test/testing/temporary_directory.h"

namespace plumbline {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class SqliteFileTest : public TemporaryDirectoryTest {
 protected:
  std::string path() const { return (directory_ / "file.db3").string(); }

  // Visits the messages of wanted topics as "topic time data", and reads them again.
  std::vector<std::string> Scan(const MessageFile::Wants& wants) {
    SqliteFile file("name", path());
    const std::vector<std::string> messages = ScannedMessages(wants, &file);
    topics_ = file.topics();
    warnings_ = file.warnings();
    return messages;
  }
  std::vector<std::string> ScanAll() {
    return Scan([](const RecordingTopic&) { return true; });
  }

  std::vector<RecordingTopic> topics_;
  std::vector<std::string> warnings_;
};

TEST_F(SqliteFileTest, MessagesComeInTheOrderOfTheirIds) {
  {
    TestDatabase database(path());
    database.MakeTables();
    database.AddTopic(7, "/scan", "sensor_msgs/msg/LaserScan");
    database.AddTopic(2, "/text", "std_msgs/msg/String", "json");
    database.AddMessage(30, 7, 500, "third");
    database.AddMessage(10, 7, 900, "first");
    database.AddMessage(20, 2, 100, "");
  }
  EXPECT_THAT(ScanAll(), ElementsAre("/scan 900 first", "/text 100 ", "/scan 500 third"));
  EXPECT_THAT(warnings_, IsEmpty());
  ASSERT_EQ(topics_.size(), 2u);
  const RecordingTopic& scan = topics_[topics_[0].name == "/scan" ? 0 : 1];
  const RecordingTopic& text = topics_[topics_[0].name == "/scan" ? 1 : 0];
  EXPECT_EQ(scan.kind, MessageKind::kLaserScan);
  EXPECT_EQ(scan.encoding, MessageEncoding::kCdr);
  EXPECT_EQ(scan.num_messages, 2u);
  EXPECT_EQ(text.kind, MessageKind::kOther);
  EXPECT_EQ(text.encoding, MessageEncoding::kUnknown);
}

TEST_F(SqliteFileTest, MessagesThatNobodyWantsAreCounted) {
  {
    TestDatabase database(path());
    database.MakeTables();
    database.AddTopic(1, "/scan", "sensor_msgs/msg/LaserScan");
    database.AddTopic(2, "/text", "std_msgs/msg/String");
    for (int i = 0; i < 5; ++i) database.AddMessage(i, 1 + i % 2, i, "data");
  }
  EXPECT_THAT(Scan([](const RecordingTopic& topic) { return topic.name == "/text"; }),
              ElementsAre("/text 1 data", "/text 3 data"));
  ASSERT_EQ(topics_.size(), 2u);
  EXPECT_EQ(topics_[0].num_messages + topics_[1].num_messages, 5u);
}

TEST_F(SqliteFileTest, MessagesWithoutATopicAreTold) {
  for (const int num_lost : {1, 2}) {
    std::filesystem::remove(path());
    {
      TestDatabase database(path());
      database.MakeTables();
      database.AddTopic(1, "/scan", "sensor_msgs/msg/LaserScan");
      database.AddMessage(1, 1, 5, "data");
      for (int i = 0; i < num_lost; ++i) database.AddMessage(2 + i, 9, 5, "lost");
    }
    EXPECT_THAT(ScanAll(), ElementsAre("/scan 5 data"));
    EXPECT_THAT(warnings_,
                ElementsAre(num_lost == 1 ? "damaged database: 1 message belongs to no topic "
                                            "and is lost"
                                          : "damaged database: 2 messages belong to no topic "
                                            "and are lost"));
  }
}

// A recorder that is killed leaves its log behind, or at least the mode. Only root may write
// into the folder all the same.
TEST_F(SqliteFileTest, DatabaseWithAWriteAheadLogIsReadFromAReadOnlyFolder) {
  {
    TestDatabase database(path());
    database.Run("PRAGMA journal_mode = WAL");
    database.MakeTables();
    database.AddTopic(1, "/scan", "sensor_msgs/msg/LaserScan");
    database.AddMessage(1, 1, 5, "data");
  }
  namespace fs = std::filesystem;
  fs::permissions(directory_, fs::perms::owner_write, fs::perm_options::remove);
  EXPECT_THAT(ScanAll(), ElementsAre("/scan 5 data"));
  fs::permissions(directory_, fs::perms::owner_write, fs::perm_options::add);
}

TEST_F(SqliteFileTest, MessageThatIsGoneWhenItIsReadAgainIsAnError) {
  {
    TestDatabase database(path());
    database.MakeTables();
    database.AddTopic(1, "/scan", "sensor_msgs/msg/LaserScan");
    database.AddMessage(1, 1, 5, "data");
  }
  SqliteFile file("name", path());
  MessageRef place;
  file.Scan([](const RecordingTopic&) { return true; },
            [&](const MessageRef& message, ByteView) {
              place = message;
              return true;
            });
  TestDatabase(path()).Run("DELETE FROM messages");
  EXPECT_EQ(ErrorOf([&] { file.Read(place); }), "name: has changed while it was read");
}

TEST_F(SqliteFileTest, OtherDatabasesAreRefused) {
  TestDatabase(path()).Run("CREATE TABLE places(id INTEGER)");
  const std::string expected =
      "name: is an SQLite database, but no rosbag2 recording: it has no tables topics and "
      "messages";
  EXPECT_EQ(ErrorOf([&] { SqliteFile("name", path()); }), expected);
  // Views would run what the file says.
  TestDatabase(path()).Run(
      "CREATE VIEW topics AS SELECT id, 'a' AS name FROM places;"
      "CREATE VIEW messages AS SELECT id FROM places");
  EXPECT_EQ(ErrorOf([&] { SqliteFile("name", path()); }), expected);
}

TEST_F(SqliteFileTest, FilesThatAreNoDatabaseAreNamed) {
  EXPECT_THAT(ErrorOf([&] { SqliteFile("name", path()); }),
              HasSubstr("name: can not be read as an SQLite database: unable to open"));
  WriteBytes(path(), std::string(5000, 'x'));
  EXPECT_THAT(
      ErrorOf([&] { SqliteFile("name", path()); }),
      HasSubstr("name: can not be read as an SQLite database: file is not a database"));
}

}  // namespace
}  // namespace plumbline
