#include "core/judging/check_job.h"

#include <filesystem>
#include <optional>
#include <system_error>

#include "core/judging/check.h"
#include "core/judging/check_picture.h"
#include "core/judging/check_text.h"
#include "core/judging/first_rig.h"
#include "core/util/atomic_file.h"
#include "core/util/error.h"

namespace plumbline {
namespace {

std::string OutputOf(const CheckJob& job) {
  if (!job.output.empty()) return job.output;
  std::filesystem::path recording(job.recording);
  if (!recording.has_filename()) recording = recording.parent_path();  // "folder/"
  return recording.filename().stem().string() + "_check";
}

void MakeDirectory(const std::string& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error) throw Error(path + ": can not be made: " + error.message());
}

}  // namespace

CheckOutcome RunCheckJob(const CheckJob& job) {
  std::optional<Rig> rig;
  if (!job.rig.empty()) rig = ReadRig(job.rig);
  const CheckReport report = CheckRecording(job.recording, rig);
  const std::string output = OutputOf(job);
  MakeDirectory(output);
  CheckOutcome outcome;
  outcome.is_mappable = report.mappable != Mappable::kNot;
  outcome.text = FormatCheckText(report);
  WriteFileAtomically(output + "/check.json", FormatCheckJson(report));
  WriteFileAtomically(output + "/check.svg", DrawCheck(report));
  outcome.text +=
      "\n  picture: " + output + "/check.svg, figures: " + output + "/check.json\n";
  if (!rig && !report.survey.topics.empty()) {
    WriteFileAtomically(output + "/rig.yaml", FormatFirstRig(report));
    outcome.text += (HasAllPoses(report) ? "  a rig file with what /tf_static says: "
                                         : "  a rig file to fill in: ") +
                    output + "/rig.yaml; then: plumbline_check " + job.recording +
                    " --rig=" + output + "/rig.yaml\n";
  }
  return outcome;
}

}  // namespace plumbline
