#pragma once

#include <string>

#include "core/util/partial_files.h"

namespace plumbline {

// A file that appears under its name only when it is whole. It is written under a temporary
// name in the same directory; Commit() renames it, replacing an earlier file of that name.
// Without Commit() the temporary file is removed; that of a process that was killed is removed
// by the next AtomicFile of the same path.
class AtomicFile {
 public:
  // Creates the empty temporary file. Throws Error naming path.
  explicit AtomicFile(const std::string& path);
  ~AtomicFile();
  AtomicFile(AtomicFile&& other) noexcept;
  AtomicFile& operator=(AtomicFile&&) = delete;

  const std::string& path() const { return path_; }
  const std::string& temporary_path() const { return temporary_path_; }

  // Whoever writes the temporary file must have closed it. Throws Error naming path().
  void Commit();

 private:
  std::string path_;
  std::string temporary_path_;  // empty: nothing to remove
  OpenFile lock_;               // the temporary file
};

// Writes content to path by way of an AtomicFile. Throws Error naming the file.
void WriteFileAtomically(const std::string& path, const std::string& content);

// Writes content to path itself, which should be a temporary one. Throws Error that names
// `name`.
void WriteWholeFile(const std::string& path,
                    const std::string& content,
                    const std::string& name);

}  // namespace plumbline
