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
//
// and Commit() exchanges new/ with the output directory. What lies in that one and is no file of
// a result moves along into the new one. Without Commit() the partial directory is removed;
// that of a process that was killed is removed by the next run with the same output.
class ResultDirectory {
 public:
  // Throws Error where the directory can not be written to or exchanged, or where another
  // process writes a result for it.
  explicit ResultDirectory(const std::string& path);
  ~ResultDirectory();
  ResultDirectory(const ResultDirectory&) = delete;
  ResultDirectory& operator=(const ResultDirectory&) = delete;

  // Where the files of the result are written, and of a part (result_files.h), whose folder is
  // created.
  std::string Folder(const std::string& part = "") const;
  // The name of that folder once it has been committed, for messages.
  std::string FinalName(const std::string& part = "") const;

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
  OpenFile lock_;
  bool committed_ = false;
};

}  // namespace plumbline
