#include "core/estimation/imu_terms.h"

#include <ceres/cost_function.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "core/estimation/estimation_problem.h"
#include "core/util/quantiles.h"
#include "factors/imu/accelerometer_factor.h"
#include "factors/imu/gyroscope_factor.h"
#include "factors/spline/so3.h"
#include "factors/spline/spline.h"

namespace plumbline {
namespace {

Prior PriorOn(const std::vector<BlockId>& blocks, int size) {
  Prior prior;
  prior.blocks = blocks;
  for (size_t i = 0; i < blocks.size(); ++i) {
    prior.linear.blocks.push_back(
        {LinearPrior::Kind::kEuclidean, size, Eigen::VectorXd::Zero(size)});
  }
  prior.linear.offset.setZero(size);
  return prior;
}

// Means of readings, and what no spline of the knots can follow in them.
class Means {
 public:
  explicit Means(const MapState& state)
      : readings_(*state.imu),
        trajectory_(state.trajectory),
        imu_(*state.calibration.imu),
        part_ns_(state.trajectory.knot_interval_ns() / kImuMeansPerInterval) {}

  ImuMean At(int part) const {
    const int64_t begin_ns = trajectory_.start_ns() + part * part_ns_;
    return readings_.MeanOf(begin_ns, begin_ns + part_ns_);
  }
  double interval_s() const { return trajectory_.knot_interval_s(); }
  double part_s() const { return 1e-9 * static_cast<double>(part_ns_); }

  // Variance of white noise of a mean.
  double NoiseOf(const ImuMean& mean, const InertialErrors& errors) const {
    return errors.noise * errors.noise / readings_.period_s() / mean.num_samples;
  }

  // A measurement of one sensor: of: member of the mean.
  ImuMeasurement Measure(int part,
                         const ImuMean& mean,
                         Eigen::Vector3d ImuMean::*of,
                         const InertialErrors& errors) const {
    ImuMeasurement measurement;
    measurement.mean = mean.*of;
    const double variance = NoiseOf(mean, errors);
    measurement.stddev = (variance + Excess(part, of, variance).array()).sqrt();
    const double begin_s = part % kImuMeansPerInterval * part_s();
    measurement.u = {(begin_s + mean.time_s - mean.time_stddev_s) / interval_s(),
                     (begin_s + mean.time_s + mean.time_stddev_s) / interval_s()};
    const double u = 0.5 * (measurement.u[0] + measurement.u[1]);
    measurement.bias_share =
        (part / kImuMeansPerInterval % imu_.intervals_per_bias + u) / imu_.intervals_per_bias;
    return measurement;
  }

 private:
  // Variance by which neighbouring means differ beyond their noise, once all that is of the
  // third order in time is taken off: jerks and vibrations that the spline does not follow.
  Eigen::Vector3d Excess(int part, Eigen::Vector3d ImuMean::*of, double variance) const {
    std::array<Eigen::Vector3d, 5> means;
    for (int i = 0; i < 5; ++i) {
      const ImuMean mean = At(part + i - 2);
      if (mean.num_samples == 0) return Eigen::Vector3d::Zero();
      means[static_cast<size_t>(i)] = mean.*of;
    }
    const Eigen::Vector3d difference =
        means[0] - 4.0 * means[1] + 6.0 * means[2] - 4.0 * means[3] + means[4];
    const double by_noise = kSignificantStddevs * kSignificantStddevs * variance;
    return (difference.array().square() / (1.0 + 16.0 + 36.0 + 16.0 + 1.0) - by_noise)
        .max(0.0);
  }

