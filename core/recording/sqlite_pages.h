#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "core/recording/byte_source.h"

namespace plumbline {

// SqlitePages reads the rows of rosbag2's table of messages from a database file whose tree of
// pages is damaged or cut off: page by page, without the tree. Format:
// https://www.sqlite.org/fileformat2.html
class SqlitePages {
 public:
  // A row of the table: id, topic_id, timestamp, data.
  struct Row {
    int64_t id = 0;
    int64_t topic_id = 0;
    int64_t timestamp_ns = 0;
    ByteView data;  // valid until the next row is read
  };

  // Throws Error that names the file where it can not be read.
  SqlitePages(const std::string& path, const std::string& name);

  // Returns where the whole rows are in the file, by id.
  const std::map<int64_t, uint64_t>& rows() const { return rows_; }
  // Reads the row at a place in the file; false where there is none that is whole.
  bool ReadRow(uint64_t place, Row* row);

 private:
  void FindRows();
  bool ReadPayload(uint64_t begin, uint64_t size);

  InputFile file_;
  uint64_t page_bytes_ = 0;
  uint64_t usable_bytes_ = 0;  // of a page
  std::map<int64_t, uint64_t> rows_;
  std::vector<uint8_t> payload_;
};

}  // namespace plumbline
