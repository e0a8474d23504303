#include "core/judging/check_text.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/geometry/angles.h"
#include "core/judging/words.h"
#include "core/util/one_line.h"

namespace plumbline {
namespace {

using Json = nlohmann::ordered_json;

constexpr size_t kTextWidth = 100;

std::string Padded(const std::string& text, size_t width) {
  return text.size() >= width ? text : text + std::string(width - text.size(), ' ');
}

std::string RateOf(const TopicSurvey& topic) {
  return topic.period_s > 0.0 ? Decimal(1.0 / topic.period_s, 1) + " Hz" : "-";
}

std::string AnglesOf(const TopicSurvey& topic) {
  const double last =
      topic.angle_min + std::max(0, topic.num_beams - 1) * topic.angle_increment;
  return Decimal(topic.angle_min * kDegreesPerRadian, 1) + " to " +
         Decimal(last * kDegreesPerRadian, 1) + " deg";
}

double ReturnShareOf(const TopicSurvey& topic) {
  return topic.num_ranges == 0
             ? 0.0
             : static_cast<double>(topic.num_returns) / static_cast<double>(topic.num_ranges);
}

std::string AttitudeName(Attitude attitude) {
  switch (attitude) {
    case Attitude::kLevel:
      return "level";
    case Attitude::kTilted:
      return "tilted";
    case Attitude::kNodding:
      return "nods";
    case Attitude::kUnknown:
      return "not shown";
  }
  return "";
}

std::string MappableName(Mappable mappable) {
  switch (mappable) {
    case Mappable::kNot:
      return "not";
    case Mappable::kInThePlane:
      return "in_the_plane";
    case Mappable::kInSpace:
      return "in_3d";
  }
  return "";
}

std::string TopicTable(const CheckReport& report) {
  std::vector<std::vector<std::string>> rows = {{"topic",
                                                 "lines",
                                                 "rate",
                                                 "beams",
                                                 "angles",
                                                 "returns",
                                                 "half within",
                                                 "noise",
                                                 "stands"}};
  for (size_t i = 0; i < report.survey.topics.size(); ++i) {
    const TopicSurvey& topic = report.survey.topics[i];
    const std::optional<Nod> nod = report.NodOf(i);
    rows.push_back({OnOneLine(topic.name),
                    std::to_string(topic.stamps.size()),
                    RateOf(topic),
                    std::to_string(topic.num_beams),
                    AnglesOf(topic),
                    PercentOf(ReturnShareOf(topic)),
                    Decimal(topic.RangeQuantile(0.5) * topic.metres_per_unit, 1) + " m",
                    Decimal(1e3 * topic.noise_m, 0) + " mm",
                    AttitudeName(report.attitudes[i].attitude) +
                        (nod ? ", " + Decimal(nod->period_s, 2) + " s" : "")});
  }
  std::vector<size_t> widths(rows.front().size(), 0);
  for (const auto& row : rows) {
    for (size_t k = 0; k < row.size(); ++k) widths[k] = std::max(widths[k], row[k].size());
  }
  std::string table;
  for (const auto& row : rows) {
    std::string line = " ";
    for (size_t k = 0; k < row.size(); ++k) line += " " + Padded(row[k], widths[k] + 1);
    table += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
  }
  return table;
}

std::string AgreementText(const CheckReport& report) {
  std::string text;
  for (const PairAgreement& pair : report.agreements) {
    const std::string names = OnOneLine(report.rig->scanners[pair.a].name + " and " +
                                        report.rig->scanners[pair.b].name);
    if (pair.num_compared == 0) {
      text += "  " + names + " see no place in common\n";
      continue;
    }
    text += "  " + names + " see " + std::to_string(pair.num_compared) +
            " places in common: half of them within " + Decimal(1e3 * pair.median_m, 0) +
            " mm, " + PercentOf(pair.near_share) + " within 100 mm\n";
  }
  for (size_t i = 0; i < report.heights.size(); ++i) {
    const HeightView& view = report.heights[i];
    if (!view.is_tilted) continue;
    text += "  " + OnOneLine(report.rig->scanners[i].name) + " sees ";
    text += view.floor.is_seen
                ? "the floor " + Decimal(-view.floor.height_m, 2) + " m below the body"
                : "no floor";
    text += view.ceiling.is_seen
                ? ", the ceiling " + Decimal(view.ceiling.height_m, 2) + " m above\n"
                : ", no ceiling\n";
  }
  if (report.starts.num_scans > 0) {
    text += "  " + std::to_string(report.starts.num_starts) + " of " +
            std::to_string(report.starts.num_scans) +
            " scans show all that a map starts from\n";
  }
  return text;
}

Json TopicJson(const TopicSurvey& topic,
               const OwnAttitude& attitude,
               const std::optional<Nod>& nod) {
  Json json;
  json["topic"] = topic.name;
  json["type"] = topic.type;
  json["scan_lines"] = topic.stamps.size();
  json["undecodable"] = topic.num_undecodable;
  json["unusable"] = topic.passed_over.unusable.count;
  json["rate_hz"] = topic.period_s > 0.0 ? 1.0 / topic.period_s : 0.0;
  json["duration_s"] = topic.duration_s();
  json["beams"] = topic.num_beams;
  json["angle_min_deg"] = topic.angle_min * kDegreesPerRadian;
  json["angle_increment_deg"] = topic.angle_increment * kDegreesPerRadian;
  json["time_increment_s"] = topic.time_increment_s;
  json["metres_per_unit"] = topic.metres_per_unit;
  json["returns"] = ReturnShareOf(topic);
  json["no_return"] = {{"nan", topic.num_nan},
                       {"infinite", topic.num_infinite},
                       {"zero", topic.num_zero},
                       {"too_near", topic.num_too_near},
                       {"too_far", topic.num_too_far},
                       {"at_limit", topic.num_at_limit}};
  json["median_range_m"] = topic.RangeQuantile(0.5) * topic.metres_per_unit;
  json["largest_range_m"] = topic.largest_range_m;
  json["noise_m"] = topic.noise_m;
  json["stands"] = AttitudeName(attitude.attitude);
  json["turns"] = attitude.num_turns;
  json["still_share"] = attitude.still_share;
  json["alike_share"] = attitude.alike_share;
  if (nod) {
    json["nod"] = {{"period_s", nod->period_s},
                   {"axis_deg", nod->axis_rad * kDegreesPerRadian},
                   {"changed_share", nod->changed_share},
                   {"returned_share", nod->returned_share}};
  }
  return json;
}

Json CorrectionJson(const std::string& name, const MountingCorrection& correction) {
  const auto list = [](const Eigen::Vector3d& v) { return Json{v.x(), v.y(), v.z()}; };
  return {{"scanner", name},
          {"places", correction.num_compared},
          {"turn_deg", list(correction.rotation_rad * kDegreesPerRadian)},
          {"shift_m", list(correction.translation_m)},
          {"time_offset_s", correction.time_offset_s},
          {"range_offset_m", correction.range_offset_m},
          {"near_share", correction.near_share},
          {"near_share_corrected", correction.moved_share}};
}

void AddRigJson(const CheckReport& report, Json* json) {
  (*json)["agreement"] = Json::array();
  for (const PairAgreement& pair : report.agreements) {
    (*json)["agreement"].push_back(
        {{"scanners", {report.rig->scanners[pair.a].name, report.rig->scanners[pair.b].name}},
         {"places", pair.num_compared},
         {"within_0_1_m", pair.near_share},
         {"median_m", pair.median_m}});
  }
  (*json)["corrections"] = Json::array();
  (*json)["heights"] = Json::array();
  for (size_t i = 0; i < report.rig->scanners.size(); ++i) {
    const std::string& name = report.rig->scanners[i].name;
    if (report.corrections[i].num_compared > 0) {
      (*json)["corrections"].push_back(CorrectionJson(name, report.corrections[i]));
    }
    const HeightView& view = report.heights[i];
    if (!view.is_tilted) continue;
    Json height = {{"scanner", name}};
    height["floor_m"] = view.floor.is_seen ? Json(view.floor.height_m) : Json();
    height["ceiling_m"] = view.ceiling.is_seen ? Json(view.ceiling.height_m) : Json();
    (*json)["heights"].push_back(height);
  }
  (*json)["starts"] = {{"scans", report.starts.num_scans},
                       {"starts", report.starts.num_starts}};
}

}  // namespace

std::string NameOf(Severity severity) {
  switch (severity) {
    case Severity::kNote:
      return "note";
    case Severity::kWarning:
      return "warning";
    case Severity::kStop:
      return "stop";
  }
  return "";
}

std::string FormatCheckText(const CheckReport& report) {
  std::string text = OnOneLine(report.survey.path) + " " + report.verdict + ".\n\n";
  text += "  " + report.survey.format + ", " + Decimal(report.survey.duration_s(), 1) +
          " s, " + std::to_string(report.survey.topics.size()) + " topics with scan lines\n";
  if (!report.survey.topics.empty()) text += TopicTable(report);
  if (report.rig) text += "\n" + AgreementText(report);
  if (!report.findings.empty()) text += "\n";
  for (const Finding& finding : report.findings) {
    const std::string subject = finding.subject.empty() ? "" : finding.subject + ": ";
    text += Wrapped(OnOneLine(subject + finding.sentence),
                    "  " + Padded(NameOf(finding.severity), 9),
                    std::string(11, ' '),
                    kTextWidth);
    if (finding.advice.empty()) continue;
    text += Wrapped(OnOneLine(finding.advice),
                    std::string(11, ' ') + "-> ",
                    std::string(14, ' '),
                    kTextWidth);
  }
  if (report.findings.empty()) text += "\n  nothing to complain of\n";
  return text;
}

std::string FormatCheckJson(const CheckReport& report) {
  Json json;
  json["recording"] = report.survey.path;
  json["format"] = report.survey.format;
  json["mappable"] = MappableName(report.mappable);
  json["verdict"] = report.verdict;
  json["duration_s"] = report.survey.duration_s();
  json["topics"] = Json::array();
  for (size_t i = 0; i < report.survey.topics.size(); ++i) {
    json["topics"].push_back(
        TopicJson(report.survey.topics[i], report.attitudes[i], report.NodOf(i)));
  }
  json["other_topics"] = report.survey.other_topics;
  if (report.rig) AddRigJson(report, &json);
  json["findings"] = Json::array();
  for (const Finding& finding : report.findings) {
    json["findings"].push_back({{"severity", NameOf(finding.severity)},
                                {"subject", finding.subject},
                                {"sentence", finding.sentence},
                                {"advice", finding.advice}});
  }
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace plumbline
