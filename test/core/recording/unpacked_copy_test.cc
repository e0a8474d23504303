#include "core/recording/unpacked_copy.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <string>

#include "test/core/recording/packing.h"
#include "test/testing/temporary_directory.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::StartsWith;

// Longer than the pieces in which it is unpacked.
std::string LongText() {
  std::string text;
  for (int i = 0; i < 100'000; ++i) text += std::to_string(i * 7919 % 100003);
  return text;
}

class UnpackedCopyTest : public TemporaryDirectoryTest,
                         public ::testing::WithParamInterface<const char*> {
 protected:
  std::string Write(const std::string& bytes) {
    const std::string path = (directory_ / "file").string();
    WriteBytes(path, bytes);
    return path;
  }
};

TEST_P(UnpackedCopyTest, HoldsWhatWasPackedForAsLongAsItLives) {
  const std::string text = LongText();
  std::string copy_path;
  {
    const UnpackedCopy copy(Write(Pack(GetParam(), text)), GetParam());
    copy_path = copy.copy_path();
    EXPECT_EQ(copy.problem(), "");
    EXPECT_TRUE(ReadBytes(copy_path) == text);
  }
  EXPECT_FALSE(fs::exists(copy_path));
}

// As parallel packers write them.
TEST_P(UnpackedCopyTest, StreamsThatFollowEachOtherAreOneFile) {
  const std::string packed =
      Pack(GetParam(), "one ") + Pack(GetParam(), "") + Pack(GetParam(), "two");
  const UnpackedCopy copy(Write(packed), GetParam());
  EXPECT_EQ(copy.problem(), "");
  EXPECT_EQ(ReadBytes(copy.copy_path()), "one two");
}

TEST_P(UnpackedCopyTest, FileThatBreaksOffIsUnpackedAsFarAsItGoes) {
  const std::string text = LongText();
  const std::string packed = Pack(GetParam(), text);
  const UnpackedCopy copy(Write(packed.substr(0, packed.size() / 2)), GetParam());
  EXPECT_EQ(copy.problem(), "it breaks off");
  const std::string unpacked = ReadBytes(copy.copy_path());
  EXPECT_LT(unpacked.size(), text.size());
  EXPECT_TRUE(unpacked == text.substr(0, unpacked.size()));
  EXPECT_EQ(UnpackedCopy(Write(""), GetParam()).problem(), "it breaks off");
}

TEST_P(UnpackedCopyTest, DamageIsSaidWithItsPlace) {
  const std::string first = Pack(GetParam(), "whole ");
  const UnpackedCopy copy(Write(first + "these bytes are no stream"), GetParam());
  EXPECT_THAT(copy.problem(), StartsWith("its packed bytes are damaged at byte "));
  EXPECT_GE(std::stoul(copy.problem().substr(copy.problem().rfind(' '))), first.size());
  EXPECT_EQ(ReadBytes(copy.copy_path()), "whole ");
}

TEST_P(UnpackedCopyTest, FullDiskIsAnErrorThatNamesTheFile) {
  const std::string path = Write(Pack(GetParam(), LongText()));
  EXPECT_EQ(ErrorOf([&] {
              const FileSizeLimit limit(100'000);
              UnpackedCopy(path, GetParam());
            }),
            path +
                ": its unpacked copy can not be written among the temporary files: File "
                "too large");
}

INSTANTIATE_TEST_SUITE_P(Both, UnpackedCopyTest, ::testing::Values("bz2", "zstd"));

TEST(UnpackedCopyErrorTest, FileThatIsNotThereIsNamed) {
  EXPECT_THAT(ErrorOf([] { UnpackedCopy("no/such/file.bz2", "bz2"); }),
              HasSubstr("no/such/file.bz2: "));
}

}  // namespace
}  // namespace plumbline
