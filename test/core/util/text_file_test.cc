#include "core/util/text_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "core/util/error.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

std::string PathOf(const std::string& name) {
  return testing::TempDir() + "text_file_" + name;
}

std::string ErrorOfReading(const std::string& path) {
  try {
    ReadTextFile(path);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(ReadTextFile, ReturnsEveryByte) {
  const std::string text("a\r\n\0b\n", 6);
  const std::string path = PathOf("bytes");
  std::ofstream(path, std::ios::binary) << text;
  EXPECT_EQ(ReadTextFile(path), text);
  std::filesystem::remove(path);
}

TEST(ReadTextFile, ReadsAnEmptyFile) {
  const std::string path = PathOf("empty");
  std::ofstream(path).close();
  EXPECT_EQ(ReadTextFile(path), "");
  std::filesystem::remove(path);
}

TEST(ReadTextFile, NamesTheFileAndTheCause) {
  const std::string path = PathOf("missing");
  EXPECT_THAT(ErrorOfReading(path), HasSubstr(path + ": can not be read: No such file"));
  EXPECT_THAT(ErrorOfReading(testing::TempDir()), HasSubstr("directory"));
}

}  // namespace
}  // namespace plumbline
