#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "simulation/world/building.h"
#include "test/testing/paths.h"

namespace plumbline {
namespace {

// Every floor of the data set that scripts/buildings/import_floorplan.py reads gives a
// building that the simulator accepts. The data are not part of the repository.
TEST(ImportedBuildingTest, FloorsOfTheDataSetLoad) {
  const std::string source = SourceDir();
  const std::string data = source + "/../shared/data/floorplans/fp.json";
  if (!std::filesystem::exists(data)) GTEST_SKIP() << "no floor plans at " << data;
  const std::string output = ::testing::TempDir() + "/plumbline_imported_building.yaml";
  for (const char* floor : {"302", "748", "848", "966", "1058", "1059", "1060"}) {
    const std::string command = "'" + source + "/scripts/buildings/import_floorplan.py' '" +
                                data + "' --floor " + floor + " --output '" + output + "'";
    ASSERT_EQ(std::system(command.c_str()), 0) << command;
    const Building building = ReadBuilding(output);
    EXPECT_GT(building.faces.size(), 50u) << floor;
    EXPECT_DOUBLE_EQ(building.ceiling_height - building.floor_height, 2.5);
  }
  std::filesystem::remove(output);
}

}  // namespace
}  // namespace plumbline
