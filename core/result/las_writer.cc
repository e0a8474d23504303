#include "core/result/las_writer.h"

#include <glog/logging.h>

#include <array>
#include <cmath>
#include <limits>

#include "core/result/little_endian.h"
#include "core/result/surface_colour.h"
#include "core/util/error.h"

namespace plumbline {
namespace {

// Page and table numbers: ASPRS, LAS specification 1.4 - R15.
constexpr double kScale_m = 1e-4;
constexpr uint8_t kFirstOfOneReturn = 0x11;   // 1.4: four bits each
constexpr uint8_t kFirstOfOneReturn12 = 0x9;  // 1.2: three bits each
constexpr uint8_t kUnclassified = 1;
constexpr uint8_t kBuilding = 6;
constexpr uint16_t kWktInUse = 1 << 4;  // global encoding; point formats from 6 on ask for it

struct Layout {
  uint8_t minor_version;
  uint16_t header_bytes;
  uint8_t point_format;
  uint16_t point_bytes;
};

constexpr uint16_t kExtraBytes = sizeof(uint8_t) + sizeof(int32_t) + sizeof(float);

Layout LayoutOf(LasVersion version) {
  return version == LasVersion::k12 ? Layout{2, 227, 3, 34}
                                    : Layout{4, 375, 7, 36 + kExtraBytes};
}

// The text, filled up with zeros.
void AppendText(const std::string& text, size_t size, std::string* bytes) {
  CHECK_LE(text.size(), size);
  *bytes += text + std::string(size - text.size(), '\0');
}

// A variable length record: user and number name its kind.
void AppendRecord(const std::string& user,
                  uint16_t number,
                  const std::string& description,
                  const std::string& content,
                  std::string* bytes) {
  AppendLittleEndian<uint16_t>(0, bytes);
  AppendText(user, 16, bytes);
  AppendLittleEndian(number, bytes);
  AppendLittleEndian(static_cast<uint16_t>(content.size()), bytes);
  AppendText(description, 32, bytes);
  *bytes += content;
}

// Describes one field of the extra bytes (table 24; the types are those of table 25).
void AppendExtraField(uint8_t type,
                      const std::string& name,
                      const std::string& description,
                      std::string* bytes) {
  AppendLittleEndian<uint16_t>(0, bytes);
  AppendLittleEndian(type, bytes);
  AppendLittleEndian<uint8_t>(0, bytes);  // options: neither no-data, range, scale nor offset
  AppendText(name, 32, bytes);
  AppendText("", 4 + 5 * 24, bytes);
  AppendText(description, 32, bytes);
}

// Coordinates of a building, not of the earth. GDAL takes two axes of such, no more.
std::string ModelFrameWkt() {
  return std::string(
             "LOCAL_CS[\"plumbline model frame\",LOCAL_DATUM[\"first pose\",32767],"
             "UNIT[\"metre\",1],AXIS[\"x\",OTHER],AXIS[\"y\",OTHER]]") +
         '\0';
}

std::string DescribingRecords() {
  constexpr uint8_t kUint8 = 1;
  constexpr uint8_t kInt32 = 6;
  constexpr uint8_t kFloat = 9;
  std::string fields;
  AppendExtraField(kUint8, "scanner", "position in the rig file", &fields);
  AppendExtraField(kInt32, "plane_id", "-1: none; -2: on what moves", &fields);
  AppendExtraField(kFloat, "residual", "m from its plane; NaN: none", &fields);
  std::string records;
  AppendRecord(
      "LASF_Projection", 2112, "OGC coordinate system WKT", ModelFrameWkt(), &records);
  AppendRecord("LASF_Spec", 4, "Extra bytes", fields, &records);
  return records;
}

uint16_t SourceId12(int plane_id, const std::string& name) {
  if (plane_id < 0) return 0;
  if (plane_id >= std::numeric_limits<uint16_t>::max()) {
    throw Error(name + ": can not be written: LAS 1.2 has no number for plane " +
                std::to_string(plane_id) + "; LAS 1.4 has");
  }
  return static_cast<uint16_t>(plane_id + 1);
}

}  // namespace

LasWriter::LasWriter(LasVersion version, const std::string& path, const std::string& name)
    : version_(version), name_(name), file_(path, name) {
  const std::string header = Header();  // numbers and bounds are filled in at the end
  file_.Append(header.data(), header.size());
}

std::string LasWriter::Header() const {
  const bool is_14 = version_ == LasVersion::k14;
  const Layout layout = LayoutOf(version_);
  const std::string records = is_14 ? DescribingRecords() : "";
  std::string bytes;
  AppendText("LASF", 4, &bytes);
  AppendLittleEndian<uint16_t>(0, &bytes);  // file source ID
  AppendLittleEndian<uint16_t>(is_14 ? kWktInUse : 0, &bytes);
  AppendText("", 16, &bytes);  // project GUID
  AppendLittleEndian<uint8_t>(1, &bytes);
  AppendLittleEndian(layout.minor_version, &bytes);
  AppendText("OTHER", 32, &bytes);  // system identifier
  AppendText("plumbline", 32, &bytes);
  AppendText("", 4, &bytes);  // no day of creation: the same map gives the same bytes
  AppendLittleEndian(layout.header_bytes, &bytes);
  AppendLittleEndian(static_cast<uint32_t>(layout.header_bytes + records.size()), &bytes);
  AppendLittleEndian<uint32_t>(is_14 ? 2 : 0, &bytes);  // records
  AppendLittleEndian(layout.point_format, &bytes);
  AppendLittleEndian(layout.point_bytes, &bytes);
  // The legacy numbers of points, and of first to fifth returns.
  const auto legacy = is_14 ? 0 : static_cast<uint32_t>(num_points_);
  AppendLittleEndian(legacy, &bytes);
  AppendLittleEndian(legacy, &bytes);
  AppendText("", 4 * sizeof(uint32_t), &bytes);
  for (int i = 0; i < 3; ++i) AppendLittleEndian(kScale_m, &bytes);
  for (int i = 0; i < 3; ++i) AppendLittleEndian(0.0, &bytes);  // offset
  for (int i = 0; i < 3; ++i) {
    AppendLittleEndian(max_[i] * kScale_m, &bytes);
    AppendLittleEndian(min_[i] * kScale_m, &bytes);
  }
  if (is_14) {
    AppendText(
        "", 2 * sizeof(uint64_t) + sizeof(uint32_t), &bytes);  // no waves, no more records
    AppendLittleEndian(num_points_, &bytes);
    AppendLittleEndian(num_points_, &bytes);  // first returns
    AppendText("", 14 * sizeof(uint64_t), &bytes);
  }
  CHECK_EQ(bytes.size(), layout.header_bytes);
  return bytes + records;
}

void LasWriter::AppendPoint(const MapPoint& point) {
  Vector3i position;
  for (int i = 0; i < 3; ++i) {
    const double steps = std::round(static_cast<double>(point.p_world[i]) / kScale_m);
    if (!(std::abs(steps) <= std::numeric_limits<int32_t>::max())) {
      throw Error(name_ + ": can not be written: a coordinate of " +
                  std::to_string(point.p_world[i]) + " m is beyond LAS files in 0.1 mm");
    }
    position[i] = static_cast<int32_t>(steps);
    AppendLittleEndian(position[i], &records_);
  }
  min_ = num_points_ == 0 ? position : min_.cwiseMin(position);
  max_ = num_points_ == 0 ? position : max_.cwiseMax(position);
  ++num_points_;
  const uint8_t kind = point.plane_id >= 0 ? kBuilding : kUnclassified;
  const auto scanner = static_cast<uint8_t>(point.scanner);
  AppendLittleEndian<uint16_t>(0, &records_);  // intensity
  if (version_ == LasVersion::k14) {
    AppendLittleEndian(kFirstOfOneReturn, &records_);
    AppendLittleEndian<uint8_t>(0, &records_);  // flags
    AppendLittleEndian(kind, &records_);
    AppendLittleEndian(scanner, &records_);     // user data
    AppendLittleEndian<int16_t>(0, &records_);  // scan angle
    AppendLittleEndian<uint16_t>(0, &records_);
  } else {
    AppendLittleEndian(kFirstOfOneReturn12, &records_);
    AppendLittleEndian(kind, &records_);
    AppendLittleEndian<int8_t>(0, &records_);  // scan angle
    AppendLittleEndian(scanner, &records_);    // user data
    AppendLittleEndian(SourceId12(point.plane_id, name_), &records_);
  }
  AppendLittleEndian(point.time_s, &records_);
  for (const uint8_t channel : PointColour(point.plane_id)) {
    AppendLittleEndian(static_cast<uint16_t>(channel * 257), &records_);  // 16 bits
  }
  if (version_ == LasVersion::k14) {
    AppendLittleEndian(scanner, &records_);
    AppendLittleEndian(static_cast<int32_t>(point.plane_id), &records_);
    AppendLittleEndian(point.residual_m, &records_);
  }
}

void LasWriter::Add(const PointBuffer& points) {
  records_.clear();
  for (int64_t i = 0; i < points.num_points(); ++i) AppendPoint(points.At(i));
  if (version_ == LasVersion::k12 && num_points_ > std::numeric_limits<uint32_t>::max()) {
    throw Error(name_ + ": can not be written: LAS 1.2 holds 2^32 - 1 points; LAS 1.4 more");
  }
  file_.Append(records_.data(), records_.size());
}

void LasWriter::Finish() { file_.Finish(Header()); }

}  // namespace plumbline
