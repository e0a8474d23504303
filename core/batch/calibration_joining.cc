#include "core/batch/calibration_joining.h"

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
  Eigen::VectorXd prior_mean;
};

Gaussian GaussianOf(const Calibration& calibration) {
  Gaussian gaussian;
  const Eigen::Index size = calibration.covariance.rows();
  gaussian.mean.resize(size);
  gaussian.prior_sigma.resize(size);
  gaussian.prior_mean.resize(size);
  Eigen::Index row = 0;
  VisitFree(&calibration, [&](const std::string& scanner, const auto& parameter) {
    if (row == size) throw Error("has more parameters than rows of its covariance");
    gaussian.names.push_back(scanner + "." + parameter.name);
    gaussian.mean[row] = parameter.value;
    gaussian.prior_sigma[row] = parameter.prior_sigma;
    gaussian.prior_mean[row] = parameter.prior_value;
    ++row;
  });
  if (row != size) throw Error("has fewer parameters than rows of its covariance");
  return gaussian;
}

Eigen::MatrixXd InformationOf(const Eigen::VectorXd& sigma) {
  return sigma.cwiseAbs2().cwiseInverse().asDiagonal();
}

// The prior about the rig file that all maps share. A map that started elsewhere than the rig
// file says is as uncertain as it was off, which is what the rig file turned out to be.
Eigen::VectorXd WidestPrior(const std::vector<Gaussian>& gaussians,
                            const std::vector<std::string>& names) {
  const Gaussian& first = gaussians.front();
  Eigen::VectorXd widest = first.prior_sigma;
  bool started_elsewhere = false;
  for (const Gaussian& gaussian : gaussians) {
    if (gaussian.names == first.names) {
      widest = widest.cwiseMax(gaussian.prior_sigma);
      started_elsewhere = started_elsewhere || !gaussian.prior_mean.isZero();
    }
  }
  for (size_t i = 0; i < gaussians.size(); ++i) {
    if (gaussians[i].names != first.names ||
        (!started_elsewhere && !gaussians[i].prior_sigma.isApprox(widest, 1e-6))) {
      throw Error(names[i] + ": is of another rig file than " + names.front() +
                  ": other scanners, or other uncertainties");
    }
  }
  return widest;
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
                                   parameter.at("prior_sigma").get<double>(),
                                   parameter.at("prior_value").get<double>()});
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
  std::vector<Gaussian> gaussians;
  for (const Calibration& calibration : calibrations) {
    gaussians.push_back(GaussianOf(calibration));
  }
  const Gaussian& first = gaussians.front();
  const Eigen::VectorXd prior_sigma = WidestPrior(gaussians, names);
  const Eigen::MatrixXd of_prior = InformationOf(prior_sigma);
  Eigen::MatrixXd information = of_prior;
  Eigen::VectorXd weighted = Eigen::VectorXd::Zero(first.mean.size());
  for (size_t i = 0; i < calibrations.size(); ++i) {
    const Gaussian& gaussian = gaussians[i];
    const Eigen::LLT<Eigen::MatrixXd> factor(calibrations[i].covariance);
    if (factor.info() != Eigen::Success) {
      throw Error(names[i] + ": its covariance is not positive definite");
    }
    const Eigen::MatrixXd of_own_prior = InformationOf(gaussian.prior_sigma);
    information += factor.solve(Eigen::MatrixXd::Identity(of_prior.rows(), of_prior.cols())) -
                   of_own_prior;
    weighted += factor.solve(gaussian.mean) - of_own_prior * gaussian.prior_mean;
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
    parameter.prior_sigma = prior_sigma[row];
    parameter.prior_value = 0.0;
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
