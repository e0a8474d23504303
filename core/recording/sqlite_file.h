#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/recording/message_file.h"
#include "core/recording/sqlite_pages.h"

struct sqlite3;
struct sqlite3_stmt;

namespace plumbline {

// Reads a rosbag2 file (.db3): an SQLite database with the tables
//   topics     id, name, type, serialization_format, ...
//   messages   id, topic_id, timestamp (ns of the receipt), data
class SqliteFile : public MessageFile {
 public:
  // path: what the user knows the file by; file_path: where it is. Throws Error when the file
  // is no such database.
  SqliteFile(const std::string& path, const std::string& file_path);
  ~SqliteFile() override;

  const std::string& path() const override { return path_; }
  std::string format() const override { return "rosbag2 database"; }
  void Scan(const Wants& wants, const Visit& visit) override;
  const std::vector<RecordingTopic>& topics() const override { return topics_; }
  ByteView Read(const MessageRef& message) override;
  const std::vector<std::string>& warnings() const override { return warnings_; }

 private:
  struct CloseDatabase {
    void operator()(sqlite3* database) const;
  };
  struct FinishStatement {
    void operator()(sqlite3_stmt* statement) const;
  };
  using Statement = std::unique_ptr<sqlite3_stmt, FinishStatement>;

  Statement Prepare(const char* sql) const;
  void CheckTables() const;
  void ReadTopics(const Wants& wants);
  bool TakeRow(const SqlitePages::Row& row, const Visit& visit);
  void ReadByPages(const Visit& visit);
  [[noreturn]] void Fail() const;

  std::string path_;
  std::string file_path_;
  std::unique_ptr<SqlitePages> pages_;  // of a damaged database
  std::unique_ptr<sqlite3, CloseDatabase> database_;
  Statement read_;  // of one message
  std::vector<RecordingTopic> topics_;
  std::vector<bool> wanted_;                   // by topic
  std::map<int64_t, uint32_t> topic_indices_;  // by id
  int64_t last_id_ = 0;                        // of the messages that were found
  uint64_t num_found_ = 0;
  uint64_t num_unknown_ = 0;  // of these, without a topic
  std::vector<std::string> warnings_;
};

}  // namespace plumbline
