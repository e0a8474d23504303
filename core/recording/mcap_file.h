#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/recording/byte_source.h"
#include "core/recording/chunk_store.h"
#include "core/recording/damage_log.h"
#include "core/recording/mcap_record.h"
#include "core/recording/message_file.h"

namespace plumbline {

// Reads an MCAP file, of ROS 2 or ROS 1, that need not be what it claims. It is gone through
// from its start; its summary serves to find the next chunk behind a damage, and to notice
// what is missing.
class McapFile : public MessageFile {
 public:
  explicit McapFile(std::unique_ptr<InputFile> file);

  const std::string& path() const override { return file_->name(); }
  std::string format() const override { return "MCAP file"; }
  void Scan(const Wants& wants, const Visit& visit) override;
  const std::vector<RecordingTopic>& topics() const override { return topics_; }
  ByteView Read(const MessageRef& message) override;
  const std::vector<std::string>& warnings() const override { return warnings_; }

 private:
  // The summary at the end of the file.
  struct Summary {
    bool is_there = false;
    std::vector<uint64_t> positions;  // of the chunks, increasing
    McapStatistics statistics;
    bool has_statistics = false;
  };

  void ReadSummary();
  uint64_t ReadTopRecord(uint64_t position);
  uint64_t ReadChunk(const McapRecord& record, uint64_t position);
  std::vector<uint64_t> MessageOffsets(uint64_t chunk_end);
  bool ReadChunkRecords(uint32_t chunk_index,
                        uint64_t chunk_position,
                        const std::vector<uint64_t>& message_offsets,
                        ByteSource* chunk);
  bool ReadRecord(const McapRecord& record, uint32_t part, uint64_t place, ByteSource* source);
  void AddChannel(const McapChannel& channel, uint64_t place);
  void ReadMessage(const McapRecord& record,
                   uint32_t part,
                   uint64_t place,
                   ByteSource* source);
  uint64_t NextChunkPosition(uint64_t position) const;
  void CompareWithSummary();

  std::unique_ptr<InputFile> file_;
  FileWindow window_;
  ChunkStore chunks_;
  uint32_t num_chunks_ = 0;
  Summary summary_;
  bool in_summary_ = false;
  bool ends_ = false;                           // the end of the data was found
  std::map<uint16_t, std::string> schemas_;     // names by id
  std::map<uint16_t, uint32_t> topic_indices_;  // by channel id
  std::vector<RecordingTopic> topics_;
  std::vector<bool> wanted_;  // by topic
  Wants wants_;
  Visit visit_;
  DamageLog damages_;
  std::vector<std::string> warnings_;
};

}  // namespace plumbline
