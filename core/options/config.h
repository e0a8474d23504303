#pragma once

#include <string>

#include "core/options/mapper_options.h"

namespace plumbline {

// Reads the mapper's settings from a YAML file: either the settings themselves or a whole
// experiment, whose `mapper:` section counts. What the file does not name keeps the default
// that is given.
// Throws Error with file and line for unknown or duplicate keys and values out of range.
MapperOptions ReadMapperOptions(const std::string& path, const MapperOptions& defaults = {});

// Writes all settings in force as YAML that ReadMapperOptions understands.
std::string MapperOptionsToYaml(const MapperOptions& options);

}  // namespace plumbline
