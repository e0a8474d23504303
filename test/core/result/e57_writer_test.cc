#include "core/result/e57_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "core/result/surface_colour.h"
#include "test/testing/e57_text.h"
#include "test/testing/known_points.h"
#include "test/testing/number_at.h"
#include "test/testing/temporary_directory.h"

namespace plumbline {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// An offset that counts the checksums, without them.
size_t Logical(uint64_t physical) {
  return static_cast<size_t>(physical / 1024 * 1020 + physical % 1024);
}

// A file as a reader of the standard takes it apart (ASTM E2807, sections 6 to 9).
struct E57Reader {
  explicit E57Reader(const std::string& file) : payload(PayloadOfE57(file)) {
    EXPECT_EQ(payload.substr(0, 8), "ASTM-E57");
    EXPECT_EQ(NumberAt<uint32_t>(payload, 8), 1u);
    EXPECT_EQ(NumberAt<uint32_t>(payload, 12), 0u);
    EXPECT_EQ(NumberAt<uint64_t>(payload, 16), file.size());
    EXPECT_EQ(NumberAt<uint64_t>(payload, 40), 1024u);
    xml = payload.substr(Logical(NumberAt<uint64_t>(payload, 24)),
                         static_cast<size_t>(NumberAt<uint64_t>(payload, 32)));
    const size_t section = 48;
    EXPECT_EQ(payload[section], 1);  // a compressed vector
    const size_t end = section + static_cast<size_t>(NumberAt<uint64_t>(payload, section + 8));
    size_t packet = Logical(NumberAt<uint64_t>(payload, section + 16));
    while (packet < end) packet = TakePacket(packet);
    EXPECT_EQ(packet, end);
  }

  size_t TakePacket(size_t packet) {
    EXPECT_EQ(payload[packet], 1);  // of data
    const size_t size = NumberAt<uint16_t>(payload, packet + 2) + size_t{1};
    EXPECT_EQ(size % 4, 0u);
    const size_t num_fields = NumberAt<uint16_t>(payload, packet + 4);
    columns.resize(num_fields);
    size_t at = packet + 6 + 2 * num_fields;
    for (size_t field = 0; field < num_fields; ++field) {
      const size_t length = NumberAt<uint16_t>(payload, packet + 6 + 2 * field);
      columns[field] += payload.substr(at, length);
      at += length;
    }
    EXPECT_LE(at, packet + size);
    ++num_packets;
    return packet + size;
  }

  std::string payload;
  std::string xml;
  std::vector<std::string> columns;
  int num_packets = 0;
};

class E57WriterTest : public TemporaryDirectoryTest {
 protected:
  std::string Write(const std::vector<PointBuffer>& parts) {
    const std::string path = (directory_ / "map.e57").string();
    E57Writer writer(path, "name");
    for (const PointBuffer& points : parts) writer.Add(points);
    writer.Finish();
    return ReadBytes(path);
  }
};

TEST_F(E57WriterTest, FieldsOfThePointsStandInPackets) {
  const E57Reader reader(Write({KnownPoints(0, 1000), KnownPoints(1000, 3500)}));
  EXPECT_EQ(reader.num_packets, 3);
  ASSERT_EQ(reader.columns.size(), 12u);
  ASSERT_EQ(reader.columns[0].size(), 3500 * sizeof(float));
  ASSERT_EQ(reader.columns[10].size(), 3500u);
  for (size_t i = 0; i < 3500; i += 57) {
    const MapPoint point = KnownPoint(static_cast<int>(i));
    for (size_t axis = 0; axis < 3; ++axis) {
      const auto row = static_cast<Eigen::Index>(axis);
      EXPECT_EQ(NumberAt<float>(reader.columns[axis], 4 * i), point.p_world[row]);
      EXPECT_EQ(NumberAt<float>(reader.columns[7 + axis], 4 * i), point.normal_world[row]);
      EXPECT_EQ(NumberAt<uint8_t>(reader.columns[4 + axis], i),
                PointColour(point.plane_id)[axis]);
    }
    EXPECT_EQ(NumberAt<double>(reader.columns[3], 8 * i), point.time_s);
    EXPECT_EQ(NumberAt<uint8_t>(reader.columns[10], i), point.scanner);
    // Integers stand as what they are above their minimum.
    EXPECT_EQ(NumberAt<uint32_t>(reader.columns[11], 4 * i) +
                  int64_t{std::numeric_limits<int32_t>::min()},
              point.plane_id);
  }
}

TEST_F(E57WriterTest, XmlStatesNumberAndBounds) {
  PointBuffer points;
  for (const Eigen::Vector3f& p :
       {Eigen::Vector3f(1.5f, -2.0f, 0.25f), Eigen::Vector3f(-0.5f, 3.0f, 0.125f)}) {
    MapPoint point;
    point.p_world = p;
    points.Add(point);
  }
  const E57Reader reader(Write({points}));
  EXPECT_THAT(reader.xml, HasSubstr("fileOffset=\"48\" recordCount=\"2\""));
  for (const char* bound : {"<xMinimum type=\"Float\">-0.5</",
                            "<xMaximum type=\"Float\">1.5</",
                            "<yMinimum type=\"Float\">-2</",
                            "<yMaximum type=\"Float\">3</",
                            "<zMinimum type=\"Float\">0.125</",
                            "<zMaximum type=\"Float\">0.25</"}) {
    EXPECT_THAT(reader.xml, HasSubstr(bound));
  }
}

TEST_F(E57WriterTest, MapWithoutPointsHasAPacket) {
  const E57Reader reader(Write({}));
  EXPECT_EQ(reader.num_packets, 1);
  EXPECT_THAT(reader.xml, HasSubstr("recordCount=\"0\""));
  EXPECT_THAT(reader.columns, testing::Each(""));
}

// Points name the file, not its place or the time.
TEST_F(E57WriterTest, GuidsAreThoseOfThePoints) {
  const std::string file = Write({KnownPoints(0, 100)});
  EXPECT_TRUE(file == Write({KnownPoints(0, 40), KnownPoints(40, 100)}));
  const auto guids_of = [](const std::string& xml) {
    std::vector<std::string> guids;
    for (size_t at = xml.find("[{"); at != std::string::npos; at = xml.find("[{", at + 1)) {
      guids.push_back(xml.substr(at + 1, 38));
    }
    return guids;
  };
  const std::vector<std::string> guids = guids_of(E57Reader(file).xml);
  const std::vector<std::string> others = guids_of(E57Reader(Write({KnownPoints(0, 99)})).xml);
  ASSERT_EQ(guids.size(), 2u);
  EXPECT_EQ(guids[0].back(), '}');
  EXPECT_EQ(guids[0][15], '8');  // the version
  EXPECT_NE(guids[0], guids[1]);
  EXPECT_NE(guids[0], others[0]);
}

}  // namespace
}  // namespace plumbline
