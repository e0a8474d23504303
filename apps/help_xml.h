#pragma once

#include <string>
#include <vector>

namespace plumbline {

// Returns what --helpxml prints: purpose and flags of a program for other programs, in the XML
// of gflags' own --helpxml (of which man pages and completions are made). Only the flags that
// source_file defines; <required/> marks those that have to be given.
std::string HelpXml(const std::string& program,
                    const std::string& purpose,
                    const std::string& source_file,
                    const std::vector<std::string>& required_flags);

}  // namespace plumbline
