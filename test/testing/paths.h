#pragma once

#include <string>

namespace plumbline {

/** Folder of the checkout that the tests were built from. Absolute, as all of these. */
std::string SourceDir();

/** Folder of the configurations that the product ships. */
std::string ConfigsDir();

/** Folder of the tests' own files. */
std::string TestDataDir();

/** Folder of the programs that were built with the tests. */
std::string ProgramsDir();

}  // namespace plumbline
