#include "core/result/cloud_export.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "test/testing/known_points.h"
#include "test/testing/temporary_directory.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class CloudExportTest : public TemporaryDirectoryTest {
 protected:
  void SetUp() override {
    TemporaryDirectoryTest::SetUp();
    fs::create_directory(result());
    Write(CloudFormat::kPly, result());
  }
  fs::path result() const { return directory_ / "result"; }
  fs::path output() const { return directory_ / "out" / "deep"; }

  static void Write(CloudFormat format, const fs::path& folder) {
    const std::string path = (folder / CloudFileName(format)).string();
    const auto writer = CreatePointCloudWriter(format, path, path);
    writer->Add(KnownPoints(0, 3000));
    writer->Finish();
  }
  int64_t Export(const std::vector<CloudFormat>& formats, const fs::path& to) {
    return RunCloudExport({result().string(), formats, to.string()}, [](double) {});
  }
  static std::set<std::string> FilesIn(const fs::path& folder) {
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder)) {
      names.insert(entry.path().filename().string());
    }
    return names;
  }
};

TEST_F(CloudExportTest, FilesAreThoseThatTheMapperWouldHaveWritten) {
  const std::vector<CloudFormat> formats = {CloudFormat::kPly,
                                            CloudFormat::kPcd,
                                            CloudFormat::kLas,
                                            CloudFormat::kLas12,
                                            CloudFormat::kE57};
  EXPECT_EQ(Export(formats, output()), 3000);
  EXPECT_THAT(FilesIn(output()),
              ElementsAre("map.e57", "map.las", "map.pcd", "map.ply", "map_las12.las"));
  for (const CloudFormat format : formats) {
    Write(format, directory_);
    const std::string name = CloudFileName(format);
    EXPECT_TRUE(ReadBytes(directory_ / name) == ReadBytes(output() / name)) << name;
  }
}

TEST_F(CloudExportTest, MayReplaceTheFileThatItReads) {
  const std::string before = ReadBytes(result() / "map.ply");
  Export({CloudFormat::kPly, CloudFormat::kLas}, result());
  EXPECT_TRUE(before == ReadBytes(result() / "map.ply"));
  EXPECT_THAT(FilesIn(result()), ElementsAre("map.las", "map.ply"));
}

TEST_F(CloudExportTest, AFailureLeavesNothing) {
  const std::string error = ErrorOf([&] {
    const FileSizeLimit limit(100'000);
    Export({CloudFormat::kLas12, CloudFormat::kLas}, output());
  });
  EXPECT_THAT(error, HasSubstr("can not be written: File too large"));
  EXPECT_THAT(FilesIn(output()), ElementsAre());
}

TEST_F(CloudExportTest, NamesAMissingMap) {
  fs::remove(result() / "map.ply");
  EXPECT_THAT(ErrorOf([&] { Export({CloudFormat::kLas}, output()); }),
              HasSubstr("result/map.ply: can not be read"));
  EXPECT_FALSE(fs::exists(directory_ / "out"));
}

}  // namespace
}  // namespace plumbline
