#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/result/point_cloud_writer.h"
#include "core/util/progress.h"

namespace plumbline {

// The job of plumbline_export: the points of a finished map in other formats.
struct CloudExport {
  std::string result;  // directory with map.ply
  std::vector<CloudFormat> formats;
  std::string output;  // directory; is created where it is missing
};

// Writes the files named by CloudFileName() into the output directory; each appears when it is
// whole, and none where one of them fails. Returns the number of points. Throws Error.
int64_t RunCloudExport(const CloudExport& job, const ProgressCallback& progress);

}  // namespace plumbline
