#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/util/partial_files.h"

namespace plumbline {

// The output directory of a run, which changes from the earlier result to the new one in one
// step (decision 055). The new result is written to a partial directory beside it,
//
//   .<output>.<random>.partial/lock   held by the process that writes
//   .<output>.<random>.partial/new/   the result
//   .<output>.<random>.partial/checkpoint.bin   where the run has written one
//
// and Commit() exchanges new/ with the output directory. What lies in that one and is no file of
// a result moves along into the new one. Without Commit() the partial directory is removed;
// that of a process that was killed is removed by the next run with the same output.
class ResultDirectory {
 public:
  // Throws Error where the directory can not be written to or exchanged, or where another
  // process writes a result for it. keep_checkpoint: that of a process that was killed is not
  // removed, but taken over, until there is a result.
  explicit ResultDirectory(const std::string& path, bool keep_checkpoint = false);
  ~ResultDirectory();
  ResultDirectory(const ResultDirectory&) = delete;
  ResultDirectory& operator=(const ResultDirectory&) = delete;

  // Returns the folder into which the files of the result are written, or of a part
  // (result_files.h), whose folder is created.
  std::string Folder(const std::string& part = "") const;
  // The name of that folder once it has been committed, for messages.
  std::string FinalName(const std::string& part = "") const;

  // The path for a checkpoint, and whether one has been taken over.
  std::string CheckpointPath() const;
  bool HasCheckpoint() const;

  // Bytes that the file system has free for the result.
  uintmax_t FreeSpace() const;

  // Everything must have been written and closed. Throws Error, and leaves the earlier result
  // in place, where the change is not possible.
  void Commit();

 private:
  void CreateParents();
  void RemoveLeftovers() const;
  void CreatePartial();
  void Discard();
  void CheckNamesAreFree(const std::filesystem::path& from,
                         const std::filesystem::path& to) const;

  std::string path_;              // as given
  std::filesystem::path target_;  // absolute, without links
  std::filesystem::path partial_;
  std::vector<std::filesystem::path> created_parents_;  // the outermost first
  bool keep_checkpoint_;
  OpenFile lock_;
  bool committed_ = false;
};

}  // namespace plumbline
