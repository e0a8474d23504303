#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/recording/byte_source.h"
#include "core/recording/carmen_file.h"
#include "core/recording/mcap_file.h"
#include "core/recording/recording_source.h"
#include "core/recording/ros1_file.h"
#include "core/recording/rosbag2_folder.h"
#include "core/recording/sqlite_file.h"
#include "core/recording/unpacked_copy.h"
#include "core/util/error.h"

namespace plumbline {
namespace {

constexpr size_t kHeadBytes = 4096;

// Kinds of files that a user may take for a recording, by their first bytes.
struct Look {
  std::string_view bytes;
  const char* text;
};
constexpr Look kLooks[] = {
    {"#ROSBAG V", "a ROS 1 bag of a version other than 2.0; 'rosbag fix' makes one of it"},
    {"#ROSRECORD", "a ROS 1 bag of version 1.1; 'rosbag fix' makes one of it"},
    {{"\x1f\x8b", 2}, "a gzip file; unpack it first"},
    {{"\xfd"
      "7zXZ",
      5},
     "an xz file; unpack it first"},
    {{"PK\3\4", 4}, "a zip archive; unpack it first"},
    {{"\xd4\xc3\xb2\xa1", 4}, "a network capture (pcap)"},
    {{"\xa1\xb2\xc3\xd4", 4}, "a network capture (pcap)"},
    {{"\x0a\x0d\x0d\x0a", 4}, "a network capture (pcapng)"},
    {"ply\n", "a point cloud (PLY), not a recording"},
    {"ply\r\n", "a point cloud (PLY), not a recording"},
    {"# .PCD", "a point cloud (PCD), not a recording"},
    {"LASF", "a point cloud (LAS), not a recording"},
    {"ASTM-E57", "a point cloud (E57), not a recording"},
    {{"\x89HDF", 4}, "an HDF5 file"},
    {{"\x7f"
      "ELF",
      4},
     "a program"},
    {"rosbag2_bagfile_information", "the metadata of a ROS 2 recording; name its folder"},
};

bool BeginsWith(std::string_view text, std::string_view beginning) {
  return text.substr(0, beginning.size()) == beginning;
}

// Whether a line is one of a CARMEN log: a word in capitals, and an end of times.
bool IsCarmenLine(std::string_view line) {
  constexpr std::string_view kWords[] = {"PARAM",
                                         "SYNC",
                                         "ODOM",
                                         "FLASER",
                                         "RLASER",
                                         "RAWLASER",
                                         "ROBOTLASER",
                                         "TRUEPOS",
                                         "GPS",
                                         "IMU",
                                         "SONAR",
                                         "BUMPER",
                                         "LASER",
                                         "NMEA",
                                         "MARKER"};
  return std::any_of(std::begin(kWords), std::end(kWords), [&](std::string_view word) {
    return BeginsWith(line, word) && line.size() > word.size() + 1 &&
           line.find(' ') != std::string_view::npos;
  });
}

// Comments and empty lines may come first; of a log that begins with more comments than
// are looked at, these tell.
bool LooksLikeCarmen(std::string_view head) {
  if (head.find('\0') != std::string_view::npos) return false;
  while (!head.empty()) {
    const size_t end = std::min(head.find('\n'), head.size());
    const std::string_view line = head.substr(0, end);
    if (!line.empty() && line.front() != '#' && line.front() != '\r') {
      return IsCarmenLine(line);
    }
    if (BeginsWith(line, "# message_name [message contents]")) return true;
    head.remove_prefix(std::min(end + 1, head.size()));
  }
  return false;
}

std::string LookOf(std::string_view head) {
  if (head.empty()) return "an empty file";
  for (const Look& look : kLooks) {
    if (BeginsWith(head, look.bytes)) return look.text;
  }
  constexpr std::string_view kLayout = "\t\n\r\f";
  const bool is_text = std::none_of(head.begin(), head.end(), [&](char c) {
    return static_cast<unsigned char>(c) < ' ' && kLayout.find(c) == std::string_view::npos;
  });
  if (!is_text) return "a file of an unknown kind";
  const std::string_view line = head.substr(0, std::min(head.find('\n'), size_t{40}));
  return "a text that begins with '" + std::string(line) + "'";
}

// A file and what has been noticed of it.
struct OpenedFile {
  std::unique_ptr<MessageFile> file;
  std::vector<std::string> warnings;
};

// Opens one file. path: what the user knows it by; file_path: where it is.
OpenedFile OpenFile(const std::string& path,
                    const std::string& file_path,
                    bool may_be_packed) {
  auto file = std::make_unique<InputFile>(file_path, path);
  std::string head(static_cast<size_t>(std::min<uint64_t>(file->size(), kHeadBytes)), '\0');
  file->Read(0, head.size(), reinterpret_cast<uint8_t*>(head.data()));
  if (BeginsWith(head, "#ROSBAG V2.0\n")) {
    return {std::make_unique<Ros1File>(path, file_path), {}};
  }
  if (BeginsWith(head, {reinterpret_cast<const char*>(kMcapMagic), sizeof(kMcapMagic)})) {
    return {std::make_unique<McapFile>(std::move(file)), {}};
  }
  if (BeginsWith(head, {"SQLite format 3\0", 16})) {
    return {std::make_unique<SqliteFile>(path, file_path), {}};
  }
  if (LooksLikeCarmen(head)) return {std::make_unique<CarmenFile>(std::move(file)), {}};
  const bool is_bz2 = BeginsWith(head, "BZh");
  if (may_be_packed && (is_bz2 || BeginsWith(head, "\x28\xb5\x2f\xfd"))) {
    const UnpackedCopy copy(path, is_bz2 ? "bz2" : "zstd");
    OpenedFile opened = OpenFile(path, copy.copy_path(), false);
    if (!copy.problem().empty()) {
      opened.warnings.push_back("the file can not be unpacked whole, since " + copy.problem());
    }
    return opened;
  }
  throw Error(path + ": is no recording that can be read, but " + LookOf(head) +
              "; what can be read: " + kRecordingFormats);
}

// Opens a folder of files. What can not be opened of it is passed over, unless nothing can.
std::unique_ptr<RecordingSource> OpenFolder(const std::string& path) {
  std::vector<std::unique_ptr<MessageFile>> files;
  const FolderFiles folder = FilesOfFolder(path);
  std::vector<std::string> warnings = folder.warnings;
  std::string first_error;
  for (const std::string& file_path : folder.files) {
    try {
      OpenedFile opened = OpenFile(file_path, file_path, true);
      files.push_back(std::move(opened.file));
      const std::string name = std::filesystem::path(file_path).filename().string();
      for (const std::string& warning : opened.warnings) {
        warnings.push_back(name + ": " + warning);
      }
    } catch (const Error& error) {
      if (first_error.empty()) first_error = error.what();
      warnings.push_back(std::string("a file of the recording was passed over: ") +
                         error.what());
    }
  }
  if (files.empty()) throw Error(first_error);
  return std::make_unique<RecordingSource>(
      std::make_unique<Rosbag2Folder>(path, std::move(files)), std::move(warnings));
}

}  // namespace

std::unique_ptr<RecordingSource> OpenRecording(const std::string& path) {
  if (std::filesystem::is_directory(path)) return OpenFolder(path);
  OpenedFile opened = OpenFile(path, path, true);
  return std::make_unique<RecordingSource>(std::move(opened.file), std::move(opened.warnings));
}

}  // namespace plumbline
