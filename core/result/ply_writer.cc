#include "core/result/ply_writer.h"

#include "core/result/header_padding.h"

namespace plumbline {
namespace {

std::string Header(int64_t num_points) {
  return "ply\n"
         "format binary_little_endian 1.0\n"
         "comment metres; time in s since the first scan line; plane_id -1: on no plane" +
         HeaderPadding(num_points, 1) +
         "\n"
         "element vertex " +
         std::to_string(num_points) +
         "\n"
         "property float x\n"
         "property float y\n"
         "property float z\n"
         "property double time\n"
         "property uchar scanner\n"
         "property int plane_id\n"
         "property float residual\n"
         "property uchar red\n"
         "property uchar green\n"
         "property uchar blue\n"
         "property uchar alpha\n"
         "property float nx\n"
         "property float ny\n"
         "property float nz\n"
         "end_header\n";
}

}  // namespace

PlyWriter::PlyWriter(const std::string& path, const std::string& name) : file_(path, name) {
  const std::string header = Header(0);  // the number is filled in at the end
  file_.Append(header.data(), header.size());
}

void PlyWriter::Add(const PointBuffer& points) {
  file_.Append(points.data(), points.num_bytes());
  num_points_ += points.num_points();
}

void PlyWriter::Finish() { file_.Finish(Header(num_points_)); }

}  // namespace plumbline
