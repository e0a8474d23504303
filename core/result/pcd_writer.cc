#include "core/result/pcd_writer.h"

#include <glog/logging.h>
#include <pcl/PCLPointCloud2.h>
#include <pcl/io/pcd_io.h>

#include <utility>
#include <vector>

#include "core/result/header_padding.h"

namespace plumbline {
namespace {

std::string Header(int64_t num_points) {
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
  const auto add_floats = [&](const std::vector<std::string>& names) {
    for (const std::string& name : names) {
      add_field(name, pcl::PCLPointField::FLOAT32, sizeof(float));
    }
  };
  add_floats({"x", "y", "z"});
  add_field("time", pcl::PCLPointField::FLOAT64, sizeof(double));
  add_field("scanner", pcl::PCLPointField::UINT8, sizeof(uint8_t));
  add_field("plane_id", pcl::PCLPointField::INT32, sizeof(int32_t));
  add_floats({"residual"});
  // The least significant byte is blue. PCL's other name for colours, rgb, is for the same
  // bytes as a float, which may be no number.
  add_field("rgba", pcl::PCLPointField::UINT32, sizeof(uint32_t));
  add_floats({"normal_x", "normal_y", "normal_z"});
  CHECK_EQ(cloud.point_step, PointBuffer::kPointBytes);
  cloud.row_step = cloud.point_step * cloud.width;
  // The number occurs twice, as width and as points.
  return pcl::PCDWriter().generateHeaderBinary(
             cloud, Eigen::Vector4f::Zero(), Eigen::Quaternionf::Identity()) +
         "#" + HeaderPadding(num_points, 2) + "\nDATA binary\n";
}

}  // namespace

PcdWriter::PcdWriter(const std::string& path, const std::string& name) : file_(path, name) {
  const std::string header = Header(0);  // the number is filled in at the end
  file_.Append(header.data(), header.size());
}

void PcdWriter::Add(const PointBuffer& points) {
  records_.assign(points.data(), points.num_bytes());
  for (size_t at = PointBuffer::kColourOffset; at < records_.size();
       at += PointBuffer::kPointBytes) {
    std::swap(records_[at], records_[at + 2]);
  }
  file_.Append(records_.data(), records_.size());
  num_points_ += points.num_points();
}

void PcdWriter::Finish() { file_.Finish(Header(num_points_)); }

}  // namespace plumbline
