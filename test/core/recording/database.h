#pragma once

#include <gtest/gtest.h>
#include <sqlite3.h>

#include <cstdint>
#include <string>

namespace plumbline {

// A database that a test writes with SQLite.
class TestDatabase {
 public:
  explicit TestDatabase(const std::string& path) {
    EXPECT_EQ(sqlite3_open(path.c_str(), &database_), SQLITE_OK);
    Run("PRAGMA synchronous = OFF");  // faster
  }
  ~TestDatabase() { sqlite3_close(database_); }
  TestDatabase(const TestDatabase&) = delete;
  TestDatabase& operator=(const TestDatabase&) = delete;

  void Run(const std::string& sql) {
    EXPECT_EQ(sqlite3_exec(database_, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK)
        << sqlite3_errmsg(database_);
  }

  // The tables of rosbag2.
  void MakeTables() {
    Run("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, "
        "serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);"
        "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, "
        "timestamp INTEGER NOT NULL, data BLOB NOT NULL)");
  }
  void AddTopic(int64_t id,
                const std::string& name,
                const std::string& type,
                const std::string& format = "cdr") {
    Run("INSERT INTO topics VALUES(" + std::to_string(id) + ", '" + name + "', '" + type +
        "', '" + format + "', '')");
  }
  void AddMessage(int64_t id, int64_t topic_id, int64_t time_ns, const std::string& data) {
    sqlite3_stmt* statement = nullptr;
    ASSERT_EQ(
        sqlite3_prepare_v2(
            database_, "INSERT INTO messages VALUES(?, ?, ?, ?)", -1, &statement, nullptr),
        SQLITE_OK);
    sqlite3_bind_int64(statement, 1, id);
    sqlite3_bind_int64(statement, 2, topic_id);
    sqlite3_bind_int64(statement, 3, time_ns);
    sqlite3_bind_blob(
        statement, 4, data.data(), static_cast<int>(data.size()), SQLITE_TRANSIENT);
    EXPECT_EQ(sqlite3_step(statement), SQLITE_DONE) << sqlite3_errmsg(database_);
    sqlite3_finalize(statement);
  }

 private:
  sqlite3* database_ = nullptr;
};

}  // namespace plumbline
