#pragma once

#include <cstdint>
#include <string>

namespace plumbline {

// The input and output of a report.
struct ReportJob {
  std::string result_directory;  // of a finished result (docs/outputs.md)
  std::string output;            // the HTML file
  std::string title;             // of the page, the result's name
  std::string evaluation;  // JSON file of plumbline_evaluate, whose errors are shown; or empty

  int64_t max_points = 3'000'000;  // of more, an even selection is kept
  int64_t max_bytes = 20'000'000;  // of the file; points are left out until it is as small
};

// Size of the report that was written.
struct ReportSize {
  int64_t points = 0;  // of the map that are in the report
  int64_t bytes = 0;
};

// Returns what names the result in a directory: the directory's own name.
std::string ReportTitle(const std::string& result_directory);

// Writes one HTML file that shows the result in any browser, without network (docs/report.md).
// It appears whole or not at all, and is the same for the same result. Throws Error naming the
// file that can not be read or written.
ReportSize WriteReport(const ReportJob& job);

}  // namespace plumbline
