#include <benchmark/benchmark.h>
#include <ceres/cost_function.h>

#include <cmath>
#include <memory>
#include <vector>

#include "factors/cost/point_factor.h"
#include "factors/cost/segment_factor.h"
#include "factors/segment/segment_compression.h"
#include "factors/segment/segment_measurement.h"
#include "factors/spline/so3.h"
#include "factors/spline/spline.h"

namespace plumbline {
namespace {

// Residuals and Jacobians of a wall seen by 60 beams within 5.5 ms, inside one knot interval,
// extrinsics constant. The time per residual is the time of Evaluate over the number of
// residuals; the time per point makes both kinds of factor comparable.
constexpr int kNumPoints = 60;

struct Scene {
  std::vector<Eigen::Quaterniond> q;
  std::vector<Eigen::Vector3d> p;
  Eigen::Quaterniond body_from_scanner = Exp(Eigen::Vector3d(0.0, 0.7, 0.7));
  Eigen::Vector3d origin_body{0.1, 0.2, 0.0};
  Eigen::Vector2d wall{0.3, 4.0};
  Eigen::Matrix2Xd points{2, kNumPoints};
  std::vector<int64_t> times_ns;
  Eigen::VectorXd whitening = Eigen::VectorXd::Constant(kNumPoints, 33.0);
  std::vector<const double*> parameters;
  // Storage of the Jacobians: nine residuals, blocks of at most four.
  std::vector<std::array<double, 36>> storage{11};
  std::vector<double*> jacobians;

  Scene() {
    for (int j = 0; j < 4; ++j) {
      q.push_back(Exp(Eigen::Vector3d(0.01 * j, 0.02, 0.1 * j)));
      p.push_back(Eigen::Vector3d(0.1 * j, 0.01 * j * j, 0.0));
    }
    for (int i = 0; i < kNumPoints; ++i) {
      const double y = -2.0 + 0.06 * i;
      points.col(i) << 4.0 - 0.3 * y + 0.03 * std::sin(7.0 * i), y;
      times_ns.push_back(92593 * i);
    }
    for (const Eigen::Quaterniond& rotation : q)
      parameters.push_back(rotation.coeffs().data());
    for (const Eigen::Vector3d& position : p) parameters.push_back(position.data());
    parameters.push_back(body_from_scanner.coeffs().data());
    parameters.push_back(origin_body.data());
    parameters.push_back(wall.data());
    for (std::array<double, 36>& block : storage) jacobians.push_back(block.data());
    jacobians[8] = jacobians[9] = nullptr;
  }
};

void Run(const ceres::CostFunction& factor,
         Scene* scene,
         int num_points,
         bool jacobians,
         benchmark::State* state) {
  double residuals[9];
  for (auto _ : *state) {
    factor.Evaluate(
        scene->parameters.data(), residuals, jacobians ? scene->jacobians.data() : nullptr);
    benchmark::DoNotOptimize(residuals);
    benchmark::ClobberMemory();
  }
  using Counter = benchmark::Counter;
  const auto flags = Counter::kIsIterationInvariantRate | Counter::kInvert;
  state->counters["residuals"] = factor.num_residuals();
  state->counters["per_residual"] = Counter(factor.num_residuals(), flags);
  state->counters["per_point"] = Counter(num_points, flags);
}

void BM_PointFactor(benchmark::State& state) {
  Scene scene;
  const auto factor =
      CreatePointFactor({scene.points.col(30), 0.5, 33.0}, PlaneModel::kVertical, {});
  Run(*factor, &scene, 1, state.range(0) != 0, &state);
}
BENCHMARK(BM_PointFactor)->ArgName("jacobian")->Arg(0)->Arg(1);

void BM_SegmentFactor(benchmark::State& state) {
  Scene scene;
  const SegmentMeasurement measurement =
      CompressSegment(scene.points, scene.times_ns, scene.whitening);
  const auto factor =
      CreateSegmentFactor(measurement,
                          {SplineNode{0, 0.40}, SplineNode{0, 0.42}, SplineNode{0, 0.44}},
                          4,
                          PlaneModel::kVertical,
                          {},
                          SegmentWeights{});
  if (state.range(1) != 0) {
    scene.jacobians[8] = scene.storage[8].data();
    scene.jacobians[9] = scene.storage[9].data();
  }
  Run(*factor, &scene, kNumPoints, state.range(0) != 0, &state);
}
BENCHMARK(BM_SegmentFactor)
    ->ArgNames({"jacobian", "extrinsics"})
    ->Args({0, 0})
    ->Args({1, 0})
    ->Args({1, 1});

void BM_CompressSegment(benchmark::State& state) {
  const Scene scene;
  for (auto _ : state) {
    benchmark::DoNotOptimize(CompressSegment(scene.points, scene.times_ns, scene.whitening));
  }
}
BENCHMARK(BM_CompressSegment);

void BM_SplinePose(benchmark::State& state) {
  const Scene scene;
  SplinePoseJacobian jacobian;
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        EvaluatePose(scene.parameters.data(), scene.parameters.data() + 4, 0.4, &jacobian));
    benchmark::ClobberMemory();
  }
}
BENCHMARK(BM_SplinePose);

}  // namespace
}  // namespace plumbline
