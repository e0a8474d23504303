#pragma once

#include <string>

namespace plumbline {

// The rig file that a recording is mapped with.
struct RigChoice {
  std::string path;
  std::string why;  // in words; empty where it was stated
};

// Takes the rig file that is stated; else the one beside the recording: NAME_rig.yaml or
// rig.yaml in its folder (NAME: its name without endings), or in the folder that it is; else
// makes one, where /tf_static says where every scanner sits, and writes it as NAME_rig.yaml to
// the current directory. Throws Error where there is none, that says what to do.
RigChoice ChooseRig(const std::string& recording, const std::string& stated);

// The recording's name without its folder and its endings, such as "walk" of
// "/data/walk.bag.zstd".
std::string NameOfRecording(const std::string& recording);

}  // namespace plumbline
