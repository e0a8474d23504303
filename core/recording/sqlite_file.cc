#include "core/recording/sqlite_file.h"

#include <sqlite3.h>

#include <cstdio>
#include <filesystem>

#include "core/recording/damage_log.h"
#include "core/recording/decode.h"
#include "core/recording/message_limits.h"
#include "core/util/error.h"

namespace plumbline {
namespace {

// A name of the file by which SQLite takes it as never to change.
std::string ImmutableUri(const std::string& path) {
  std::string uri = "file:";
  for (const char c : path) {
    if (c == '%' || c == '?' || c == '#') {
      char text[8];
      std::snprintf(text, sizeof(text), "%%%02x", static_cast<unsigned>(c));
      uri += text;
    } else {
      uri += c;
    }
  }
  return uri + "?immutable=1";
}

std::string TextAt(sqlite3_stmt* statement, int column) {
  const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(statement, column));
  return text == nullptr ? "" : text;
}

ByteView BytesAt(sqlite3_stmt* statement, int column) {
  // The bytes have to be asked for before their number.
  const auto* bytes = static_cast<const uint8_t*>(sqlite3_column_blob(statement, column));
  return {bytes, static_cast<size_t>(sqlite3_column_bytes(statement, column))};
}

}  // namespace

void SqliteFile::CloseDatabase::operator()(sqlite3* database) const {
  sqlite3_close_v2(database);
}

void SqliteFile::FinishStatement::operator()(sqlite3_stmt* statement) const {
  sqlite3_finalize(statement);
}

