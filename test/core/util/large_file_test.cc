#include "core/util/large_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>

#include "test/testing/temporary_directory.h"

namespace plumbline {
namespace {

using ::testing::HasSubstr;

constexpr size_t kMebibyte = size_t{1} << 20;

std::string RandomBytes(size_t size) {
  std::string bytes(size, '\0');
  std::mt19937 random(1);
  for (char& byte : bytes) byte = static_cast<char>(random());
  return bytes;
}

class LargeFileTest : public TemporaryDirectoryTest {
 protected:
  // Writes the bytes in pieces of the given size, and other ones over the first.
  void Write(const std::string& bytes, size_t piece, int64_t cached_bytes) const {
    LargeFile file(Path(), "NAME", cached_bytes);
    for (size_t at = 0; at < bytes.size(); at += piece) {
      file.Append(bytes.data() + at, std::min(piece, bytes.size() - at));
    }
    file.Finish("beginning");
  }
  std::string Path() const { return (directory_ / "file").string(); }
};

TEST_F(LargeFileTest, HoldsAllBytesHoweverTheyAreWritten) {
  for (const size_t size : {size_t{9}, 2 * kMebibyte, 5 * kMebibyte + 4321}) {
    const std::string bytes = RandomBytes(size);
    const std::string expected = "beginning" + bytes.substr(9);
    for (const size_t piece : {size_t{333'333}, 3 * kMebibyte}) {
      for (const int64_t cached_bytes : {int64_t{0}, int64_t{1} << 21, int64_t{1} << 30}) {
        Write(bytes, piece, cached_bytes);
        EXPECT_TRUE(ReadBytes(Path()) == expected)
            << size << " bytes by " << piece << ", " << cached_bytes << " cached";
      }
    }
  }
}

TEST_F(LargeFileTest, NamesTheFileThatCanNotBeWritten) {
  EXPECT_THAT(ErrorOf([&] { LargeFile((directory_ / "none" / "file").string(), "NAME"); }),
              HasSubstr("NAME: can not be written: No such file"));
  const std::string bytes = RandomBytes(8 * kMebibyte);
  for (const int64_t cached_bytes : {int64_t{0}, LargeFile::kCachedBytes}) {
    const FileSizeLimit limit(3 * kMebibyte + 4096);
    EXPECT_THAT(ErrorOf([&] { Write(bytes, kMebibyte, cached_bytes); }),
                HasSubstr("NAME: can not be written: File too large"))
        << cached_bytes;
  }
}

}  // namespace
}  // namespace plumbline
