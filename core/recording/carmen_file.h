#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/recording/byte_source.h"
#include "core/recording/damage_log.h"
#include "core/recording/message_file.h"

namespace plumbline {

// A CARMEN log: text, one message a line. A topic is the word that a line begins with.
class CarmenFile : public MessageFile {
 public:
  explicit CarmenFile(std::unique_ptr<InputFile> file);

  const std::string& path() const override { return file_->name(); }
  std::string format() const override { return "CARMEN log"; }
  void Scan(const Wants& wants, const Visit& visit) override;
  const std::vector<RecordingTopic>& topics() const override { return topics_; }
  ByteView Read(const MessageRef& message) override;
  const std::vector<std::string>& warnings() const override { return warnings_; }

 private:
  ByteView LineAt(uint64_t position);
  void ReadLine(ByteView line, uint64_t position, const Wants& wants, const Visit& visit);

  std::unique_ptr<InputFile> file_;
  FileWindow window_;
  std::vector<RecordingTopic> topics_;
  std::vector<bool> wanted_;                       // by topic
  std::map<std::string, uint32_t> topic_indices_;  // by name
  uint64_t last_receipt_ns_ = 0;
  DamageLog damages_;
  std::vector<std::string> warnings_;
};

}  // namespace plumbline
