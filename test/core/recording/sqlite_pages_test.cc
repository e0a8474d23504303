#include "core/recording/sqlite_pages.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "test/core/recording/byte_text.h"
#include "test/core/recording/database.h"
#include "test/testing/temporary_directory.h"

namespace plumbline {
namespace {

struct Message {
  int64_t id;
  int64_t topic_id;
  int64_t time_ns;
  std::string data;
};

std::string DataOf(int seed, size_t size) {
  std::string data(size, '\0');
  for (size_t i = 0; i < size; ++i) {
    data[i] = static_cast<char>(static_cast<size_t>(seed) * 31 + i * 7 % 253);
  }
  return data;
}

// Integers of every length that SQLite knows; data that fill no page, one, or many.
std::vector<Message> Messages() {
  constexpr int64_t kLargest = std::numeric_limits<int64_t>::max();
  std::vector<Message> messages = {{-5, 0, 0, ""},
                                   {1, 1, 1, "x"},
                                   {2, -1, -1, "data"},
                                   {300, 127, 128, DataOf(1, 100)},
                                   {70'000, 40'000, -40'000, DataOf(2, 440)},
                                   {3'000'000'000, 8'000'000, 9'000'000, DataOf(3, 480)},
                                   {kLargest - 1, 3'000'000'000, 1LL << 45, DataOf(4, 5000)},
                                   {kLargest, 1LL << 50, kLargest, DataOf(5, 150'000)}};
  for (int i = 0; i < 40; ++i) {
    messages.push_back({1000 + i, 2, 1'600'000'000'000'000'000 + i, DataOf(i, 37u * i)});
  }
  return messages;
}

class SqlitePagesTest : public TemporaryDirectoryTest {
 protected:
  std::string path() const { return (directory_ / "file.db3").string(); }

  void Write(int page_bytes, const std::vector<Message>& messages) {
    std::filesystem::remove(path());
    TestDatabase database(path());
    database.Run("PRAGMA page_size = " + std::to_string(page_bytes));
    database.MakeTables();
    database.AddTopic(1, "/scan", "sensor_msgs/msg/LaserScan");
    database.Run("BEGIN");
    for (const Message& message : messages) {
      database.AddMessage(message.id, message.topic_id, message.time_ns, message.data);
    }
    database.Run("COMMIT");
  }

  // Rows that are what was written; others are failures.
  size_t NumGoodRows(const std::vector<Message>& messages) {
    SqlitePages pages(path(), "name");
    for (const auto& [id, place] : pages.rows()) {
      SqlitePages::Row row;
      EXPECT_TRUE(pages.ReadRow(place, &row)) << id;
      const auto message =
          std::find_if(messages.begin(), messages.end(), [id = id](const Message& candidate) {
            return candidate.id == id;
          });
      if (message == messages.end()) {
        ADD_FAILURE() << "no message " << id;
        continue;
      }
      EXPECT_EQ(row.id, id);
      EXPECT_EQ(row.topic_id, message->topic_id) << id;
      EXPECT_EQ(row.timestamp_ns, message->time_ns) << id;
      EXPECT_TRUE(TextOf(row.data) == message->data) << id;
    }
    return pages.rows().size();
  }
};

TEST_F(SqlitePagesTest, FindsAllRowsInPagesOfAnySize) {
  const std::vector<Message> messages = Messages();
  for (const int page_bytes : {512, 4096, 65'536}) {
    Write(page_bytes, messages);
    EXPECT_EQ(NumGoodRows(messages), messages.size()) << page_bytes;
  }
}

// Where a row begins to flow over to other pages, to the byte.
TEST_F(SqlitePagesTest, RowsThatJustFitAPageAreRead) {
  std::vector<Message> messages;
  for (int i = 0; i < 80; ++i) messages.push_back({i, 1, 2, DataOf(i, 440u + i)});
  Write(512, messages);
  EXPECT_EQ(NumGoodRows(messages), messages.size());
}

TEST_F(SqlitePagesTest, CutFileHoldsTheRowsThatAreWhole) {
  const std::vector<Message> messages = Messages();
  Write(1024, messages);
  const std::string whole = ReadBytes(path());
  size_t num_before = messages.size();
  for (size_t twelfths = 11; twelfths > 0; --twelfths) {
    WriteBytes(path(), whole.substr(0, twelfths * whole.size() / 12));
    const size_t num_rows = NumGoodRows(messages);
    EXPECT_LE(num_rows, num_before) << twelfths;
    num_before = num_rows;
  }
  EXPECT_LT(num_before, messages.size());
}

// Whatever stands in it, no page makes it read beyond the file.
TEST_F(SqlitePagesTest, PagesThatAreOverwrittenCostTheirOwnRows) {
  const std::vector<Message> messages = Messages();
  Write(1024, messages);
  const std::string whole = ReadBytes(path());
  for (size_t page = 1; page < whole.size() / 1024; page += 9) {
    for (const char filling : {'\0', '\x0d', '\xff'}) {
      std::string damaged = whole;
      damaged.replace(page * 1024, 1024, std::string(1024, filling));
      WriteBytes(path(), damaged);
      SqlitePages pages(path(), "name");
      EXPECT_GE(pages.rows().size() + 40, messages.size());
      SqlitePages::Row row;
      for (const auto& [id, place] : pages.rows()) EXPECT_TRUE(pages.ReadRow(place, &row));
    }
  }
}

TEST_F(SqlitePagesTest, RowsOfOtherTablesAreNone) {
  TestDatabase database(path());
  database.Run(
      "CREATE TABLE a(id INTEGER PRIMARY KEY, b, c, d);"
      "INSERT INTO a VALUES(1, 2, 3, 'text');"
      "INSERT INTO a VALUES(2, 2, 3, NULL);"
      "INSERT INTO a VALUES(3, 2.5, 3, x'00');"
      "INSERT INTO a VALUES(4, NULL, 3, x'00');"
      "INSERT INTO a VALUES(5, 2, 3, x'00');"
      "CREATE TABLE e(id INTEGER PRIMARY KEY, b, c, d, e);"
      "INSERT INTO e VALUES(6, 2, 3, x'00', x'00');");
  SqlitePages pages(path(), "name");
  ASSERT_EQ(pages.rows().size(), 1u);
  EXPECT_EQ(pages.rows().begin()->first, 5);
}

TEST_F(SqlitePagesTest, FilesThatAreNoDatabaseHaveNoRows) {
  for (const size_t size : {0u, 99u, 100u, 5000u}) {
    for (const char filling : {'\0', '\x0d', '\xff'}) {
      WriteBytes(path(), std::string(size, filling));
      SqlitePages pages(path(), "name");
      EXPECT_TRUE(pages.rows().empty());
      SqlitePages::Row row;
      EXPECT_FALSE(pages.ReadRow(size, &row));
    }
  }
  EXPECT_NE(
      ErrorOf([&] { SqlitePages((directory_ / "gone").string(), "name"); }).find("name: "),
      std::string::npos);
}

}  // namespace
}  // namespace plumbline
