#include "core/following/checkpoint.h"

#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <vector>

#include "core/geometry/rigid3.h"
#include "core/map/binary_archive.h"
#include "core/util/atomic_file.h"
#include "core/util/error.h"

namespace plumbline {
namespace {

constexpr char kFormat[] = "plumbline checkpoint 2";

std::string ReadText(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

// Returns the state by which a file, or a folder of files, is recognised without reading it.
std::string StateOf(const std::string& path) {
  if (std::filesystem::is_directory(path)) {
    std::vector<std::string> states;
    for (const auto& entry : std::filesystem::directory_iterator(path)) {
      if (!entry.is_regular_file()) continue;
      states.push_back(entry.path().filename().string() + ": " +
                       StateOf(entry.path().string()));
    }
    std::sort(states.begin(), states.end());
    std::string text;
    for (const std::string& state : states) text += state + "; ";
    return text;
  }
  struct stat status = {};
  if (stat(path.c_str(), &status) != 0) {
    throw Error(path + ": can not be read: " + std::strerror(errno));
  }
  std::ostringstream text;
  text << status.st_size << " bytes, changed at " << status.st_mtim.tv_sec << "."
       << status.st_mtim.tv_nsec;
  return text.str();
}

void Visit(BinaryArchive* archive, MapInputs* inputs) {
  auto size = static_cast<int>(inputs->size());
  (*archive)(size);
  if (archive->is_reading()) inputs->resize(static_cast<size_t>(size > 0 ? size : 0));
  for (auto& [name, value] : *inputs) {
    (*archive)(name);
    (*archive)(value);
  }
}

void Visit(BinaryArchive* archive, FollowedPart* part) {
  auto& [state, scan_times_ns, window_estimates, start_s, end_s, ended_by] = *part;
  (*archive)(state);
  (*archive)(scan_times_ns);
  auto num_estimates = static_cast<int>(window_estimates.size());
  (*archive)(num_estimates);
  if (archive->is_reading()) window_estimates.resize(static_cast<size_t>(num_estimates));
  for (WindowEstimate& estimate : window_estimates) {
    auto& [newest_pose, pose_covariance, landmark_ids, landmark_covariance] = estimate;
    (*archive)(newest_pose.time_ns);
    (*archive)(newest_pose.world_from_body);
    (*archive)(pose_covariance);
    (*archive)(landmark_ids);
    (*archive)(landmark_covariance);
  }
  (*archive)(start_s);
  (*archive)(end_s);
  (*archive)(ended_by);
}

}  // namespace

MapInputs InputsOf(const std::string& recording,
                   const std::string& rig,
                   const std::string& options_yaml) {
  return {{"program", StateOf("/proc/self/exe")},
          {"recording", StateOf(recording)},
          {"rig file", ReadText(rig)},
          {"set of settings", options_yaml}};
}

void WriteCheckpoint(const MapInputs& inputs,
                     const std::string& path,
                     FollowedRecording* followed) {
  AtomicFile file(path);
  BinaryArchive archive(file.temporary_path(), BinaryArchive::Mode::kWrite);
  std::string format = kFormat;
  MapInputs all_inputs = inputs;
  archive(format);
  Visit(&archive, &all_inputs);
  archive(followed->num_skipped);
  archive(followed->left_out);
  auto num_parts = static_cast<int>(followed->parts.size());
  archive(num_parts);
  for (FollowedPart& part : followed->parts) Visit(&archive, &part);
  archive.Finish();
  file.Commit();
}

FollowedRecording ReadCheckpoint(const MapInputs& inputs, const std::string& path) {
  BinaryArchive archive(path, BinaryArchive::Mode::kRead);
  std::string format;
  MapInputs stored;
  archive(format);
  if (format != kFormat) throw Error(path + ": is no checkpoint of this program");
  Visit(&archive, &stored);
  for (size_t i = 0; i < inputs.size(); ++i) {
    if (i < stored.size() && stored[i] == inputs[i]) continue;
    throw Error(path + ": the run that was killed had another " + inputs[i].first +
                "; it can not be resumed");
  }
  FollowedRecording followed;
  archive(followed.num_skipped);
  archive(followed.left_out);
  int num_parts = 0;
  archive(num_parts);
  for (int i = 0; i < num_parts; ++i) {
    followed.parts.emplace_back(MapState{Trajectory(0, 1, Rigid3d()), {}, {}, 0});
    Visit(&archive, &followed.parts.back());
  }
  archive.Finish();
  if (followed.parts.empty()) throw Error(path + ": is damaged or incomplete");
  return followed;
}

}  // namespace plumbline
