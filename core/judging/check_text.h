#pragma once

#include <string>

#include "core/judging/check.h"

namespace plumbline {

// The text that plumbline_check prints: the verdict, a table of the topics, the findings in
// words.
std::string FormatCheckText(const CheckReport& report);

// check.json (docs/outputs.md). The same report gives the same bytes.
std::string FormatCheckJson(const CheckReport& report);

// "note", "warning" or "stop".
std::string NameOf(Severity severity);

}  // namespace plumbline
