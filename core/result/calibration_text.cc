#include "core/result/calibration_text.h"

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace plumbline {
namespace {

std::string Joined(const std::vector<std::string>& texts) {
  std::string joined;
  for (const std::string& text : texts) joined += (joined.empty() ? "" : ", ") + text;
  return joined;
}

// The length of the vector that three parameters of a unit are, from this one on.
double Length(const CalibratedScanner& scanner, size_t first) {
  double squares = 0.0;
  for (size_t i = first; i < first + 3; ++i) {
    squares += scanner.parameters[i].value * scanner.parameters[i].value;
  }
  return std::sqrt(squares);
}

}  // namespace

std::vector<std::string> UnobservedInWords(const Calibration& calibration) {
  std::vector<std::string> words;
  for (const CalibratedScanner& scanner : calibration.scanners) {
    std::vector<std::string> of_scanner;
    for (const CalibratedParameter& parameter : scanner.parameters) {
      if (!parameter.IsHeld() && !parameter.IsObserved())
        of_scanner.push_back(parameter.words);
    }
    if (!of_scanner.empty())
      words.push_back(Joined(of_scanner) + " of scanner " + scanner.name);
  }
  return words;
}

std::string CalibrationLine(const Calibration& calibration) {
  std::vector<std::string> scanners;
  for (const CalibratedScanner& scanner : calibration.scanners) {
    char text[120];
    std::snprintf(text,
                  sizeof(text),
                  ": %.2f deg, %.1f mm, %.2f ms, ranges %.1f mm",
                  Length(scanner, CalibratedScanner::kTurn),
                  1e3 * Length(scanner, CalibratedScanner::kShift),
                  1e3 * scanner.parameters[CalibratedScanner::kTime].value,
                  1e3 * scanner.parameters[CalibratedScanner::kRange].value);
    scanners.push_back(scanner.name + text);
  }
  std::string line = "Scanners off the rig file by " + Joined(scanners);
  const std::vector<std::string> unobserved = UnobservedInWords(calibration);
  if (!unobserved.empty()) line += "; this recording does not show " + Joined(unobserved);
  return line;
}

std::string FormatCalibration(const Calibration& calibration) {
  nlohmann::ordered_json scanners = nlohmann::ordered_json::array();
  for (const CalibratedScanner& scanner : calibration.scanners) {
    nlohmann::ordered_json parameters = nlohmann::ordered_json::array();
    for (const CalibratedParameter& parameter : scanner.parameters) {
      parameters.push_back({{"name", parameter.name},
                            {"value", parameter.value},
                            {"sigma", parameter.sigma},
                            {"prior_sigma", parameter.prior_sigma},
                            {"observed", parameter.IsHeld() || parameter.IsObserved()}});
    }
    scanners.push_back({{"name", scanner.name}, {"parameters", parameters}});
  }
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (Eigen::Index i = 0; i < calibration.covariance.rows(); ++i) {
    const Eigen::VectorXd row = calibration.covariance.row(i);
    rows.push_back(std::vector<double>(row.begin(), row.end()));
  }
  const nlohmann::ordered_json json = {{"scanners", scanners},
                                       {"unobserved", UnobservedInWords(calibration)},
                                       {"covariance", rows}};
  return json.dump(1) + "\n";
}

}  // namespace plumbline
