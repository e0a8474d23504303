#include "simulation/world/path_file.h"

#include <fstream>
#include <sstream>

#include "core/util/error.h"

namespace plumbline {

PathFile ReadPathFile(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw Error(path + ": can not open the file");
  PathFile result;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    std::istringstream words(line);
    std::string keyword;
    if (!(words >> keyword) || keyword.front() == '#') continue;
    if (keyword == "point") {
      Eigen::Vector3d& point = result.points.emplace_back();
      for (double& coordinate : point) words >> coordinate;
    } else if (keyword == "smooth") {
      words >> result.smooth_m;
    } else if (keyword == "drop") {
      int element = 0;
      while (words >> element) result.dropped.insert(element);
      if (words.eof()) words.clear();
    } else if (keyword != "building") {
      throw Error(path + ":" + std::to_string(number) + ": unknown word '" + keyword + "'");
    }
    if (!words) throw Error(path + ":" + std::to_string(number) + ": a number is missing");
  }
  if (result.points.size() < 2) throw Error(path + ": a path needs at least two points");
  if (!(result.smooth_m > 0.0 && result.smooth_m < 10.0)) {
    throw Error(path + ": smooth must lie between 0 and 10 m");
  }
  return result;
}

}  // namespace plumbline
