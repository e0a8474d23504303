#include "core/recording/byte_source.h"

#include <gtest/gtest.h>

#include "test/testing/temporary_directory.h"

namespace plumbline {
namespace {

class ByteSourceTest : public TemporaryDirectoryTest {};

TEST(ByteCursor, TakesNoMoreThanThereIs) {
  const uint8_t bytes[] = {1, 0, 0, 0, 7, 8};
  ByteCursor cursor({bytes, sizeof(bytes)});
  uint32_t number = 0;
  ASSERT_TRUE(cursor.Take(&number));
  EXPECT_EQ(number, 1u);
  EXPECT_FALSE(cursor.Take(&number));
  ByteView rest;
  EXPECT_FALSE(cursor.Take(3, &rest));
  ASSERT_TRUE(cursor.Take(2, &rest));
  EXPECT_EQ(rest.data[1], 8);
  EXPECT_EQ(cursor.num_left(), 0u);
}

TEST_F(ByteSourceTest, WindowShowsTheFileWhereverItIsMoved) {
  const std::string path = (directory_ / "file").string();
  std::string content;
  for (int i = 0; i < 1000; ++i) content += static_cast<char>(i * 7 % 251);
  WriteBytes(path, content);
  const InputFile file(path);
  FileWindow window(&file, 64);
  SourceRange range(&window, 100, 800);
  ASSERT_EQ(range.size(), 800u);
  for (const uint64_t offset : {0u, 10u, 60u, 400u, 5u, 799u, 800u}) {
    for (const size_t size : {size_t{0}, size_t{1}, size_t{40}, size_t{300}}) {
      ByteView bytes;
      ASSERT_EQ(range.View(offset, size, &bytes), offset + size <= 800);
      if (offset + size > 800) continue;
      EXPECT_EQ(std::string(reinterpret_cast<const char*>(bytes.data), size),
                content.substr(100 + offset, size));
    }
  }
  ByteView bytes;
  EXPECT_FALSE(range.View(1, SIZE_MAX, &bytes));
  EXPECT_FALSE(range.View(UINT64_MAX, 1, &bytes));
}

TEST_F(ByteSourceTest, FileThatBecomesShorterIsNamed) {
  const std::string path = (directory_ / "file").string();
  WriteBytes(path, std::string(1000, 'x'));
  const InputFile file(path);
  std::filesystem::resize_file(path, 500);
  uint8_t bytes[1000];
  EXPECT_EQ(ErrorOf([&] { file.Read(0, 1000, bytes); }),
            path + ": has become shorter while it was read");
}

}  // namespace
}  // namespace plumbline
