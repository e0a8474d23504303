#include "core/result/result_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "test/testing/temporary_directory.h"

namespace plumbline {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(ResultFilesTest, NamesOfAResultAreItsOwn) {
  for (const char* name : {"planes.json",
                           "summary.json",
                           "rooms.json",
                           "report.html",
                           kRigUsed,
                           kRigCalibrated,
                           "map.ply",
                           "map_las12.las",
                           "floor_plan.svg",
                           "floor_plan_2.dxf",
                           "floor_plan_13.svg"}) {
    EXPECT_TRUE(IsResultFile(name)) << name;
  }
}

// Else a new result would remove them.
TEST(ResultFilesTest, EverythingElseIsTheUsers) {
  for (const char* name : {"",
                           "notes.txt",
                           "planes.json.old",
                           "my_planes.json",
                           "Planes.json",
                           "floor_plan",
                           "floor_plan.pdf",
                           "floor_plan_.svg",
                           "floor_plan_0.svg",
                           "floor_plan_02.svg",
                           "floor_plan_2b.svg",
                           "floor_plan2.svg",
                           "floor_plan_old.svg",
                           ".svg",
                           "part_1"}) {
    EXPECT_FALSE(IsResultFile(name)) << name;
  }
}

TEST(ResultFilesTest, PartsAreNumberedFromOne) {
  EXPECT_EQ(PartName(1), "part_1");
  EXPECT_EQ(PartName(12), "part_12");
  for (const size_t part : {1u, 9u, 10u, 123u}) EXPECT_TRUE(IsPartName(PartName(part)));
  for (const char* name :
       {"", "part_", "part_0", "part_01", "part_1a", "part_-1", "my_part_1"}) {
    EXPECT_FALSE(IsPartName(name)) << name;
  }
}

class PartsOfTest : public TemporaryDirectoryTest {};

TEST_F(PartsOfTest, FoldersOfPartsComeByTheirNumbers) {
  EXPECT_THAT(PartsOf(directory_.string()), IsEmpty());
  for (const char* name : {"part_10", "part_2", "part_1", "part_x", "other"}) {
    std::filesystem::create_directory(directory_ / name);
  }
  WriteBytes(directory_ / "part_3", "a file");
  EXPECT_THAT(PartsOf(directory_.string()), ElementsAre("part_1", "part_2", "part_10"));
}

}  // namespace
}  // namespace plumbline
