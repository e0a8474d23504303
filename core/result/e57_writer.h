#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "core/result/e57_pages.h"
#include "core/result/point_cloud_writer.h"
#include "core/util/checksum.h"

namespace plumbline {

// Writes points as an E57 file (ASTM E2807) with one scan: position, time, colour, normal
// (extension nor), scanner and plane_id (an extension of ours). Residuals are left out: the
// standard does not say whether a value may be no number.
//
// The points are one compressed vector: packets that hold, field by field, the values of some
// points. All values take whole bytes, so that nothing has to be packed into bits.
class E57Writer : public PointCloudWriter {
 public:
  E57Writer(const std::string& path, const std::string& name);
  void Add(const PointBuffer& points) override;
  void Finish() override;

 private:
  void WritePacket();
  // Returns the headers of the file and of its compressed vector, which stand at its begin.
  std::string Beginning(uint64_t xml_offset, uint64_t xml_bytes) const;
  std::string Xml() const;
  // Makes a GUID from the points: the same points have the same one. `salt` tells apart what
  // one file names.
  std::string Guid(uint64_t salt) const;

  E57Pages pages_;
  std::vector<std::string> columns_;  // the packet that is being filled, a text for each field
  int64_t num_in_packet_ = 0;
  int64_t num_points_ = 0;
  uint64_t section_end_ = 0;  // logical
  Eigen::Vector3f min_ = Eigen::Vector3f::Zero();
  Eigen::Vector3f max_ = Eigen::Vector3f::Zero();
  Checksum checksum_;
};

}  // namespace plumbline
