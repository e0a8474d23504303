#include "core/recording/chunk_store.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "test/core/recording/byte_text.h"
#include "test/core/recording/packing.h"
#include "test/testing/temporary_directory.h"

namespace plumbline {
namespace {

class ChunkStoreTest : public TemporaryDirectoryTest {
 protected:
  // Puts a chunk into the file that Open() will show; its stated size is that of `content`.
  void Put(const std::string& compression, const std::string& content) {
    BagRecord record;
    record.compression = compression;
    record.data_begin = bytes_.size();
    const std::string data = compression == "none" ? content : Pack(compression, content);
    record.data_size = static_cast<uint32_t>(data.size());
    record.unpacked_size = static_cast<uint32_t>(content.size());
    records_.push_back(record);
    bytes_ += data;
  }

  void OpenFile() {
    WriteBytes(directory_ / "file", bytes_);
    file_ = std::make_unique<InputFile>((directory_ / "file").string());
    store_ = std::make_unique<ChunkStore>(file_.get());
    for (size_t i = 0; i < records_.size(); ++i) EXPECT_EQ(store_->Add(records_[i]), i);
  }

  std::string Content(uint32_t chunk) {
    const ChunkStore::Contents contents = store_->Open(chunk);
    problem_ = contents.problem;
    end_ = contents.end;
    ByteView bytes;
    EXPECT_TRUE(
        contents.source->View(0, static_cast<size_t>(contents.source->size()), &bytes));
    return TextOf(bytes);
  }

  std::string bytes_ = "what comes before";
  std::vector<BagRecord> records_;
  std::unique_ptr<InputFile> file_;
  std::unique_ptr<ChunkStore> store_;
  std::string problem_;
  uint64_t end_ = 0;
};

TEST_F(ChunkStoreTest, GivesWhatChunksHoldPackedOrNot) {
  for (const char* compression : {"none", "bz2", "lz4", "zstd"}) {
    Put(compression, std::string("messages of ") + compression);
    Put(compression, "");
  }
  bytes_ += "what comes behind";
  OpenFile();
  for (uint32_t i = 0; i < records_.size(); ++i) {
    const std::string compression = records_[i].compression;
    EXPECT_EQ(Content(i), i % 2 == 0 ? "messages of " + compression : "");
    EXPECT_EQ(problem_, "") << compression;
    EXPECT_EQ(end_, records_[i].end()) << compression;
  }
}

// More than are kept unpacked, to and fro.
TEST_F(ChunkStoreTest, ManyChunksAreOpenedInAnyOrder) {
  for (int i = 0; i < 20; ++i) Put("lz4", "chunk " + std::to_string(i));
  OpenFile();
  for (const int step : {1, 7, 19, 3}) {
    for (int i = 0; i < 40; ++i) {
      const int chunk = i * step % 20;
      EXPECT_EQ(Content(static_cast<uint32_t>(chunk)), "chunk " + std::to_string(chunk));
    }
  }
}

TEST_F(ChunkStoreTest, ChunkThatBreaksOffWithTheFileIsShownAsFarAsItGoes) {
  Put("none", "0123456789");
  bytes_.resize(bytes_.size() - 4);
  OpenFile();
  EXPECT_EQ(Content(0), "012345");
  EXPECT_EQ(problem_, "it breaks off");
  EXPECT_EQ(end_, bytes_.size());
}

TEST_F(ChunkStoreTest, PackedChunkThatBreaksOffIsNoWholeOne) {
  Put("bz2", "0123456789");
  bytes_.resize(bytes_.size() - 4);
  OpenFile();
  Content(0);
  EXPECT_EQ(problem_, "it breaks off");
}

TEST_F(ChunkStoreTest, SizeThatIsStatedWronglyIsTold) {
  for (const char* compression : {"none", "bz2", "lz4", "zstd"}) {
    Put(compression, "content");
    ++records_.back().unpacked_size;
  }
  OpenFile();
  for (uint32_t i = 0; i < records_.size(); ++i) {
    EXPECT_EQ(Content(i), "content");
    EXPECT_EQ(problem_, "it has not the size that it states") << records_[i].compression;
  }
}

TEST_F(ChunkStoreTest, UnknownCompressionIsAProblemNotAnError) {
  Put("none", "content");
  records_.back().compression = "zip";
  OpenFile();
  EXPECT_EQ(Content(0), "");
  EXPECT_EQ(problem_, "it is packed in an unknown way");
}

}  // namespace
}  // namespace plumbline
