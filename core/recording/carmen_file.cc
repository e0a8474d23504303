#include "core/recording/carmen_file.h"

#include <algorithm>
#include <utility>

#include "core/recording/carmen_messages.h"
#include "core/recording/decode.h"
#include "core/util/error.h"

namespace plumbline {
namespace {

constexpr size_t kWindowBytes = size_t{256} << 10;
// A scan line of a hundred thousand ranges.
constexpr size_t kMaxLineBytes = size_t{1} << 20;
// CARMEN's own words are a few; what has more is no log.
constexpr size_t kMaxTopics = 1000;
constexpr size_t kMaxWordBytes = 64;

const char kTooLong[] = "damaged log: what is no line was passed over";
const char kNoTime[] = "damaged log: a line does not end with its times and was passed over";
const char kNoWord[] = "damaged log: a line does not begin with a word and was passed over";

bool IsWordCharacter(char c) {
  return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') ||
         c == '_';
}

}  // namespace

CarmenFile::CarmenFile(std::unique_ptr<InputFile> file)
    : file_(std::move(file)), window_(file_.get(), kWindowBytes) {}

// The line that begins at `position`, its end included; none where it is too long.
ByteView CarmenFile::LineAt(uint64_t position) {
  ByteView bytes;
  for (size_t size = 8192;; size *= 2) {
    const uint64_t left = file_->size() - position;
    const auto num_bytes = static_cast<size_t>(std::min<uint64_t>(size, left));
    if (!window_.View(position, num_bytes, &bytes)) return {};
    const uint8_t* end = bytes.data + bytes.size;
    const uint8_t* line_end = std::find(bytes.data, end, uint8_t{'\n'});
    if (line_end != end) return {bytes.data, static_cast<size_t>(line_end + 1 - bytes.data)};
    if (num_bytes == left) return bytes;
    if (size >= kMaxLineBytes) return {};
  }
}

void CarmenFile::Scan(const Wants& wants, const Visit& visit) {
  for (uint64_t position = 0; position < file_->size();) {
    const ByteView line = LineAt(position);
    if (line.size == 0) {
      damages_.Add(kTooLong, position, kMaxLineBytes);
      position = std::min(position + kMaxLineBytes, file_->size());
      continue;
    }
    const uint64_t begin = position;
    position += line.size;
    ReadLine(line, begin, wants, visit);
  }
  warnings_ = damages_.Sentences();
}

void CarmenFile::ReadLine(ByteView line,
                          uint64_t position,
                          const Wants& wants,
                          const Visit& visit) {
  const char* begin = reinterpret_cast<const char*>(line.data);
  const char* end = begin + line.size;
  if (*begin == '#' || *begin == '\n' || *begin == '\r') return;
  const char* word_end = std::find_if_not(begin, end, IsWordCharacter);
  const std::string word(begin, word_end);
  if (word.empty() || word.size() > kMaxWordBytes || word_end == end) {
    damages_.Add(kNoWord, position, line.size);
    return;
  }
  const auto [known, is_new] =
      topic_indices_.emplace(word, static_cast<uint32_t>(topics_.size()));
  if (is_new) {
    if (topics_.size() == kMaxTopics) {
      throw Error(path() +
                  ": is no CARMEN log: its lines begin with too many different words");
    }
    RecordingTopic topic;
    topic.name = topic.type = word;
    topic.encoding = MessageEncoding::kCarmen;
    topic.kind = KindOf(topic);
    topic.also_has_odometry = CarmenScanLineHasOdometry(word);
    topics_.push_back(topic);
    wanted_.push_back(wants(topics_.back()));
  }
  ++topics_[known->second].num_messages;
  if (!wanted_[known->second]) return;
  int64_t receipt_ns = 0;
  if (!ReadCarmenReceipt(line, &receipt_ns)) {
    damages_.Add(kNoTime, position, line.size);
    return;
  }
  // The order of the file is that of the messages' receipt; the recorder's clock begins anew
  // where logs were joined.
  last_receipt_ns_ = std::max(last_receipt_ns_, static_cast<uint64_t>(receipt_ns));
  MessageRef message;
  message.receipt_ns = last_receipt_ns_;
  message.topic_index = known->second;
  message.size = static_cast<uint32_t>(line.size);
  message.begin = position;
  visit(message, line);
}

ByteView CarmenFile::Read(const MessageRef& message) {
  ByteView line;
  if (!window_.View(message.begin, message.size, &line)) {
    throw Error(path() + ": has changed while it was read");
  }
  return line;
}

}  // namespace plumbline
