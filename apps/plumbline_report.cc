// Writes a finished map as one page for a browser.

#include <gflags/gflags.h>

#include <cstdio>
#include <filesystem>
#include <string>

#include "apps/app.h"
#include "core/outputs/report.h"
#include "core/result/result_files.h"

DEFINE_string(result,
              "",
              "directory that plumbline_map wrote; may also stand alone, without the flag");
DEFINE_string(output, "", "HTML file; without it, report.html in the result's directory");
DEFINE_string(evaluation,
              "",
              "JSON file of plumbline_evaluate --output, whose errors the report is to show");
DEFINE_string(title, "", "title of the page; without it, the name of the result's directory");

namespace {

namespace fs = std::filesystem;

void Write(const plumbline::ReportJob& job) {
  const plumbline::ReportSize size = plumbline::WriteReport(job);
  std::printf("Report: %s (%lld points, %.1f MB)\n",
              job.output.c_str(),
              static_cast<long long>(size.points),
              static_cast<double>(size.bytes) * 1e-6);
}

// Writes the report of the result, and into the folders of its parts theirs, where no other
// place is asked for.
void WriteAll() {
  plumbline::ReportJob job;
  job.result_directory = FLAGS_result;
  job.output = FLAGS_output;
  job.title = FLAGS_title.empty() ? plumbline::ReportTitle(FLAGS_result) : FLAGS_title;
  job.evaluation = FLAGS_evaluation;
  if (job.output.empty()) job.output = (fs::path(FLAGS_result) / "report.html").string();
  Write(job);
  if (!FLAGS_output.empty()) return;
  for (const std::string& part : plumbline::PartsOf(FLAGS_result)) {
    plumbline::ReportJob of_part;
    of_part.result_directory = (fs::path(FLAGS_result) / part).string();
    of_part.output = of_part.result_directory + "/report.html";
    of_part.title = job.title + ", " + part;
    Write(of_part);
  }
}

}  // namespace

int main(int argc, char** argv) {
  return plumbline::RunApp(
      argc,
      argv,
      "writes a finished map as one page that opens in any browser, without network",
      __FILE__,
      {"result"},
      WriteAll,
      "result");
}
