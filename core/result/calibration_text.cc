#include "core/result/calibration_text.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
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

// The parameters that are not held, in the covariance's order.
std::vector<const CalibratedParameter*> FreeParameters(const Calibration& calibration) {
  std::vector<const CalibratedParameter*> free;
  for (const CalibratedScanner& scanner : calibration.scanners) {
    for (const CalibratedParameter& parameter : scanner.parameters) {
      if (!parameter.IsHeld()) free.push_back(&parameter);
    }
  }
  return free;
}

// The share of each parameter that lies in open directions, 0 to 1.
Eigen::VectorXd OpenShares(const Eigen::MatrixXd& covariance,
                           const std::vector<const CalibratedParameter*>& free) {
  if (free.empty()) return {};
  Eigen::VectorXd information(covariance.rows());  // square root of the prior's
  for (Eigen::Index i = 0; i < information.size(); ++i) {
    information[i] = 1.0 / free[static_cast<size_t>(i)]->prior_sigma;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(
      information.asDiagonal() * covariance * information.asDiagonal());
  const auto is_open = (solver.eigenvalues().array() > 0.5).cast<double>().matrix();
  return solver.eigenvectors().cwiseAbs2() * is_open;
}

nlohmann::ordered_json ImuJson(const CalibratedImu& imu) {
  nlohmann::ordered_json parameters = nlohmann::ordered_json::array();
  for (const CalibratedParameter& parameter : imu.parameters) {
    parameters.push_back({{"name", parameter.name},
                          {"value", parameter.value},
                          {"sigma", parameter.sigma},
                          {"prior_sigma", parameter.prior_sigma}});
  }
  const auto list = [](const Eigen::Vector3d& v) {
    return std::vector<double>(v.begin(), v.end());
  };
  nlohmann::ordered_json biases = nlohmann::ordered_json::array();
  for (const BiasesAt& at : imu.biases) {
    biases.push_back({{"time_ns", at.time_ns},
                      {"gyroscope_deg_s", list(at.gyroscope_deg_s)},
                      {"gyroscope_sigma_deg_s", list(at.gyroscope_sigma_deg_s)},
                      {"accelerometer_m_s2", list(at.accelerometer_m_s2)},
                      {"accelerometer_sigma_m_s2", list(at.accelerometer_sigma_m_s2)}});
  }
  return {{"parameters", parameters}, {"biases", biases}};
}

}  // namespace

std::vector<std::vector<bool>> ObservedParameters(const Calibration& calibration) {
  const std::vector<const CalibratedParameter*> free = FreeParameters(calibration);
  const Eigen::VectorXd open_shares = OpenShares(calibration.covariance, free);
  std::vector<std::vector<bool>> observed;
  Eigen::Index row = 0;
  for (const CalibratedScanner& scanner : calibration.scanners) {
    std::vector<bool>& of_scanner = observed.emplace_back();
    for (const CalibratedParameter& parameter : scanner.parameters) {
      const auto num_alike = std::count_if(free.begin(), free.end(), [&](const auto* other) {
        return other->name == parameter.name;
      });
      of_scanner.push_back(parameter.IsHeld() ||
                           2.0 * static_cast<double>(num_alike) * open_shares[row++] < 1.0);
    }
  }
  return observed;
}

std::vector<std::string> UnobservedInWords(const Calibration& calibration) {
  const std::vector<std::vector<bool>> observed = ObservedParameters(calibration);
  std::vector<std::string> words;
  for (size_t i = 0; i < calibration.scanners.size(); ++i) {
    const CalibratedScanner& scanner = calibration.scanners[i];
    std::vector<std::string> of_scanner;
    for (size_t k = 0; k < scanner.parameters.size(); ++k) {
      if (!observed[i][k]) of_scanner.push_back(scanner.parameters[k].words);
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
  const std::vector<std::vector<bool>> observed = ObservedParameters(calibration);
  nlohmann::ordered_json scanners = nlohmann::ordered_json::array();
  for (size_t i = 0; i < calibration.scanners.size(); ++i) {
    const CalibratedScanner& scanner = calibration.scanners[i];
    nlohmann::ordered_json parameters = nlohmann::ordered_json::array();
    for (size_t k = 0; k < scanner.parameters.size(); ++k) {
      const CalibratedParameter& parameter = scanner.parameters[k];
      parameters.push_back({{"name", parameter.name},
                            {"value", parameter.value},
                            {"sigma", parameter.sigma},
                            {"prior_sigma", parameter.prior_sigma},
                            {"prior_value", parameter.prior_value},
                            {"observed", static_cast<bool>(observed[i][k])}});
    }
    scanners.push_back({{"name", scanner.name}, {"parameters", parameters}});
  }
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (Eigen::Index i = 0; i < calibration.covariance.rows(); ++i) {
    const Eigen::VectorXd row = calibration.covariance.row(i);
    rows.push_back(std::vector<double>(row.begin(), row.end()));
  }
  nlohmann::ordered_json json = {{"scanners", scanners},
                                 {"unobserved", UnobservedInWords(calibration)},
                                 {"covariance", rows}};
  if (calibration.imu) json["imu"] = ImuJson(*calibration.imu);
  return json.dump(1) + "\n";
}

}  // namespace plumbline
