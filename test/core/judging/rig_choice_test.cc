#include "core/judging/rig_choice.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "test/testing/temporary_directory.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

TEST(NameOfRecordingTest, IsWithoutFolderAndEndings) {
  EXPECT_EQ(NameOfRecording("/data/walk.bag.zstd"), "walk");
  EXPECT_EQ(NameOfRecording("walk.bag.active"), "walk");
  EXPECT_EQ(NameOfRecording("walk_0.db3"), "walk_0");
  EXPECT_EQ(NameOfRecording("data/walk/"), "walk");
  EXPECT_EQ(NameOfRecording("data/walk"), "walk");
  // Other dots belong to the name.
  EXPECT_EQ(NameOfRecording("2026.11.27.mcap"), "2026.11.27");
  EXPECT_EQ(NameOfRecording("intel.v2.log"), "intel.v2");
}

class RigChoiceTest : public TemporaryDirectoryTest {
 protected:
  std::string Make(const std::string& name, const std::string& text = "") {
    WriteBytes(directory_ / name, text);
    return (directory_ / name).string();
  }
};

TEST_F(RigChoiceTest, StatedOneIsTaken) {
  const RigChoice choice = ChooseRig("no/such/recording.bag", "my/rig.yaml");
  EXPECT_EQ(choice.path, "my/rig.yaml");
  EXPECT_EQ(choice.why, "");
}

TEST_F(RigChoiceTest, OneBesideTheRecordingIsTakenByItsOwnNameFirst) {
  const std::string recording = Make("walk.bag.bz2");
  const std::string common = Make("rig.yaml");
  EXPECT_EQ(ChooseRig(recording, "").path, common);
  EXPECT_EQ(ChooseRig(recording, "").why, "beside the recording");
  const std::string own = Make("walk_rig.yaml");
  EXPECT_EQ(ChooseRig(recording, "").path, own);
}

TEST_F(RigChoiceTest, FolderMayHoldItsRigFile) {
  fs::create_directory(directory_ / "walk");
  const std::string beside = Make("walk_rig.yaml");
  for (const char* slash : {"", "/"}) {
    const std::string recording = (directory_ / "walk").string() + slash;
    EXPECT_EQ(ChooseRig(recording, "").path, beside);
  }
  const std::string inside = Make("walk/rig.yaml");
  for (const char* slash : {"", "/"}) {
    EXPECT_EQ(ChooseRig((directory_ / "walk").string() + slash, "").path, inside);
  }
}

TEST_F(RigChoiceTest, RecordingThatIsNotThereIsNamed) {
  const std::string recording = (directory_ / "gone.bag").string();
  Make("rig.yaml");
  EXPECT_EQ(ErrorOf([&] { ChooseRig(recording, ""); }), recording + ": no such file");
}

// A log says nothing of where its scanner sits.
TEST_F(RigChoiceTest, WithoutRigFileOrTransformsItSaysWhatToDo) {
  std::string line = "FLASER 180";
  for (int i = 0; i < 180; ++i) line += " 2.0";
  std::string log;
  for (int i = 0; i < 20; ++i) {
    log += line + " 0 0 0 0 0 0 " + std::to_string(100 + i) + " host " + std::to_string(i) +
           ".0\n";
  }
  const std::string recording = Make("walk.log", log);
  const std::string error = ErrorOf([&] { ChooseRig(recording, ""); });
  EXPECT_THAT(error,
              HasSubstr(recording + ": no rig file is stated (--rig) or lies beside it"));
  EXPECT_THAT(error, HasSubstr((directory_ / "walk_rig.yaml").string()));
  EXPECT_THAT(error, HasSubstr("plumbline_check " + recording));
}

}  // namespace
}  // namespace plumbline
