#include "core/util/json_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "test/testing/temporary_directory.h"

namespace plumbline {
namespace {

using ::testing::HasSubstr;
using Json = nlohmann::json;

class JsonFileTest : public TemporaryDirectoryTest {
 protected:
  std::string path() const { return (directory_ / "a.json").string(); }
  std::string Fault(const std::string& text) {
    WriteBytes(path(), text);
    return ErrorOf([this] { ReadJsonObject<Json>(path()); });
  }
};

TEST_F(JsonFileTest, ReadsAnObject) {
  WriteBytes(path(), "{\"a\": [1, {\"b\": null}]}");
  EXPECT_EQ(ReadJsonObject<Json>(path())["a"][0], 1);
}

TEST_F(JsonFileTest, NamesFileAndFault) {
  EXPECT_THAT(ErrorOf([this] { ReadJsonFile<Json>(path()); }),
              HasSubstr(path() + ": can not be read: No such file"));
  EXPECT_THAT(Fault("{\"a\": }"), HasSubstr(path() + ": byte 7: is not valid JSON"));
  EXPECT_THAT(Fault("{\"a\": 1e999}"), HasSubstr(path() + ": is not valid JSON: "));
  EXPECT_THAT(Fault("[]"), HasSubstr(path() + ": is not an object"));
}

TEST_F(JsonFileTest, DeepNestingIsAnError) {
  std::string objects;
  for (int i = 0; i < 100'000; ++i) objects += "{\"a\":";
  EXPECT_THAT(Fault(objects), HasSubstr(path() + ": its arrays and objects are nested more"));
  EXPECT_THAT(Fault(std::string(100'000, '[')), HasSubstr("are nested more than 100 deep"));
}

}  // namespace
}  // namespace plumbline