SqliteFile::SqliteFile(const std::string& path, const std::string& file_path)
    : path_(path), file_path_(file_path) {
  sqlite3* database = nullptr;
  const int outcome = sqlite3_open_v2(
      file_path.c_str(), &database, SQLITE_OPEN_READONLY | SQLITE_OPEN_NOMUTEX, nullptr);
  database_.reset(database);
  if (outcome != SQLITE_OK) Fail();
  // A database in the mode of a write-ahead log wants to write beside itself even when it is
  // read, which a read-only folder does not allow. Where the log has nothing left, the file as
  // it stands is all.
  if (sqlite3_exec(
          database, "SELECT count(*) FROM sqlite_schema", nullptr, nullptr, nullptr) ==
          SQLITE_CANTOPEN &&
      !std::filesystem::exists(file_path + "-wal")) {
    database_.reset();
    sqlite3_open_v2(ImmutableUri(file_path).c_str(),
                    &database,
                    SQLITE_OPEN_READONLY | SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_URI,
                    nullptr);
    database_.reset(database);
  }
  // A file that was cut has fewer pages than its header says, which SQLite takes only so.
  if (sqlite3_exec(
          database, "SELECT count(*) FROM sqlite_schema", nullptr, nullptr, nullptr) ==
      SQLITE_CORRUPT) {
    sqlite3_db_config(database, SQLITE_DBCONFIG_WRITABLE_SCHEMA, 1, nullptr);
  }
  sqlite3_limit(database, SQLITE_LIMIT_LENGTH, static_cast<int>(kMaxMessageBytes));
  // A database that was made to do harm must not run anything of its own.
  sqlite3_db_config(database, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  sqlite3_db_config(database, SQLITE_DBCONFIG_ENABLE_VIEW, 0, nullptr);
  sqlite3_db_config(database, SQLITE_DBCONFIG_ENABLE_TRIGGER, 0, nullptr);
  sqlite3_exec(database, "PRAGMA cell_size_check = ON", nullptr, nullptr, nullptr);
  CheckTables();
}

SqliteFile::~SqliteFile() = default;

void SqliteFile::Fail() const {
  throw Error(path_ +
              ": can not be read as an SQLite database: " + sqlite3_errmsg(database_.get()));
}

SqliteFile::Statement SqliteFile::Prepare(const char* sql) const {
  sqlite3_stmt* statement = nullptr;
  if (sqlite3_prepare_v2(database_.get(), sql, -1, &statement, nullptr) != SQLITE_OK) Fail();
  return Statement(statement);
}

// Both must be tables that lie in the file.
void SqliteFile::CheckTables() const {
  const Statement tables = Prepare(
      "SELECT count(*) FROM sqlite_schema WHERE type = 'table' AND rootpage > 0 AND "
      "name IN ('topics', 'messages')");
  if (sqlite3_step(tables.get()) != SQLITE_ROW) Fail();
  if (sqlite3_column_int(tables.get(), 0) != 2) {
    throw Error(path_ +
                ": is an SQLite database, but no rosbag2 recording: it has no tables "
                "topics and messages");
  }
}

void SqliteFile::ReadTopics(const Wants& wants) {
  const Statement rows = Prepare("SELECT id, name, type, serialization_format FROM topics");
  int outcome = SQLITE_ROW;
  while ((outcome = sqlite3_step(rows.get())) == SQLITE_ROW) {
    RecordingTopic topic;
    topic.name = TextAt(rows.get(), 1);
    topic.type = TextAt(rows.get(), 2);
    if (TextAt(rows.get(), 3) == "cdr") topic.encoding = MessageEncoding::kCdr;
    topic.kind = KindOf(topic);
    const auto [known, is_new] = topic_indices_.emplace(sqlite3_column_int64(rows.get(), 0),
                                                        static_cast<uint32_t>(topics_.size()));
    if (!is_new) continue;
    topics_.push_back(topic);
    wanted_.push_back(wants(topics_.back()));
  }
  if (outcome != SQLITE_DONE) Fail();
}

// Visits the message of a row; false where the ids do not increase, as only a damaged database
// has them.
bool SqliteFile::TakeRow(const SqlitePages::Row& row, const Visit& visit) {
  if (num_found_ > 0 && row.id <= last_id_) return false;
  last_id_ = row.id;
  ++num_found_;
  const auto topic = topic_indices_.find(row.topic_id);
  if (topic == topic_indices_.end()) {
    ++num_unknown_;
    return true;
  }
  ++topics_[topic->second].num_messages;
  if (!wanted_[topic->second]) return true;
  MessageRef message;
  message.receipt_ns = static_cast<uint64_t>(row.timestamp_ns);
  message.topic_index = topic->second;
  message.size = static_cast<uint32_t>(row.data.size);
  message.begin = static_cast<uint64_t>(row.id);
  visit(message, row.data);
  return true;
}

void SqliteFile::Scan(const Wants& wants, const Visit& visit) {
  ReadTopics(wants);
  const Statement rows =
      Prepare("SELECT id, topic_id, timestamp, data FROM messages ORDER BY id");
  int outcome = SQLITE_ROW;
  while ((outcome = sqlite3_step(rows.get())) == SQLITE_ROW) {
    const SqlitePages::Row row = {sqlite3_column_int64(rows.get(), 0),
                                  sqlite3_column_int64(rows.get(), 1),
                                  sqlite3_column_int64(rows.get(), 2),
                                  BytesAt(rows.get(), 3)};
    if (TakeRow(row, visit)) continue;
    outcome = SQLITE_CORRUPT;
    break;
  }
  if (outcome != SQLITE_DONE) {
    const std::string before = CountText(num_found_, "message");
    const uint64_t num_before = num_found_;
    ReadByPages(visit);
    warnings_.push_back("damaged database: messages are lost after the first " + before +
                        ", " + CountText(num_found_ - num_before, "message") +
                        " behind the damage could be read");
  }
  if (num_unknown_ == 0) return;
  warnings_.push_back("damaged database: " + CountText(num_unknown_, "message") +
                      (num_unknown_ == 1 ? " belongs" : " belong") + " to no topic and " +
                      (num_unknown_ == 1 ? "is" : "are") + " lost");
}

// Behind a damage, messages are found page by page.
void SqliteFile::ReadByPages(const Visit& visit) {
  pages_ = std::make_unique<SqlitePages>(file_path_, path_);
  SqlitePages::Row row;
  for (const auto& [id, place] : pages_->rows()) {
    if (num_found_ > 0 && id <= last_id_) continue;
    if (pages_->ReadRow(place, &row)) TakeRow(row, visit);
  }
}

ByteView SqliteFile::Read(const MessageRef& message) {
  if (pages_ != nullptr) {
    const auto place = pages_->rows().find(static_cast<int64_t>(message.begin));
    SqlitePages::Row row;
    if (place != pages_->rows().end() && pages_->ReadRow(place->second, &row) &&
        row.data.size == message.size) {
      return row.data;
    }
  }
  if (read_ == nullptr) read_ = Prepare("SELECT data FROM messages WHERE id = ?");
  sqlite3_reset(read_.get());
  sqlite3_bind_int64(read_.get(), 1, static_cast<int64_t>(message.begin));
  ByteView data;
  if (sqlite3_step(read_.get()) == SQLITE_ROW) data = BytesAt(read_.get(), 0);
  if (data.size != message.size) throw Error(path_ + ": has changed while it was read");
  return data;
}

}  // namespace plumbline
