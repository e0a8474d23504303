// Of whole maps: following/checkpoint_test.cc.

#include "core/map/binary_archive.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "test/testing/temporary_directory.h"

namespace plumbline {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class BinaryArchiveTest : public TemporaryDirectoryTest {
 protected:
  std::string path() const { return (directory_ / "archive").string(); }

  template <typename... Values>
  void Write(Values... values) {
    BinaryArchive archive(path(), BinaryArchive::Mode::kWrite);
    EXPECT_FALSE(archive.is_reading());
    (archive(values), ...);
    archive.Finish();
  }
  template <typename... Values>
  void Read(Values&... values) {
    BinaryArchive archive(path(), BinaryArchive::Mode::kRead);
    EXPECT_TRUE(archive.is_reading());
    (archive(values), ...);
    archive.Finish();
  }
  std::string Damaged() const { return path() + ": is damaged or incomplete"; }
};

TEST_F(BinaryArchiveTest, ValuesComeBackBitByBit) {
  Write(0.1, int64_t{-7}, true, std::string("a\0b", 3), std::array<int, 2>{3, 4});
  double number = 0.0;
  int64_t integer = 0;
  bool flag = false;
  std::string text = "what was before";
  std::array<int, 2> pair = {};
  Read(number, integer, flag, text, pair);
  EXPECT_EQ(number, 0.1);
  EXPECT_EQ(integer, -7);
  EXPECT_TRUE(flag);
  EXPECT_EQ(text, std::string("a\0b", 3));
  EXPECT_THAT(pair, ElementsAre(3, 4));
}

TEST_F(BinaryArchiveTest, ContainersAndMatricesTakeTheSizesOfTheFile) {
  const Eigen::MatrixXd matrix = Eigen::MatrixXd::Random(3, 5);
  Write(std::vector<float>{1.5f, 2.5f},
        std::deque<std::string>{"a", "", "bc"},
        CompactArray<int>(std::vector<int>{7, 8, 9}),
        matrix,
        Eigen::MatrixXd(0, 4));
  std::vector<float> floats(17, 0.0f);
  std::deque<std::string> texts;
  CompactArray<int> array;
  Eigen::MatrixXd read, empty;
  Read(floats, texts, array, read, empty);
  EXPECT_THAT(floats, ElementsAre(1.5f, 2.5f));
  EXPECT_THAT(texts, ElementsAre("a", "", "bc"));
  EXPECT_THAT(std::vector<int>(array.begin(), array.end()), ElementsAre(7, 8, 9));
  EXPECT_EQ(read, matrix);
  EXPECT_EQ(empty.rows(), 0);
  EXPECT_EQ(empty.cols(), 4);
}

TEST_F(BinaryArchiveTest, MapComesBack) {
  MapState state{Trajectory(1000, 50, Rigid3d()), {}, {}, 1025};
  state.trajectory.ExtendTo(1300);
  state.trajectory.control_point(3).position = {0.1, 0.2, 0.3};
  state.landmarks.push_back(MakeVerticalLandmark({0.6, 0.8, 0.0}, {2.0, 1.0, 0.5}));
  state.landmarks[0].id = 4;
  state.landmarks[0].num_segments = 11;
  Observation& observation = state.observations.emplace_back();
  observation.landmark_id = 4;
  observation.sigma_offset_m = 0.25f;
  observation.excluded_beams = CompactArray<int>(std::vector<int>{5});
  state.gaps.push_back({1100, 1200, "nothing was seen"});
  state.moving_beams.push_back({3, 10, 20});
  state.calibration.scanners.resize(1);
  state.calibration.scanners[0].block[2] = 0.125;
  state.calibration.imu.emplace();
  state.calibration.imu->biases.resize(2);
  state.calibration.imu->biases[1].gyroscope[0] = 0.5;
  Write(state);
  MapState read{Trajectory(0, 1, Rigid3d()), {}, {}, 0};
  Read(read);
  EXPECT_EQ(read.trajectory.start_ns(), 1000);
  EXPECT_EQ(read.trajectory.end_ns(), state.trajectory.end_ns());
  EXPECT_THAT(read.trajectory.control_point(3).position, ElementsAre(0.1, 0.2, 0.3));
  EXPECT_EQ(read.origin_time_ns, 1025);
  ASSERT_EQ(read.landmarks.size(), 1u);
  EXPECT_EQ(read.landmarks[0].id, 4);
  EXPECT_EQ(read.landmarks[0].num_segments, 11);
  EXPECT_EQ(read.landmarks[0].model, PlaneModel::kVertical);
  EXPECT_EQ(read.landmarks[0].parameters, state.landmarks[0].parameters);
  ASSERT_EQ(read.observations.size(), 1u);
  EXPECT_EQ(read.observations[0].landmark_id, 4);
  EXPECT_EQ(read.observations[0].sigma_offset_m, 0.25f);
  EXPECT_EQ(read.observations[0].excluded_beams.size(), 1u);
  ASSERT_EQ(read.gaps.size(), 1u);
  EXPECT_EQ(read.gaps[0].reason, "nothing was seen");
  EXPECT_EQ(read.moving_beams[0].last_beam, 20);
  EXPECT_EQ(read.calibration.scanners[0].block[2], 0.125);
  ASSERT_TRUE(read.calibration.imu);
  EXPECT_EQ(read.calibration.imu->biases[1].gyroscope[0], 0.5);
  // What was read is written to the same bytes.
  const std::string bytes = ReadBytes(path());
  Write(read);
  EXPECT_TRUE(ReadBytes(path()) == bytes);
}

TEST_F(BinaryArchiveTest, AnyDamageIsAnErrorBeforeAnythingIsRead) {
  Write(std::vector<double>{1.0, 2.0}, std::string("text"));
  const std::string whole = ReadBytes(path());
  std::vector<double> numbers;
  std::string text;
  for (size_t i = 0; i < whole.size(); ++i) {
    std::string damaged = whole;
    damaged[i] ^= '\x10';
    WriteBytes(path(), damaged);
    EXPECT_EQ(ErrorOf([&] { Read(numbers, text); }), Damaged()) << i;
    WriteBytes(path(), whole.substr(0, i));
    EXPECT_EQ(ErrorOf([&] { Read(numbers, text); }), Damaged()) << i;
  }
  EXPECT_TRUE(numbers.empty());
}

// The checksum of such files is right: another version wrote other values.
TEST_F(BinaryArchiveTest, ValuesThatDoNotFitTheFileAreAnError) {
  Write(int64_t{1});
  int64_t one = 0, two = 0;
  EXPECT_EQ(ErrorOf([&] { Read(one, two); }), Damaged());
  int32_t half = 0;
  EXPECT_EQ(ErrorOf([&] { Read(half); }), Damaged());  // something is left
}

TEST_F(BinaryArchiveTest, SizesThatLieCostNoMemory) {
  for (const int64_t size :
       {int64_t{-1}, int64_t{1} << 40, int64_t{5}, std::numeric_limits<int64_t>::max()}) {
    Write(size, int32_t{0});
    std::vector<double> numbers;
    EXPECT_EQ(ErrorOf([&] { Read(numbers); }), Damaged()) << size;
    std::string text;
    EXPECT_EQ(ErrorOf([&] { Read(text); }), Damaged()) << size;
    std::deque<std::string> texts;
    EXPECT_EQ(ErrorOf([&] { Read(texts); }), Damaged()) << size;
    Write(size, int64_t{1} << 40);
    Eigen::MatrixXd matrix;
    EXPECT_EQ(ErrorOf([&] { Read(matrix); }), Damaged()) << size;
  }
}

TEST_F(BinaryArchiveTest, FilesThatCanNotBeOpenedOrWrittenAreNamed) {
  double number = 0.0;
  EXPECT_THAT(ErrorOf([&] { Read(number); }),
              HasSubstr(path() + ": can not be read: No such file"));
  const std::string elsewhere = (directory_ / "no" / "archive").string();
  EXPECT_THAT(ErrorOf([&] { BinaryArchive(elsewhere, BinaryArchive::Mode::kWrite); }),
              HasSubstr(elsewhere + ": can not be written: No such file"));
  EXPECT_THAT(ErrorOf([&] {
                const FileSizeLimit limit(1000);
                Write(std::vector<double>(1'000'000, 1.0));
              }),
              HasSubstr(path() + ": can not be written: "));
}

}  // namespace
}  // namespace plumbline
