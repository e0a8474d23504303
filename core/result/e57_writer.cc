#include "core/result/e57_writer.h"

#include <glog/logging.h>

#include <cstdio>
#include <limits>

#include "core/result/little_endian.h"
#include "core/result/surface_colour.h"

namespace plumbline {
namespace {

constexpr size_t kFileHeaderBytes = 48;
constexpr size_t kSectionHeaderBytes = 32;
constexpr uint64_t kPageBytes = 1024;
// A packet holds at most 65536 bytes, and a point takes 40.
constexpr int64_t kMaxPointsInPacket = 1600;
constexpr size_t kNumFields = 12;

const char kPrototype[] =
    "<cartesianX type=\"Float\" precision=\"single\"/>\n"
    "<cartesianY type=\"Float\" precision=\"single\"/>\n"
    "<cartesianZ type=\"Float\" precision=\"single\"/>\n"
    "<timeStamp type=\"Float\"/>\n"
    "<colorRed type=\"Integer\" minimum=\"0\" maximum=\"255\"/>\n"
    "<colorGreen type=\"Integer\" minimum=\"0\" maximum=\"255\"/>\n"
    "<colorBlue type=\"Integer\" minimum=\"0\" maximum=\"255\"/>\n"
    "<nor:normalX type=\"Float\" precision=\"single\"/>\n"
    "<nor:normalY type=\"Float\" precision=\"single\"/>\n"
    "<nor:normalZ type=\"Float\" precision=\"single\"/>\n"
    "<plumbline:scanner type=\"Integer\" minimum=\"0\" maximum=\"255\"/>\n"
    "<plumbline:planeId type=\"Integer\" minimum=\"-2147483648\" maximum=\"2147483647\"/>\n";

// The shortest text that reads back as the same number.
std::string NumberText(float value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.9g", static_cast<double>(value));
  return text;
}

std::string TextElement(const std::string& name, const std::string& text) {
  return "<" + name + " type=\"String\"><![CDATA[" + text + "]]></" + name + ">\n";
}

std::string IntegerElement(const std::string& name, int value) {
  return "<" + name + " type=\"Integer\">" + std::to_string(value) + "</" + name + ">\n";
}

std::string BoundsElement(const Eigen::Vector3f& min, const Eigen::Vector3f& max) {
  std::string text = "<cartesianBounds type=\"Structure\">\n";
  for (int i = 0; i < 3; ++i) {
    const std::string axis(1, "xyz"[i]);
    text += "<" + axis + "Minimum type=\"Float\">" + NumberText(min[i]) + "</" + axis +
            "Minimum>\n<" + axis + "Maximum type=\"Float\">" + NumberText(max[i]) + "</" +
            axis + "Maximum>\n";
  }
  return text + "</cartesianBounds>\n";
}

std::string ColourLimitsElement() {
  std::string text = "<colorLimits type=\"Structure\">\n";
  for (const std::string colour : {"Red", "Green", "Blue"}) {
    text += IntegerElement("color" + colour + "Minimum", 0) +
            IntegerElement("color" + colour + "Maximum", 255);
  }
  return text + "</colorLimits>\n";
}

}  // namespace

E57Writer::E57Writer(const std::string& path, const std::string& name)
    : pages_(path, name), columns_(kNumFields) {
  pages_.Append(std::string(kFileHeaderBytes + kSectionHeaderBytes, '\0'));
}

void E57Writer::Add(const PointBuffer& points) {
  checksum_.Add(points.data(), points.num_bytes());
  for (int64_t i = 0; i < points.num_points(); ++i) {
    const MapPoint point = points.At(i);
    auto column = columns_.begin();
    for (int axis = 0; axis < 3; ++axis) AppendLittleEndian(point.p_world[axis], &*column++);
    AppendLittleEndian(point.time_s, &*column++);
    for (const uint8_t channel : PointColour(point.plane_id)) {
      AppendLittleEndian(channel, &*column++);
    }
    for (int axis = 0; axis < 3; ++axis) {
      AppendLittleEndian(point.normal_world[axis], &*column++);
    }
    // Integers are stored as what they exceed their minimum by.
    AppendLittleEndian(static_cast<uint8_t>(point.scanner), &*column++);
    AppendLittleEndian(
        static_cast<uint32_t>(int64_t{point.plane_id} - std::numeric_limits<int32_t>::min()),
        &*column++);
    min_ = num_points_ == 0 ? point.p_world : min_.cwiseMin(point.p_world);
    max_ = num_points_ == 0 ? point.p_world : max_.cwiseMax(point.p_world);
    ++num_points_;
    if (++num_in_packet_ == kMaxPointsInPacket) WritePacket();
  }
}

void E57Writer::WritePacket() {
  std::string lengths;
  std::string values;
  for (std::string& column : columns_) {
    AppendLittleEndian(static_cast<uint16_t>(column.size()), &lengths);
    values += column;
    column.clear();
  }
  constexpr size_t kHeaderBytes = 6;
  constexpr size_t kAlignment = 4;
  const size_t size = kHeaderBytes + lengths.size() + values.size();
  const size_t padding = (kAlignment - size % kAlignment) % kAlignment;
  CHECK_LE(size + padding, size_t{1} << 16);
  std::string header;
  AppendLittleEndian<uint8_t>(1, &header);  // a packet of data
  AppendLittleEndian<uint8_t>(0, &header);
  AppendLittleEndian(static_cast<uint16_t>(size + padding - 1), &header);
  AppendLittleEndian(static_cast<uint16_t>(columns_.size()), &header);
  pages_.Append(header + lengths + values + std::string(padding, '\0'));
  num_in_packet_ = 0;
}

std::string E57Writer::Guid(uint64_t salt) const {
  Checksum mixed = checksum_;
  mixed.Add(&salt, sizeof(salt));
  const uint64_t low = mixed.value();
  mixed.Add(&salt, sizeof(salt));
  const uint64_t high = mixed.value();
  char text[64];
  // Version 8 and variant 1 of RFC 9562: made from the content.
  std::snprintf(text,
                sizeof(text),
                "{%08x-%04x-8%03x-%04x-%012llx}",
                static_cast<unsigned>(high >> 32),
                static_cast<unsigned>((high >> 16) & 0xFFFF),
                static_cast<unsigned>(high & 0xFFF),
                static_cast<unsigned>(0x8000 | ((low >> 48) & 0x3FFF)),
                static_cast<unsigned long long>(low & 0xFFFFFFFFFFFF));
  return text;
}

std::string E57Writer::Xml() const {
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
         "<e57Root type=\"Structure\" xmlns=\"http://www.astm.org/COMMIT/E57/2010-e57-v1.0\" "
         "xmlns:nor=\"http://www.libe57.org/E57_NOR_surface_normals.txt\" "
         "xmlns:plumbline=\"urn:plumbline:map\">\n" +
         TextElement("formatName", "ASTM E57 3D Imaging Data File") +
         TextElement("guid", Guid(1)) + IntegerElement("versionMajor", 1) +
         IntegerElement("versionMinor", 0) + TextElement("e57LibraryVersion", "plumbline") +
         "<data3D type=\"Vector\" allowHeterogeneousChildren=\"1\">\n"
         "<vectorChild type=\"Structure\">\n" +
         TextElement("guid", Guid(2)) + TextElement("name", "map") +
         TextElement("description",
                     "plumbline model frame, metres; time in s since the first scan line") +
         BoundsElement(min_, max_) + ColourLimitsElement() +
         "<points type=\"CompressedVector\" fileOffset=\"" + std::to_string(kFileHeaderBytes) +
         "\" recordCount=\"" + std::to_string(num_points_) +
         "\">\n<prototype type=\"Structure\">\n" + kPrototype +
         "</prototype>\n<codecs type=\"Vector\" allowHeterogeneousChildren=\"1\">\n</codecs>\n"
         "</points>\n</vectorChild>\n</data3D>\n"
         "<images2D type=\"Vector\" allowHeterogeneousChildren=\"1\">\n</images2D>\n"
         "</e57Root>\n";
}

std::string E57Writer::Beginning(uint64_t xml_offset, uint64_t xml_bytes) const {
  std::string bytes = "ASTM-E57";
  AppendLittleEndian<uint32_t>(1, &bytes);  // version 1.0
  AppendLittleEndian<uint32_t>(0, &bytes);
  AppendLittleEndian(pages_.physical_size(), &bytes);
  AppendLittleEndian(E57Pages::PhysicalOffset(xml_offset), &bytes);
  AppendLittleEndian(xml_bytes, &bytes);
  AppendLittleEndian(kPageBytes, &bytes);
  CHECK_EQ(bytes.size(), kFileHeaderBytes);
  AppendLittleEndian<uint64_t>(1, &bytes);  // a compressed vector, and seven zeros
  AppendLittleEndian(section_end_ - kFileHeaderBytes, &bytes);
  AppendLittleEndian<uint64_t>(bytes.size() + 2 * sizeof(uint64_t), &bytes);  // first packet
  AppendLittleEndian<uint64_t>(0, &bytes);  // no index: readers go from packet to packet
  return bytes;
}

void E57Writer::Finish() {
  // Readers look for a packet even where there are no points.
  if (num_in_packet_ > 0 || num_points_ == 0) WritePacket();
  section_end_ = pages_.logical_size();
  const std::string xml = Xml();
  pages_.Append(xml);
  pages_.Finish(Beginning(section_end_, xml.size()));
}

}  // namespace plumbline
