#include "core/result/e57_pages.h"

#include <gtest/gtest.h>

#include <string>

#include "test/testing/e57_text.h"
#include "test/testing/temporary_directory.h"

namespace plumbline {
namespace {

TEST(E57PagesTest, PhysicalOffsetsCountTheChecksums) {
  EXPECT_EQ(E57Pages::PhysicalOffset(0), 0u);
  EXPECT_EQ(E57Pages::PhysicalOffset(1019), 1019u);
  EXPECT_EQ(E57Pages::PhysicalOffset(1020), 1024u);
  EXPECT_EQ(E57Pages::PhysicalOffset(2041), 2049u);
}

// The known value of the checksum's standard (RFC 3720, B.4): of 32 zeros.
TEST(E57PagesTest, ChecksumOfTheTestIsTheStandards) {
  EXPECT_EQ(Crc32c("123456789"), 0xE3069283u);
  EXPECT_EQ(Crc32c(std::string(32, '\0')), 0x8A9136AAu);
}

class E57PagesFileTest : public TemporaryDirectoryTest {
 protected:
  std::string path() const { return (directory_ / "map.e57").string(); }
};

TEST_F(E57PagesFileTest, PagesHoldTheBytesAndTheirChecksums) {
  std::string content;
  for (int i = 0; i < 5000; ++i) content += static_cast<char>(i * 7 % 251);
  for (const size_t piece : {size_t{1}, size_t{1020}, size_t{1500}, content.size()}) {
    E57Pages pages(path(), "name");
    for (size_t at = 0; at < content.size(); at += piece)
      pages.Append(content.substr(at, piece));
    EXPECT_EQ(pages.logical_size(), 5000u);
    EXPECT_EQ(pages.physical_size(), 5u * 1024u);
    pages.Finish("begin");
    const std::string bytes = ReadBytes(path());
    ASSERT_EQ(bytes.size(), 5u * 1024u);
    EXPECT_TRUE(PayloadOfE57(bytes) ==
                "begin" + content.substr(5) + std::string(5 * 1020 - 5000, '\0'));
  }
}

TEST_F(E57PagesFileTest, FullPagesAreNotFilledUp) {
  E57Pages pages(path(), "name");
  pages.Append(std::string(2 * 1020, 'x'));
  EXPECT_EQ(pages.physical_size(), 2u * 1024u);
  pages.Append("");
  pages.Finish("");
  EXPECT_TRUE(PayloadOfE57(ReadBytes(path())) == std::string(2 * 1020, 'x'));
}

TEST_F(E57PagesFileTest, FileThatCanNotBeWrittenIsNamed) {
  EXPECT_NE(ErrorOf([] { E57Pages("no/such/folder/map.e57", "name"); }).find("name: "),
            std::string::npos);
  EXPECT_EQ(ErrorOf([&] {
              const FileSizeLimit limit(3000);
              E57Pages pages(path(), "name");
              pages.Append(std::string(10'000'000, 'x'));
              pages.Finish("");
            }),
            "name: can not be written: File too large");
}

}  // namespace
}  // namespace plumbline
