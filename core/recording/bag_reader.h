#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "core/recording/bag_index.h"
#include "core/recording/bag_record.h"
#include "core/recording/byte_source.h"
#include "core/recording/chunk_store.h"
#include "core/recording/damage_log.h"

namespace plumbline {

// BagMessage says where a message of a bag is.
struct BagMessage {
  uint64_t receipt_ns = 0;        // when the recorder received it, since 1970
  uint32_t connection_index = 0;  // in BagReader::connections()
  uint32_t chunk_index = 0;
  uint32_t begin = 0;  // of its data in the chunk
  uint32_t size = 0;   // of its data, bytes
};

// Reads a ROS 1 bag of format 2.0 that need not be what it claims. The bag is gone through
// from its start, every length is held against what there is, and the index serves as a help
// only. What can not be read is passed over, counted and told by warnings(). Memory: no more
// than a few chunks and messages at a time.
class BagReader {
 public:
  // name: what errors call the file. Throws Error when the file can not be read, is no such
  // bag or is encrypted.
  BagReader(const std::string& path, const std::string& name);

  const std::string& name() const { return file_.name(); }

  // Says whether the messages of a connection are to be visited.
  using Wants = std::function<bool(const BagConnection&)>;
  // Takes a message and its data, valid during the call only; false where the data make no
  // sense, which it counts itself.
  using Visit = std::function<bool(const BagMessage&, ByteView)>;

  // Goes through the whole bag, once. Visits the messages in the order of the file.
  void Scan(const Wants& wants, const Visit& visit);

  // Returns the connections found by Scan(). A topic may have several.
  const std::vector<BagConnection>& connections() const { return connections_; }
  // Number of messages of a connection that Scan() found, wanted or not.
  uint64_t num_messages(size_t connection_index) const {
    return tallies_[connection_index].num_found;
  }
  // The data of a visited message, valid until the next call. Throws Error when the file has
  // changed since.
  ByteView Read(const BagMessage& message);
  // Sentences for the user about what is damaged or missing, after Scan().
  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  struct Tally {
    bool wanted = false;
    uint64_t num_found = 0;
  };

  uint64_t ReadHeader();
  uint64_t ReadTopRecord(uint64_t position);
  uint64_t ReadChunk(BagRecord record);
  uint64_t ReadChunkRecords(uint32_t chunk_index,
                            uint64_t chunk_position,
                            const std::vector<uint32_t>& message_offsets,
                            ByteSource* chunk);
  bool ReadMessage(uint32_t chunk_index,
                   uint64_t chunk_position,
                   const BagRecord& record,
                   ByteSource* chunk);
  bool AddConnection(const BagConnection& connection, uint64_t position);
  uint64_t NextKnownPosition(uint64_t position) const;
  void CompareWithIndex();

  InputFile file_;
  FileWindow window_;  // on the records outside of the chunks
  ChunkStore chunks_;
  BagRecord header_;
  BagIndex index_;
  std::map<uint32_t, uint64_t> chunk_index_counts_;  // by connection id, of all chunks
  uint32_t num_chunks_ = 0;
  std::vector<BagConnection> connections_;
  std::vector<Tally> tallies_;                       // of the connections
  std::map<uint32_t, uint32_t> connection_indices_;  // by connection id
  Wants wants_;
  Visit visit_;
  DamageLog damages_;
  std::vector<std::string> warnings_;
};

}  // namespace plumbline
