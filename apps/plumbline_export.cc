// Writes the points of a finished map in other formats.

#include <gflags/gflags.h>

#include <cstdio>

#include "apps/app.h"
#include "apps/progress.h"
#include "core/result/cloud_export.h"

DEFINE_string(result,
              "",
              "directory that plumbline_map wrote, with map.ply in it; may also stand alone, "
              "without the flag");
DEFINE_string(
    formats,
    "",
    "in which the points are written: a list of ply, pcd, las (1.4), las12 (1.2) and "
    "e57");
DEFINE_validator(formats, [](const char*, const std::string& list) {
  return plumbline::IsCloudFormatList(list);
});
DEFINE_string(output, "", "directory for the files; without it, that of the result");

namespace {

void Export() {
  const std::string output = FLAGS_output.empty() ? FLAGS_result : FLAGS_output;
  const plumbline::CloudExport job = {
      FLAGS_result, plumbline::ParseCloudFormats(FLAGS_formats), output};
  plumbline::Progress progress("export");
  const auto num_points = static_cast<long long>(
      plumbline::RunCloudExport(job, [&progress](double share) { progress.Report(share); }));
  std::string files;
  for (const plumbline::CloudFormat format : job.formats) {
    files += (files.empty() ? "" : ", ") + plumbline::CloudFileName(format);
  }
  std::printf("%lld points written to %s: %s\n", num_points, output.c_str(), files.c_str());
}

}  // namespace

int main(int argc, char** argv) {
  return plumbline::RunApp(argc,
                           argv,
                           "writes the points of a map as PLY, PCD, LAS or E57",
                           __FILE__,
                           {"result", "formats"},
                           Export,
                           "result");
}