  const ImuReadings& readings_;
  const Trajectory& trajectory_;
  const ImuEstimate& imu_;
  int64_t part_ns_;
};

// Adds to a measurement's deviations what the IMU and a bias that are held (the last three
// blocks of a factor) leave uncertain of what it should read. Neighbouring biases err alike.
void AddUncertaintyOfHeld(const ceres::CostFunction& factor,
                          const std::vector<const double*>& blocks,
                          const ImuMatrix& of_imu,
                          const Eigen::Matrix3d& of_bias,
                          int num_alike,
                          ImuMeasurement* measurement) {
  Eigen::Matrix<double, 3, kImuBlockSize, Eigen::RowMajor> by_imu;
  Eigen::Matrix<double, 3, kImuBiasSize, Eigen::RowMajor> by_bias;
  Eigen::Matrix<double, 3, kImuBiasSize, Eigen::RowMajor> by_next_bias;
  std::vector<double*> jacobians(blocks.size() - 3, nullptr);
  jacobians.insert(jacobians.end(), {by_imu.data(), by_bias.data(), by_next_bias.data()});
  Eigen::Vector3d residuals;
  factor.Evaluate(blocks.data(), residuals.data(), jacobians.data());
  by_bias += by_next_bias;
  // In units of those of the measurement.
  const Eigen::Matrix3d variance =
      by_imu * of_imu * by_imu.transpose() + by_bias * of_bias * by_bias.transpose();
  measurement->stddev.array() *= (1.0 + num_alike * variance.diagonal().array()).sqrt();
}

// Adds the two measurements of a mean.
class Adder {
 public:
  Adder(const MapState& state, int num_alike, EstimationProblem* problem)
      : state_(state),
        imu_(*state.calibration.imu),
        means_(state),
        num_alike_(num_alike),
        problem_(problem) {}

  void Add(int interval, int part) {
    const ImuMean mean = means_.At(part);
    if (mean.num_samples == 0) return;
    const int node = interval / imu_.intervals_per_bias;
    const double interval_s = state_.trajectory.knot_interval_s();
    ImuMeasurement rate =
        means_.Measure(part, mean, &ImuMean::angular_rate, imu_.stated.gyroscope);
    std::vector<BlockId> blocks;
    for (int i = 0; i < kSplineOrder; ++i) blocks.push_back(RotationBlock(interval + i));
    std::vector<BlockId> of_imu = {
        ImuBlockId(), GyroscopeBiasBlock(Last(node)), GyroscopeBiasBlock(Last(node + 1))};
    const double none = std::numeric_limits<double>::infinity();
    if (imu_.planar) {
      // Axes that are not upright read the body's tilting, which is no motion in the plane.
      const Eigen::Vector3d vertical_imu =
          imu_.stated.body_from_imu.rotation.conjugate() * Eigen::Vector3d::UnitZ();
      for (int axis = 0; axis < 3; ++axis) {
        if (std::abs(vertical_imu[axis]) < 0.5) rate.stddev[axis] = none;
      }
    }
    AddFactor([&] { return CreateGyroscopeFactor(rate, imu_.Pose(), interval_s); },
              blocks,
              of_imu,
              imu_.biases[static_cast<size_t>(node)].gyroscope_covariance,
              &rate);
    if (imu_.planar) return;
    ImuMeasurement force =
        means_.Measure(part, mean, &ImuMean::specific_force, imu_.stated.accelerometer);
    for (int i = 0; i < kSplineOrder; ++i) blocks.push_back(PositionBlock(interval + i));
    of_imu = {ImuBlockId(),
              AccelerometerBiasBlock(Last(node)),
              AccelerometerBiasBlock(Last(node + 1))};
    AddFactor(
        [&] {
          return CreateAccelerometerFactor(force, imu_.Pose(), kStandardGravity, interval_s);
        },
        blocks,
        of_imu,
        imu_.biases[static_cast<size_t>(node)].accelerometer_covariance,
        &force);
  }

