#include "test/testing/paths.h"

namespace plumbline {

std::string SourceDir() { return PLUMBLINE_SOURCE_DIR; }

std::string ConfigsDir() { return SourceDir() + "/configs"; }

std::string TestDataDir() { return SourceDir() + "/test/data"; }

std::string ProgramsDir() { return PLUMBLINE_PROGRAMS_DIR; }

}  // namespace plumbline
