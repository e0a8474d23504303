#include "core/recording/rosbag2_folder.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "core/util/error.h"
#include "core/util/yaml_node.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

// Whether the name is that of a file of a recording that was split, packed or not.
bool IsRecordingName(fs::path name) {
  if (name.extension() == ".zstd" || name.extension() == ".bz2") name = name.stem();
  return name.extension() == ".mcap" || name.extension() == ".db3" ||
         name.extension() == ".bag";
}

// By their numbers: recording_2 comes before recording_10.
bool ComesBefore(const std::string& a, const std::string& b) {
  return a.size() != b.size() ? a.size() < b.size() : a < b;
}

std::vector<std::string> FilesInMetadata(const fs::path& folder, const fs::path& metadata) {
  std::vector<std::string> files;
  const YamlNode root = YamlNode::ReadFile(metadata.string());
  for (const YamlNode& name :
       root["rosbag2_bagfile_information"]["relative_file_paths"].Elements()) {
    // Older recorders put the folder's name before it, which need not be the same any more.
    files.push_back((folder / fs::path(name.AsString()).filename()).string());
  }
  return files;
}

}  // namespace

FolderFiles FilesOfFolder(const std::string& path) {
  const fs::path metadata = fs::path(path) / "metadata.yaml";
  FolderFiles found;
  std::vector<std::string> there;
  for (const auto& entry : fs::directory_iterator(path)) {
    if (entry.is_regular_file() && IsRecordingName(entry.path().filename())) {
      there.push_back(entry.path().string());
    }
  }
  std::sort(there.begin(), there.end(), ComesBefore);
  std::vector<std::string> named;
  if (fs::exists(metadata)) {
    try {
      named = FilesInMetadata(path, metadata);
    } catch (const Error& error) {
      found.warnings.push_back(std::string(error.what()) +
                               ": what it says of the files is not known; all are read");
    }
  }
  const auto is_there = [&there](const std::string& file) {
    return std::find(there.begin(), there.end(), file) != there.end();
  };
  // A file that has another name now, or that the recorder named and never wrote, is not
  // there: what is there tells then, in the order of its numbers.
  const bool all_there = std::all_of(
      named.begin(), named.end(), [](const std::string& file) { return fs::exists(file); });
  if (!named.empty() && (all_there || there.empty())) {
    found.files = named;
  } else {
    found.files = there;
    for (const std::string& file : named) {
      if (is_there(file)) continue;
      found.warnings.push_back(
          "metadata.yaml names " + fs::path(file).filename().string() +
          ", which is not in the folder; the files that are there are read");
    }
  }
  for (const std::string& file : there) {
    if (named.empty() || !all_there ||
        std::find(named.begin(), named.end(), file) != named.end()) {
      continue;
    }
    found.warnings.push_back("metadata.yaml does not name " +
                             fs::path(file).filename().string() +
                             ", which is in the folder; it is not read");
  }
  if (found.files.empty()) {
    throw Error(path +
                ": is a folder without a recording: neither a metadata.yaml that names "
                "files, nor files .mcap, .db3 or .bag");
  }
  return found;
}

Rosbag2Folder::Rosbag2Folder(const std::string& path,
                             std::vector<std::unique_ptr<MessageFile>> files)
    : path_(path), files_(std::move(files)) {}

std::string Rosbag2Folder::format() const {
  const std::string format = files_.front()->format();
  return (format == "ROS 1 bag" ? format : "rosbag2 recording, " + format) +
         (files_.size() == 1 ? "" : ", " + std::to_string(files_.size()) + " files");
}

void Rosbag2Folder::Scan(const Wants& wants, const Visit& visit) {
  for (const std::unique_ptr<MessageFile>& file : files_) {
    const auto first = static_cast<uint32_t>(topics_.size());
    first_topics_.push_back(first);
    const auto wants_topic = [&](const RecordingTopic& topic) {
      topics_.push_back(topic);
      return wants(topic);
    };
    const auto visit_message = [&](MessageRef message, ByteView data) {
      message.topic_index += first;
      return visit(message, data);
    };
    file->Scan(wants_topic, visit_message);
    std::copy(file->topics().begin(), file->topics().end(), topics_.begin() + first);
    const std::string name = fs::path(file->path()).filename().string();
    for (const std::string& warning : file->warnings()) {
      warnings_.push_back(files_.size() == 1 ? warning : name + ": " + warning);
    }
  }
}

ByteView Rosbag2Folder::Read(const MessageRef& message) {
  const auto next =
      std::upper_bound(first_topics_.begin(), first_topics_.end(), message.topic_index);
  const auto index = static_cast<size_t>(next - first_topics_.begin()) - 1;
  MessageRef in_file = message;
  in_file.topic_index -= first_topics_[index];
  return files_[index]->Read(in_file);
}

}  // namespace plumbline