  // The random walk from a node to the next.
  void AddWalk(int node) {
    const double root_s =
        std::sqrt(imu_.intervals_per_bias * state_.trajectory.knot_interval_s());
    const auto add = [&](const BlockId& from, const BlockId& to, double sigma) {
      Prior walk = PriorOn({from, to}, kImuBiasSize);
      walk.linear.root.setZero(kImuBiasSize, 2 * kImuBiasSize);
      walk.linear.root.leftCols<kImuBiasSize>().diagonal().setConstant(-1.0 / sigma);
      walk.linear.root.rightCols<kImuBiasSize>().diagonal().setConstant(1.0 / sigma);
      problem_->AddPrior(walk);
    };
    // A bias that does not change is held by a ten-thousandth of its own deviation: in an hour
    // it wanders by a hundredth, and what is known of it stays above rounding errors.
    const auto sigma_of = [&](const InertialErrors& errors) {
      return std::max(errors.BiasWalk() * root_s, 1e-4 * errors.bias + 1e-12);
    };
    add(GyroscopeBiasBlock(Last(node)),
        GyroscopeBiasBlock(Last(node + 1)),
        sigma_of(imu_.stated.gyroscope));
    if (imu_.planar) return;
    add(AccelerometerBiasBlock(Last(node)),
        AccelerometerBiasBlock(Last(node + 1)),
        sigma_of(imu_.stated.accelerometer));
  }

 private:
  int Last(int node) const { return imu_.LastIntervalOf(node); }

  template <typename Make>
  void AddFactor(const Make& make,
                 std::vector<BlockId> blocks,
                 const std::vector<BlockId>& of_imu,
                 const Eigen::Matrix3d& of_bias,
                 ImuMeasurement* measurement) {
    blocks.insert(blocks.end(), of_imu.begin(), of_imu.end());
    std::unique_ptr<ceres::CostFunction> factor = make();
    if (problem_->unknowns().landmarks_held()) {
      std::vector<const double*> data;
      for (const BlockId& block : blocks) data.push_back(problem_->unknowns().Data(block));
      AddUncertaintyOfHeld(*factor, data, imu_.covariance, of_bias, num_alike_, measurement);
      factor = make();
    }
    problem_->AddFactor(std::move(factor), blocks, FactorTerm::Kind::kImu);
  }

