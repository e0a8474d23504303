#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace plumbline {

// The description of a program, besides its flags, which gflags knows.
struct Help {
  std::string program;
  std::string purpose;
  std::string source_file;                  // only the flags that it defines are ours
  std::vector<std::string> required_flags;  // those that have to be given
};

// Returns what --help prints, in lines of at most `width` characters, but for words that are
// longer.
std::string HelpText(const Help& help, size_t width);

// Returns what --helpxml prints: purpose and flags for other programs, as gflags' own
// --helpxml does; man pages and completions are made of it. <required/> marks flags that have
// to be given.
std::string HelpXml(const Help& help);

}  // namespace plumbline
