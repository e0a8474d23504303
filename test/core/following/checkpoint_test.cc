#include "core/following/checkpoint.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/following/scan_follower.h"
#include "test/testing/room_walk.h"
#include "test/testing/temporary_directory.h"

namespace plumbline {
namespace {

using ::testing::HasSubstr;

class CheckpointTest : public TemporaryDirectoryTest {
 protected:
  void SetUp() override {
    TemporaryDirectoryTest::SetUp();
    path_ = (directory_ / "checkpoint.bin").string();
    ASSERT_TRUE(follower_.Start(walk_.Take()));
    for (int i = 0; i < 10; ++i) follower_.Follow(walk_.Take());
    FollowedPart& part = followed_.parts.emplace_back(follower_.state());
    part.scan_times_ns = follower_.scan_times_ns();
    WindowEstimate& estimate = part.window_estimates.emplace_back();
    estimate.landmark_ids = {3, 5};
    estimate.landmark_covariance = Eigen::MatrixXd::Random(4, 4);
    part.end_s = 1.5;
    part.ended_by = "the rig was lost";
    followed_.num_skipped = 7;
    WriteCheckpoint(inputs_, path_, &followed_);
  }

  // The message of the error that reading gives; empty: none.
  std::string Failure(const MapInputs& inputs) const {
    try {
      ReadCheckpoint(inputs, path_);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }

  const MapInputs inputs_ = {{"recording", "5 bytes"}, {"rig file", "scanners: []"}};
  RoomWalk walk_{Eigen::Vector3d(0.4, -0.3, 0.0)};
  const MapperOptions options_;
  ScanFollower follower_{walk_.rig(), false, options_, RoomWalk::kPeriod};
  FollowedRecording followed_;
  std::string path_;
};

TEST_F(CheckpointTest, GivesBackWhatWasWritten) {
  FollowedRecording read = ReadCheckpoint(inputs_, path_);
  ASSERT_EQ(read.parts.size(), 1U);
  const FollowedPart& part = read.parts.front();
  const FollowedPart& written = followed_.parts.front();
  EXPECT_EQ(read.num_skipped, 7);
  EXPECT_EQ(part.ended_by, written.ended_by);
  EXPECT_EQ(part.end_s, written.end_s);
  EXPECT_EQ(part.scan_times_ns, written.scan_times_ns);
  ASSERT_EQ(part.window_estimates.size(), 1U);
  EXPECT_EQ(part.window_estimates[0].landmark_ids, written.window_estimates[0].landmark_ids);
  EXPECT_EQ(part.window_estimates[0].landmark_covariance,
            written.window_estimates[0].landmark_covariance);
  ASSERT_GT(written.state.observations.size(), 20U);
  ASSERT_EQ(part.state.observations.size(), written.state.observations.size());
  ASSERT_EQ(part.state.landmarks.size(), written.state.landmarks.size());
  for (size_t i = 0; i < part.state.observations.size(); ++i) {
    const Observation& a = part.state.observations[i];
    const Observation& b = written.state.observations[i];
    EXPECT_EQ(a.landmark_id, b.landmark_id);
    EXPECT_EQ(a.centroid(), b.centroid());
    EXPECT_EQ(a.middle_time_ns(), b.middle_time_ns());
  }
  const int64_t time_ns = written.scan_times_ns.back();
  EXPECT_EQ(part.state.trajectory.WorldFromBody(time_ns).translation,
            written.state.trajectory.WorldFromBody(time_ns).translation);
}

TEST_F(CheckpointTest, WrittenAgainItIsTheSameToTheBit) {
  FollowedRecording read = ReadCheckpoint(inputs_, path_);
  const std::string again = (directory_ / "again.bin").string();
  WriteCheckpoint(inputs_, again, &read);
  EXPECT_EQ(ReadBytes(again), ReadBytes(path_));
}

TEST_F(CheckpointTest, AnotherInputIsNamed) {
  MapInputs inputs = inputs_;
  inputs[1].second = "scanners: [one]";
  EXPECT_THAT(Failure(inputs), HasSubstr("had another rig file"));
  EXPECT_THAT(Failure(inputs), HasSubstr(path_));
  EXPECT_EQ(Failure(inputs_), "");
}

TEST_F(CheckpointTest, ATruncatedFileIsDamaged) {
  const std::string bytes = ReadBytes(path_);
  for (const size_t size :
       {size_t{0}, size_t{5}, size_t{8}, size_t{40}, bytes.size() / 2, bytes.size() - 1}) {
    WriteBytes(path_, bytes.substr(0, size));
    EXPECT_THAT(Failure(inputs_), HasSubstr("is damaged or incomplete")) << size;
  }
}

TEST_F(CheckpointTest, AChangedByteIsDamage) {
  const std::string bytes = ReadBytes(path_);
  for (size_t i = 0; i < bytes.size(); i += bytes.size() / 17) {
    std::string changed = bytes;
    changed[i] = static_cast<char>(changed[i] ^ 0x10);
    WriteBytes(path_, changed);
    EXPECT_THAT(Failure(inputs_), HasSubstr("is damaged or incomplete")) << i;
  }
}

TEST_F(CheckpointTest, AFullDiskLeavesNoFile) {
  const std::string other = (directory_ / "other.bin").string();
  const FileSizeLimit limit(1000);
  EXPECT_THROW(WriteCheckpoint(inputs_, other, &followed_), Error);
  EXPECT_FALSE(std::filesystem::exists(other));
}

}  // namespace
}  // namespace plumbline
