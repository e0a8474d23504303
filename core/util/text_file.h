#pragma once

#include <string>

namespace plumbline {

// Reads a whole file. Throws Error naming the file where it can not be read.
std::string ReadTextFile(const std::string& path);

}  // namespace plumbline
