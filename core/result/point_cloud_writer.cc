#include "core/result/point_cloud_writer.h"

#include <glog/logging.h>
#include <pcl/PCLPointCloud2.h>
#include <pcl/io/pcd_io.h>

#include <limits>

namespace plumbline {
namespace {

// Spaces for the digits that the largest number of points has more: headers are of the same
// length for every number, so that they can be filled in at the end.
std::string Padding(int64_t num_points, size_t times) {
  const size_t num_digits = std::to_string(num_points).size();
  return std::string(times * (std::numeric_limits<int64_t>::digits10 + 1 - num_digits), ' ');
}

std::string PlyHeader(int64_t num_points) {
  return "ply\n"
         "format binary_little_endian 1.0\n"
         "comment metres; time in s since the first scan line; plane_id -1: on no plane" +
         Padding(num_points, 1) +
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
         "end_header\n";
}

std::string PcdHeader(int64_t num_points) {
  pcl::PCLPointCloud2 cloud;
  cloud.width = static_cast<pcl::uindex_t>(num_points);
  cloud.height = 1;
  const auto add_field = [&cloud](const std::string& name, uint8_t type, size_t size) {
    pcl::PCLPointField field;
    field.name = name;
    field.offset = cloud.point_step;
    field.datatype = type;
    field.count = 1;
    cloud.fields.push_back(field);
    cloud.point_step += static_cast<pcl::uindex_t>(size);
  };
  for (const char* name : {"x", "y", "z"}) {
    add_field(name, pcl::PCLPointField::FLOAT32, sizeof(float));
  }
  add_field("time", pcl::PCLPointField::FLOAT64, sizeof(double));
  add_field("scanner", pcl::PCLPointField::UINT8, sizeof(uint8_t));
  add_field("plane_id", pcl::PCLPointField::INT32, sizeof(int32_t));
  add_field("residual", pcl::PCLPointField::FLOAT32, sizeof(float));
  CHECK_EQ(cloud.point_step, PointBuffer::kPointBytes);
  cloud.row_step = cloud.point_step * cloud.width;
  // The number occurs twice, as width and as points.
  return pcl::PCDWriter().generateHeaderBinary(
             cloud, Eigen::Vector4f::Zero(), Eigen::Quaternionf::Identity()) +
         "#" + Padding(num_points, 2) + "\nDATA binary\n";
}

}  // namespace

PointCloudWriter::PointCloudWriter(const std::string& directory,
                                   const std::string& final_name)
    : ply_(directory + "/map.ply", final_name + "/map.ply"),
      pcd_(directory + "/map.pcd", final_name + "/map.pcd") {
  // The numbers are filled in at the end.
  const std::string ply_header = PlyHeader(0);
  const std::string pcd_header = PcdHeader(0);
  ply_.Append(ply_header.data(), ply_header.size());
  pcd_.Append(pcd_header.data(), pcd_header.size());
}

void PointCloudWriter::Add(const PointBuffer& points) {
  CHECK(!finished_) << "Add() after Finish()";
  ply_.Append(points.data(), points.num_bytes());
  pcd_.Append(points.data(), points.num_bytes());
  num_points_ += points.num_points();
}

void PointCloudWriter::Finish() {
  CHECK(!finished_) << "Finish() twice";
  finished_ = true;
  ply_.Finish(PlyHeader(num_points_));
  pcd_.Finish(PcdHeader(num_points_));
}

}  // namespace plumbline