  const MapState& state_;
  const ImuEstimate& imu_;
  Means means_;
  int num_alike_;
  EstimationProblem* problem_;
};

}  // namespace

void AddImu(
    const MapState& state, int first, int end, int num_alike, EstimationProblem* problem) {
  if (state.imu == nullptr || !state.calibration.imu) return;
  Adder adder(state, num_alike, problem);
  for (int interval = first; interval < end; ++interval) {
    for (int part = 0; part < kImuMeansPerInterval; ++part) {
      adder.Add(interval, kImuMeansPerInterval * interval + part);
    }
    const int per_bias = state.calibration.imu->intervals_per_bias;
    if (interval % per_bias == 0 && !problem->unknowns().landmarks_held()) {
      adder.AddWalk(interval / per_bias);
    }
  }
}

ImuDifference& ImuDifference::operator+=(const ImuDifference& other) {
  turn_world += other.turn_world;
  velocity_world += other.velocity_world;
  turn_variance += other.turn_variance;
  velocity_variance += other.velocity_variance;
  return *this;
}

std::optional<ImuDifference> DifferenceFromImu(const MapState& state, int first, int end) {
  const ImuEstimate& imu = *state.calibration.imu;
  const Means means(state);
  ImuDifference sum;
  for (int part = kImuMeansPerInterval * first; part < kImuMeansPerInterval * end; ++part) {
    const ImuMean mean = means.At(part);
    if (mean.num_samples == 0) return std::nullopt;
    const int interval = part / kImuMeansPerInterval;
    std::vector<const double*> blocks;
    for (int i = interval; i < interval + kSplineOrder; ++i) {
      blocks.push_back(state.trajectory.control_point(i).rotation.data());
    }
    const auto node = static_cast<size_t>(interval / imu.intervals_per_bias);
    const int64_t middle_ns =
        state.trajectory.start_ns() +
        (2 * part + 1) * state.trajectory.knot_interval_ns() / (2 * kImuMeansPerInterval);
    const Eigen::Matrix3d world_from_imu =
        (state.trajectory.WorldFromBody(middle_ns).rotation *
         Exp(Eigen::Vector3d(imu.block.data() + kImuTurnAt)) *
         imu.stated.body_from_imu.rotation)
            .toRotationMatrix();
    // The sum's next term, of a residual in units of a measurement's deviations.
    const auto term = [&](const ceres::CostFunction& factor, const ImuMeasurement& measured) {
      Eigen::Vector3d residuals;
      factor.Evaluate(blocks.data(), residuals.data(), nullptr);
      return Eigen::Vector3d(world_from_imu * residuals.cwiseProduct(measured.stddev) *
                             means.part_s());
    };
    const ImuMeasurement rate =
        means.Measure(part, mean, &ImuMean::angular_rate, imu.stated.gyroscope);
    blocks.insert(blocks.end(),
                  {imu.block.data(),
                   imu.biases[node].gyroscope.data(),
                   imu.biases[node + 1].gyroscope.data()});
    sum.turn_world += term(*CreateGyroscopeFactor(rate, imu.Pose(), means.interval_s()), rate);
    blocks.resize(kSplineOrder);
    for (int i = interval; i < interval + kSplineOrder; ++i) {
      blocks.push_back(state.trajectory.control_point(i).position.data());
    }
    const ImuMeasurement force =
        means.Measure(part, mean, &ImuMean::specific_force, imu.stated.accelerometer);
    blocks.insert(blocks.end(),
                  {imu.block.data(),
                   imu.biases[node].accelerometer.data(),
                   imu.biases[node + 1].accelerometer.data()});
    sum.velocity_world += term(
        *CreateAccelerometerFactor(force, imu.Pose(), kStandardGravity, means.interval_s()),
        force);
    const double square_s2 = means.part_s() * means.part_s();
    sum.turn_variance += square_s2 * means.NoiseOf(mean, imu.stated.gyroscope);
    sum.velocity_variance += square_s2 * means.NoiseOf(mean, imu.stated.accelerometer);
  }
  return sum;
}

void SetImuCovariance(const BlockId& block,
                      const Eigen::MatrixXd& covariance,
                      Eigen::Index row,
                      ImuEstimate* imu) {
  if (IsImu(block)) {
    imu->covariance = covariance.block<kImuBlockSize, kImuBlockSize>(row, row);
    return;
  }
  ImuBiases& biases = imu->biases[static_cast<size_t>(imu->NodeOfLastInterval(block.index))];
  (block.kind == BlockId::Kind::kGyroscopeBias ? biases.gyroscope_covariance
                                               : biases.accelerometer_covariance) =
      covariance.block<kImuBiasSize, kImuBiasSize>(row, row);
}

void AddImuPrior(const ImuEstimate& imu, EstimationProblem* problem) {
  Prior prior = PriorOn({ImuBlockId()}, kImuBlockSize);
  prior.linear.root.setZero(kImuBlockSize, kImuBlockSize);
  for (int i = 0; i < kImuBlockSize; ++i) {
    const double sigma = imu.prior_sigma[static_cast<size_t>(i)];
    if (sigma > 0.0) prior.linear.root(i, i) = 1.0 / sigma;
  }
  problem->AddPrior(prior);
  const auto add = [&](const BlockId& block, double sigma) {
    Prior bias = PriorOn({block}, kImuBiasSize);
    bias.linear.root = Eigen::Matrix3d::Identity() / std::max(sigma, 1e-12);
    problem->AddPrior(bias);
  };
  add(GyroscopeBiasBlock(imu.LastIntervalOf(0)), imu.stated.gyroscope.bias);
  if (!imu.planar) {
    add(AccelerometerBiasBlock(imu.LastIntervalOf(0)), imu.stated.accelerometer.bias);
  }
}

MapperOptions WithoutMotionPrior(MapperOptions options) {
  constexpr double kWeaker = 30.0;
  TrajectoryOptions& trajectory = options.trajectory;
  trajectory.acceleration_density_m_s2 *= kWeaker;
  trajectory.angular_acceleration_density_deg_s2 *= kWeaker;
  trajectory.estimate_densities = false;
  return options;
}

}  // namespace plumbline
