#include "core/mapping/calibration_joining.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/map/calibration_report.h"
#include "core/map/rig_calibration.h"
#include "core/util/error.h"
#include "core/util/json_file.h"

namespace plumbline {
namespace {

// Calls visit(parameter) for what is not held by definition, in the covariance's order.
template <typename CalibrationType, typename Visit>
void VisitFree(CalibrationType* calibration, const Visit& visit) {
  for (auto& scanner : calibration->scanners) {
    for (auto& parameter : scanner.parameters) {
      if (!parameter.IsHeld()) visit(scanner.name, parameter);
    }
  }
}

struct Gaussian {
  std::vector<std::string> names;
  Eigen::VectorXd mean;
  Eigen::VectorXd prior_sigma;
};

Gaussian GaussianOf(const Calibration& calibration) {
  Gaussian gaussian;
  const Eigen::Index size = calibration.covariance.rows();
  gaussian.mean.resize(size);
  gaussian.prior_sigma.resize(size);
  Eigen::Index row = 0;
  VisitFree(&calibration, [&](const std::string& scanner, const auto& parameter) {
    if (row == size) throw Error("has more parameters than rows of its covariance");
    gaussian.names.push_back(scanner + "." + parameter.name);
    gaussian.mean[row] = parameter.value;
    gaussian.prior_sigma[row] = parameter.prior_sigma;
    ++row;
  });
  if (row != size) throw Error("has fewer parameters than rows of its covariance");
  return gaussian;
}

}  // namespace

Calibration ReadCalibration(const std::string& path) {
  const auto json = ReadJsonObject<nlohmann::json>(path);
  Calibration calibration;
  try {
    for (const auto& scanner : json.at("scanners")) {
      CalibratedScanner read;
      read.name = scanner.at("name").get<std::string>();
      for (const auto& parameter : scanner.at("parameters")) {
        const auto name = parameter.at("name").get<std::string>();
        read.parameters.push_back({name,
                                   ParameterInWords(name),
                                   parameter.at("value").get<double>(),
                                   parameter.at("sigma").get<double>(),
                                   parameter.at("prior_sigma").get<double>()});
      }
      calibration.scanners.push_back(std::move(read));
    }
    const auto rows = json.at("covariance").get<std::vector<std::vector<double>>>();
    const auto size = static_cast<Eigen::Index>(rows.size());
    calibration.covariance.resize(size, size);
    for (Eigen::Index i = 0; i < size; ++i) {
      const std::vector<double>& row = rows[static_cast<size_t>(i)];
      if (row.size() != rows.size()) throw Error("its covariance is not square");
      calibration.covariance.row(i) = Eigen::Map<const Eigen::RowVectorXd>(row.data(), size);
    }
    GaussianOf(calibration);
  } catch (const nlohmann::json::exception&) {
    throw Error(path + ": is no calibration as plumbline_map writes it");
  } catch (const Error& error) {
    throw Error(path + ": " + error.what());
  }
  return calibration;
}

Calibration JoinCalibrations(const std::vector<Calibration>& calibrations,
                             const std::vector<std::string>& names) {
  const Gaussian first = GaussianOf(calibrations.front());
  const Eigen::MatrixXd of_prior =
      first.prior_sigma.cwiseAbs2().cwiseInverse().asDiagonal().toDenseMatrix();
  Eigen::MatrixXd information = of_prior;
  Eigen::VectorXd weighted = Eigen::VectorXd::Zero(first.mean.size());
  for (size_t i = 0; i < calibrations.size(); ++i) {
    const Gaussian gaussian = GaussianOf(calibrations[i]);
    if (gaussian.names != first.names ||
        !gaussian.prior_sigma.isApprox(first.prior_sigma, 1e-6)) {
      throw Error(
          names[i] + ": is of another rig file than " + names.front() +
          ": other scanners, or other uncertainties (maps that started elsewhere than the "
          "rig file says have wider ones: use the rig_calibrated.yaml of one of them)");
    }
    const Eigen::LLT<Eigen::MatrixXd> factor(calibrations[i].covariance);
    if (factor.info() != Eigen::Success) {
      throw Error(names[i] + ": its covariance is not positive definite");
    }
    information +=
        factor.solve(Eigen::MatrixXd::Identity(of_prior.rows(), of_prior.cols())) - of_prior;
    weighted += factor.solve(gaussian.mean);
  }
  Calibration joined = calibrations.front();
  const Eigen::LLT<Eigen::MatrixXd> factor(information);
  joined.covariance =
      factor.solve(Eigen::MatrixXd::Identity(of_prior.rows(), of_prior.cols()));
  const Eigen::VectorXd mean = factor.solve(weighted);
  Eigen::Index row = 0;
  VisitFree(&joined, [&](const std::string&, CalibratedParameter& parameter) {
    parameter.value = mean[row];
    parameter.sigma = std::sqrt(joined.covariance(row, row));
    ++row;
  });
  return joined;
}

Rig WithCalibration(const Rig& rig, const Calibration& calibration) {
  RigCalibration estimate(rig, IsPlanar(rig));
  TakeCalibration(rig, calibration, &estimate);
  return CalibratedRig(rig, estimate);
}

}  // namespace plumbline
