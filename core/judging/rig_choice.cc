#include "core/judging/rig_choice.h"

#include <filesystem>
#include <set>
#include <system_error>

#include "core/judging/check.h"
#include "core/judging/first_rig.h"
#include "core/util/atomic_file.h"
#include "core/util/error.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

fs::path WithoutSlash(const std::string& recording) {
  const fs::path path(recording);
  return path.has_filename() ? path : path.parent_path();  // "folder/"
}

}  // namespace

std::string NameOfRecording(const std::string& recording) {
  const std::set<std::string> endings = {
      ".bag", ".active", ".mcap", ".db3", ".clf", ".log", ".bz2", ".zstd", ".zst"};
  fs::path name = WithoutSlash(recording).filename();
  while (endings.count(name.extension().string()) > 0) name = name.stem();
  return name.string();
}

RigChoice ChooseRig(const std::string& recording, const std::string& stated) {
  if (!stated.empty()) return {stated, ""};
  std::error_code error;
  if (!fs::exists(recording, error)) throw Error(recording + ": no such file");
  const fs::path path = WithoutSlash(recording);
  const std::string name = NameOfRecording(recording) + "_rig.yaml";
  std::vector<fs::path> places = {path.parent_path() / name, path.parent_path() / "rig.yaml"};
  if (fs::is_directory(path, error)) places.insert(places.begin(), path / "rig.yaml");
  for (const fs::path& place : places) {
    if (fs::exists(place, error)) return {place.string(), "beside the recording"};
  }
  const CheckReport report = CheckRecording(recording, std::nullopt);
  if (!HasAllPoses(report)) {
    throw Error(recording + ": no rig file is stated (--rig) or lies beside it (" +
                places.front().string() +
                "), and no /tf_static says where its scanners sit; plumbline_check " +
                recording + " writes a first one to fill in");
  }
  if (fs::exists(name, error)) {
    throw Error(name + " is there already: state it with --rig, or remove it");
  }
  WriteFileAtomically(name, FormatFirstRig(report));
  return {name, "made of /tf_static, body " + report.survey.frames.body};
}

}  // namespace plumbline
