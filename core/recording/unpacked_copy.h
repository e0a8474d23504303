#pragma once

#include <string>

namespace plumbline {

// An unpacked copy of a packed file, among the temporary files, for as long as it lives. What
// is opened meanwhile stays readable.
class UnpackedCopy {
 public:
  // compression: "bz2" or "zstd". Throws Error that names the file when it is damaged, or
  // unpacks to more than any recording does; a file that breaks off is unpacked as far as it
  // goes, see problem().
  UnpackedCopy(const std::string& path, const std::string& compression);
  ~UnpackedCopy();
  UnpackedCopy(const UnpackedCopy&) = delete;
  UnpackedCopy& operator=(const UnpackedCopy&) = delete;

  const std::string& copy_path() const { return copy_path_; }
  // Why the copy is not whole; empty if it is.
  const std::string& problem() const { return problem_; }

 private:
  void Unpack(const std::string& path, const std::string& compression, int copy);

  std::string copy_path_;
  std::string problem_;
};

}  // namespace plumbline
