#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/result/point_buffer.h"

namespace plumbline {

// The formats in which a map's points can be written (docs/outputs.md): PLY, PCD, LAS 1.4,
// LAS 1.2 and E57.
enum class CloudFormat { kPly, kPcd, kLas, kLas12, kE57 };

// Default of --formats.
inline constexpr char kDefaultCloudFormats[] = "ply,pcd";

// Reads a list such as "ply,las" of the names ply, pcd, las, las12 and e57. Throws Error
// naming what is no format, or stands there twice.
std::vector<CloudFormat> ParseCloudFormats(const std::string& list);

// Whether a text is such a list.
bool IsCloudFormatList(const std::string& text);

// The file of a format in a result: map.ply, map.pcd, map.las, map_las12.las, map.e57.
std::string CloudFileName(CloudFormat format);

// Whether a name is that of one of these files.
bool IsCloudFileName(const std::string& name);

// PointCloudWriter writes points to one file, one after the other, at a constant cost in
// memory. The same points give the same bytes, however they are dealt out to calls.
class PointCloudWriter {
 public:
  virtual ~PointCloudWriter() = default;

  // Add and Finish throw Error naming the file where it can not be written, or its format can
  // not hold the points.
  virtual void Add(const PointBuffer& points) = 0;
  // Completes the file. Call once, after the last point.
  virtual void Finish() = 0;
};

// Creates the file `path`; errors call it `name`. Throws Error where that is not possible.
std::unique_ptr<PointCloudWriter> CreatePointCloudWriter(CloudFormat format,
                                                         const std::string& path,
                                                         const std::string& name);

}  // namespace plumbline
