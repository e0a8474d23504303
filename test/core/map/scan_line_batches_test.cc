#include "core/map/scan_line_batches.h"

#include <gtest/gtest.h>

#include "simulation/sensing/recording_writer.h"
#include "test/testing/temporary_directory.h"

namespace plumbline {
namespace {

class LineBlocksTest : public TemporaryDirectoryTest {
 protected:
  static constexpr int64_t kStart = 1'600'000'000'000'000'000;

  void SetUp() override {
    TemporaryDirectoryTest::SetUp();
    rig_.scanners.resize(1);
    rig_.scanners[0].name = "scanner";
    rig_.scanners[0].topic = "/scan";
  }

  // Scan lines whose first range tells their position in the recording.
  std::string Record(int num_lines) {
    const std::string path = (directory_ / "recording.bag").string();
    RecordingWriter writer(path, rig_);
    for (int i = 0; i < num_lines; ++i) {
      ScanLine line;
      line.stamp_ns = kStart + i * 25'000'000;
      line.angle_increment = 0.25;
      line.ranges = {1.0f + static_cast<float>(i), 1.0f};
      writer.Write(line);
    }
    writer.Close();
    return path;
  }

  static std::deque<Observation> OnLines(const std::vector<int>& indices) {
    std::deque<Observation> observations(indices.size());
    for (size_t i = 0; i < indices.size(); ++i) observations[i].scan_line_index = indices[i];
    return observations;
  }

  Rig rig_;
  MapState state_{Trajectory(kStart, 100'000'000, {}), {}, {}, 0, {}};
};

TEST_F(LineBlocksTest, EveryLineComesOnceWithWhatTheMapHoldsOfIt) {
  constexpr int kNumLines = 21;
  const std::vector<int> of_observations = {0, 0, 3, 7, 8, 8, 8, 20};
  const std::vector<int> of_runs = {3, 9, 9};
  state_.observations = OnLines(of_observations);
  state_.sub_minimum_segments = OnLines(of_runs);
  RecordingReader recording(Record(kNumLines), rig_);
  ScanLine skipped;
  recording.Next(&skipped);  // a pass begins at the beginning
  ScanLineBatchReader reader(&recording, state_);
  ScanLineBatch block;
  int index = 0;
  std::vector<int> observations;
  std::vector<int> runs;
  while (reader.Next(&block)) {
    for (const ScanLineBatch::Line& line : block.lines) {
      EXPECT_EQ(line.scan_line.ranges[0], 1.0f + static_cast<float>(index));
      EXPECT_EQ(line.first_observation, observations.size());
      while (observations.size() < line.last_observation) observations.push_back(index);
      EXPECT_EQ(line.first_run, runs.size());
      while (runs.size() < line.last_run) runs.push_back(index);
      ++index;
    }
    EXPECT_EQ(block.end_index, index);
  }
  EXPECT_EQ(index, kNumLines);
  EXPECT_EQ(observations, of_observations);
  EXPECT_EQ(runs, of_runs);
  EXPECT_FALSE(reader.Next(&block)) << "the end stays the end";
}

TEST_F(LineBlocksTest, ObservationsOutOfOrderAreNotPassedOver) {
  state_.observations = OnLines({3, 1});
  RecordingReader recording(Record(5), rig_);
  ScanLineBatchReader reader(&recording, state_);
  ScanLineBatch block;
  EXPECT_DEATH(while (reader.Next(&block)){}, "observations out of order");
}

}  // namespace
}  // namespace plumbline
