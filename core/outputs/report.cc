#include "core/outputs/report.h"

#include <filesystem>

#include "core/outputs/report_content.h"
#include "core/outputs/viewer_bundle.h"
#include "core/util/atomic_file.h"
#include "core/util/error.h"
#include "core/util/xml_text.h"

namespace plumbline {
namespace {

// Lets the page run what stands in it and show floor plans, and load nothing from anywhere.
const std::string kPolicy =
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; "
    "img-src blob: data:; base-uri 'none'; form-action 'none'";

// The page draws itself: its program stands before the points, so that the verdict shows while
// they are still read.
std::string BeforePoints(const std::string& title, const ReportContent& content) {
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
         "<meta http-equiv=\"Content-Security-Policy\" content=\"" +
         kPolicy +
         "\">\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
         "<meta name=\"generator\" content=\"plumbline\">\n<title>" +
         XmlEscaped(title) +
         "</title>\n</head>\n<body>\n<noscript>This report of a map is drawn by a script, "
         "which "
         "the browser does not run.</noscript>\n"
         "<script type=\"application/json\" id=\"report\">" +
         content.json + "</script>\n" + FormatSections(content.sections) + "<script>" +
         ViewerBundle() + "</script>\n";
}

std::string FormatPoints(const QuantisedPoints& points) {
  return "<script type=\"application/json\" id=\"points\">" + points.HeaderJson() +
         "</script>\n" + FormatSections(points.Sections()) + "</body>\n</html>\n";
}

}  // namespace

std::string ReportTitle(const std::string& result_directory) {
  const auto path = std::filesystem::absolute(result_directory).lexically_normal();
  // A path that ends with a slash has an empty last part.
  return (path.has_filename() ? path : path.parent_path()).filename().string();
}

ReportSize WriteReport(const ReportJob& job) {
  const ReportContent content = ReadReportContent(job);
  const std::string before = BeforePoints(job.title, content);
  const auto room = job.max_bytes - static_cast<int64_t>(before.size());
  QuantisedPoints points = content.points;
  std::string text = FormatPoints(points);
  while (static_cast<int64_t>(text.size()) > room) {
    if (room <= 0 || points.size() == 0) {
      throw Error(job.output + ": without any points, the report is larger than " +
                  std::to_string(job.max_bytes) + " bytes");
    }
    // A little fewer than fit at the same size each, as fewer are further apart.
    constexpr double kMargin = 0.97;
    const double share = static_cast<double>(room) / static_cast<double>(text.size());
    points = points.Selection(
        static_cast<int64_t>(kMargin * share * static_cast<double>(points.size())));
    text = FormatPoints(points);
  }
  WriteFileAtomically(job.output, before + text);
  return {points.size(), static_cast<int64_t>(before.size() + text.size())};
}

}  // namespace plumbline
