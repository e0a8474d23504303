#include "core/result/point_cloud_writer.h"

#include <glog/logging.h>

#include <algorithm>
#include <iterator>
#include <sstream>

#include "core/result/e57_writer.h"
#include "core/result/las_writer.h"
#include "core/result/pcd_writer.h"
#include "core/result/ply_writer.h"
#include "core/util/error.h"

namespace plumbline {
namespace {

struct Format {
  CloudFormat format;
  const char* name;
  const char* file;
};

constexpr Format kFormats[] = {{CloudFormat::kPly, "ply", "map.ply"},
                               {CloudFormat::kPcd, "pcd", "map.pcd"},
                               {CloudFormat::kLas, "las", "map.las"},
                               {CloudFormat::kLas12, "las12", "map_las12.las"},
                               {CloudFormat::kE57, "e57", "map.e57"}};

}  // namespace

std::vector<CloudFormat> ParseCloudFormats(const std::string& list) {
  std::vector<CloudFormat> formats;
  std::istringstream names(list);
  for (std::string name; std::getline(names, name, ',');) {
    const auto* found =
        std::find_if(std::begin(kFormats), std::end(kFormats), [&](const Format& format) {
          return name == format.name;
        });
    if (found == std::end(kFormats)) {
      throw Error("formats: '" + name + "' is none of ply, pcd, las, las12, e57");
    }
    if (std::find(formats.begin(), formats.end(), found->format) != formats.end()) {
      throw Error("formats: '" + name + "' stands there twice");
    }
    formats.push_back(found->format);
  }
  if (formats.empty()) throw Error("formats: name one at least, such as 'ply'");
  return formats;
}

bool IsCloudFormatList(const std::string& text) {
  try {
    ParseCloudFormats(text);
    return true;
  } catch (const Error&) {
    return false;
  }
}

std::string CloudFileName(CloudFormat format) {
  for (const Format& known : kFormats) {
    if (known.format == format) return known.file;
  }
  LOG(FATAL) << "not a format";
}

bool IsCloudFileName(const std::string& name) {
  return std::any_of(std::begin(kFormats), std::end(kFormats), [&](const Format& format) {
    return name == format.file;
  });
}

std::unique_ptr<PointCloudWriter> CreatePointCloudWriter(CloudFormat format,
                                                         const std::string& path,
                                                         const std::string& name) {
  switch (format) {
    case CloudFormat::kPly:
      return std::make_unique<PlyWriter>(path, name);
    case CloudFormat::kPcd:
      return std::make_unique<PcdWriter>(path, name);
    case CloudFormat::kLas:
      return std::make_unique<LasWriter>(LasVersion::k14, path, name);
    case CloudFormat::kLas12:
      return std::make_unique<LasWriter>(LasVersion::k12, path, name);
    case CloudFormat::kE57:
      return std::make_unique<E57Writer>(path, name);
  }
  LOG(FATAL) << "not a format";
}

}  // namespace plumbline
