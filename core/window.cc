#include "core/window.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "core/error.h"
#include "core/time.h"
#include "factors/elimination.h"
#include "factors/manifolds.h"
#include "factors/schur.h"
#include "factors/so3.h"

namespace plumbline {
namespace {

// Segments beyond this many standard deviations (norm of up to nine residuals) lose influence.
constexpr double kHuberWidth = 5.0;
constexpr char kNotDetermined[] =
    "the poses and planes are not determined by the scans: singular estimate";

ceres::Solver::Options SolverOptions() {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.max_num_iterations = 5;
  options.num_threads = 1;  // Ceres sums costs by thread: more of them would change the result
  options.logging_type = ceres::SILENT;
  // The window only has to be good enough for the next associations and as the batch's start:
  // an iteration that lowers the cost by less than this share of it is the last one.
  options.function_tolerance = 1e-4;
  options.initial_trust_region_radius = 1e12;  // Gauss-Newton: prediction and history are near
  return options;
}

bool IsLandmark(const BlockId& block) { return block.kind == BlockId::Kind::kLandmark; }

int Size(const NormalEquations& equations, size_t block) {
  return equations.offsets[block + 1] - equations.offsets[block];
}

// Rows of the blocks for which keep(block) is true.
template <typename Keep>
std::vector<int> RowsOf(const NormalEquations& equations, Keep keep) {
  std::vector<int> rows;
  for (size_t i = 0; i < equations.blocks.size(); ++i) {
    if (!keep(equations.blocks[i])) continue;
    for (int row = equations.offsets[i]; row < equations.offsets[i + 1]; ++row) {
      rows.push_back(row);
    }
  }
  return rows;
}

// Inverse on the rows and directions that are estimated; zero on the others.
Eigen::MatrixXd InverseOn(const NormalEquations& equations, const std::vector<int>& on) {
  std::vector<int> rows;
  for (const int row : on) {
    if (equations.hessian(row, row) > 0.0) rows.push_back(row);
  }
  const Eigen::MatrixXd free = equations.hessian(rows, rows);
  // Scaled to a unit diagonal, so that metres and radians do not spoil the condition.
  const Eigen::VectorXd scale = free.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::LLT<Eigen::MatrixXd> factor(scale.asDiagonal() * free * scale.asDiagonal());
  if (factor.info() != Eigen::Success) throw Error(kNotDetermined);
  const Eigen::MatrixXd inverse =
      factor.solve(Eigen::MatrixXd::Identity(free.rows(), free.cols()));
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(equations.size(), equations.size());
  covariance(rows, rows) = scale.asDiagonal() * inverse * scale.asDiagonal();
  return covariance;
}

void SetCovariance(const Eigen::MatrixXd& covariance, Landmark* landmark) {
  landmark->covariance.setZero();
  landmark->covariance.topLeftCorner(covariance.rows(), covariance.cols()) = covariance;
}

// An empty system over these blocks, taken in order and once each.
NormalEquations ZeroSystem(std::vector<BlockId> blocks, const EstimationProblem& problem) {
  std::sort(blocks.begin(), blocks.end());
  blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
  NormalEquations system;
  system.blocks = std::move(blocks);
  system.offsets.push_back(0);
  for (const BlockId& block : system.blocks) {
    system.offsets.push_back(system.offsets.back() + problem.TangentSize(block));
  }
  system.hessian.setZero(system.size(), system.size());
  system.gradient.setZero(system.size());
  return system;
}

// system += part, whose blocks have these names in the system.
void AddTo(const NormalEquations& part,
           const std::vector<BlockId>& names,
           NormalEquations* system) {
  std::vector<int> rows;
  for (size_t i = 0; i < names.size(); ++i) {
    const auto at = std::lower_bound(system->blocks.begin(), system->blocks.end(), names[i]) -
                    system->blocks.begin();
    for (int k = 0; k < Size(part, i); ++k) {
      rows.push_back(system->offsets[static_cast<size_t>(at)] + k);
    }
  }
  for (size_t j = 0; j < rows.size(); ++j) {
    const auto column = static_cast<Eigen::Index>(j);
    system->gradient[rows[j]] += part.gradient[column];
    for (size_t i = 0; i < rows.size(); ++i) {
      system->hessian(rows[i], rows[j]) += part.hessian(static_cast<Eigen::Index>(i), column);
    }
  }
}

}  // namespace

Window::Window(const Rig& rig, bool planar, const MapperOptions& options, MapState* state)
    : rig_(rig), planar_(planar), options_(options), state_(state) {
  history_.equations.offsets.push_back(0);
}

void Window::AddMotionPriors(EstimationProblem* problem, int first, int last) const {
  for (int i = first; i <= last; ++i) problem->AddMotionPrior(i, options_.trajectory);
}

void Window::AddStart(EstimationProblem* problem) const {
  problem->AddStartVelocityPrior(options_.trajectory);
  problem->AddOrigin(state_->origin_time_ns);
}

void Window::Add(int observation_index) {
  const Observation& observation =
      state_->observations[static_cast<size_t>(observation_index)];
  const int first = state_->trajectory.Locate(observation.measurement.node_times_ns[0]).first;
  if (first >= start_) window_.push_back(observation_index);
}

std::set<int> Window::LandmarksInWindow() const {
  std::set<int> ids;
  for (const int index : window_) {
    ids.insert(state_->observations[static_cast<size_t>(index)].landmark_id);
  }
  return ids;
}

Eigen::VectorXd Window::Moved(const EstimationProblem& problem, size_t block) const {
  const BlockId& id = history_.equations.blocks[block];
  const Eigen::VectorXd& at = history_.at[block];
  const double* now = problem.Data(id);
  if (id.kind != BlockId::Kind::kRotation) {
    return Eigen::Map<const Eigen::VectorXd>(now, at.size()) - at;
  }
  if (planar_) return Eigen::VectorXd::Constant(1, YawDifference(now, at.data()));
  using Quaternion = Eigen::Map<const Eigen::Quaterniond>;
  return Log(Quaternion(now) * Quaternion(at.data()).conjugate());
}

Window::Dormant Window::EliminateDormant() const {
  const std::set<int> in_view = LandmarksInWindow();
  const NormalEquations& past = history_.equations;
  Dormant dormant;
  std::vector<int> order;
  std::vector<int> active_rows;
  for (size_t i = 0; i < past.blocks.size(); ++i) {
    const BlockId& block = past.blocks[i];
    const bool is_dormant = IsLandmark(block) && in_view.count(block.index) == 0;
    (is_dormant ? dormant.blocks : dormant.active_blocks).push_back(i);
    for (int row = past.offsets[i]; row < past.offsets[i + 1]; ++row) {
      (is_dormant ? order : active_rows).push_back(row);
    }
  }
  const auto num_dormant = static_cast<Eigen::Index>(order.size());
  order.insert(order.end(), active_rows.begin(), active_rows.end());
  dormant.elimination =
      Elimination::Make(past.hessian(order, order), past.gradient(order), num_dormant);
  if (!dormant.elimination) throw Error(kNotDetermined);
  return dormant;
}

void Window::AddHistory(const Dormant& dormant, EstimationProblem* problem) const {
  if (dormant.active_blocks.empty()) return;
  Prior prior;
  for (const size_t i : dormant.active_blocks) {
    const BlockId& block = history_.equations.blocks[i];
    prior.blocks.push_back(block);
    prior.linear.blocks.push_back(
        {problem->KindOf(block), static_cast<int>(history_.at[i].size()), history_.at[i]});
  }
  const MarginalisedSystem root = plumbline::Marginalise(
      dormant.elimination->hessian(), dormant.elimination->gradient(), 0);
  prior.linear.root = root.root;
  prior.linear.offset = root.offset;
  problem->AddPrior(prior);
}

void Window::MoveDormant(const Dormant& dormant,
                         const EstimationProblem& problem,
                         const NormalEquations& equations,
                         const Eigen::MatrixXd& covariance) {
  if (dormant.blocks.empty()) return;
  const NormalEquations& past = history_.equations;
  std::vector<int> rows;  // of the history's active blocks in the solution
  std::vector<double> moved;
  for (const size_t i : dormant.active_blocks) {
    const auto at =
        std::lower_bound(equations.blocks.begin(), equations.blocks.end(), past.blocks[i]);
    const int offset = equations.offsets[static_cast<size_t>(at - equations.blocks.begin())];
    const Eigen::VectorXd step = Moved(problem, i);
    for (int k = 0; k < Size(past, i); ++k) {
      rows.push_back(offset + k);
      moved.push_back(step[k]);
    }
  }
  const Eigen::VectorXd step =
      dormant.elimination->BackSubstitute(Eigen::Map<const Eigen::VectorXd>(
          moved.data(), static_cast<Eigen::Index>(moved.size())));
  const Eigen::MatrixXd gain = dormant.elimination->Gain();
  const Eigen::MatrixXd root = dormant.elimination->ConditionalRoot();
  const Eigen::MatrixXd spread = gain * covariance(rows, rows);
  Eigen::Index row = 0;
  for (const size_t i : dormant.blocks) {
    const int size = Size(past, i);
    Landmark& landmark = state_->landmarks[static_cast<size_t>(past.blocks[i].index)];
    for (int k = 0; k < size; ++k) {
      landmark.parameters[static_cast<size_t>(k)] = history_.at[i][k] + step[row + k];
    }
    const auto columns = root.middleCols(row, size);
    SetCovariance(columns.transpose() * columns +
                      spread.middleRows(row, size) * gain.middleRows(row, size).transpose(),
                  &landmark);
    row += size;
  }
}

PoseGaussian Window::Solve(int64_t now_ns, double window_s) {
  const Dormant dormant = EliminateDormant();
  EstimationProblem problem(rig_, planar_, &state_->trajectory, &state_->landmarks);
  AddHistory(dormant, &problem);
  if (start_ == 0) AddStart(&problem);
  AddMotionPriors(&problem, start_, state_->trajectory.num_control_points() - 3);
  std::vector<const Observation*> in_window;
  for (const int index : window_) {
    in_window.push_back(&state_->observations[static_cast<size_t>(index)]);
  }
  problem.AddSegments(in_window, kHuberWidth, &groups_);
  problem.Solve(SolverOptions());
  const NormalEquations equations = problem.Linearise();

  const int newest = state_->trajectory.Locate(now_ns).first;
  PoseGaussian newest_poses = NewestPoses(equations, newest);

  // What the planes' uncertainty is to somebody who stands at the newest pose.
  const Eigen::MatrixXd covariance =
      InverseOn(equations, RowsOf(equations, [&](const BlockId& block) {
                  return IsLandmark(block) || block.index < newest;
                }));
  for (size_t i = 0; i < equations.blocks.size(); ++i) {
    const BlockId& block = equations.blocks[i];
    const int row = equations.offsets[i];
    if (!IsLandmark(block)) continue;
    SetCovariance(covariance.block(row, row, Size(equations, i), Size(equations, i)),
                  &state_->landmarks[static_cast<size_t>(block.index)]);
  }
  MoveDormant(dormant, problem, equations, covariance);
  const int64_t oldest_ns =
      std::max(state_->trajectory.start_ns(), now_ns - NanosecondsFromSeconds(window_s));
  Marginalise(state_->trajectory.Locate(oldest_ns).first);
  return newest_poses;
}

PoseGaussian Window::NewestPoses(const NormalEquations& equations, int newest) const {
  std::vector<int> order = RowsOf(equations, [&](const BlockId& block) {
    return !IsLandmark(block) && block.index < newest;
  });
  const auto num_older = static_cast<Eigen::Index>(order.size());
  const std::vector<int> newest_rows = RowsOf(equations, [&](const BlockId& block) {
    return !IsLandmark(block) && block.index >= newest;
  });
  order.insert(order.end(), newest_rows.begin(), newest_rows.end());
  const std::optional<Elimination> older =
      Elimination::Make(equations.hessian(order, order),
                        Eigen::VectorXd::Zero(static_cast<Eigen::Index>(order.size())),
                        num_older);
  if (!older) throw Error(kNotDetermined);
  PoseGaussian gaussian;
  gaussian.first = newest;
  for (int i = newest; i < state_->trajectory.num_control_points(); ++i) {
    gaussian.mean.push_back(state_->trajectory.control_point(i));
  }
  // From the blocks' rows to six a control point; a planar rotation is a yaw.
  std::vector<int> rows;
  for (size_t i = 0; i < equations.blocks.size(); ++i) {
    const BlockId& block = equations.blocks[i];
    if (IsLandmark(block) || block.index < newest) continue;
    const int base = 6 * (block.index - newest);
    const int size = Size(equations, i);
    const int first = block.kind == BlockId::Kind::kPosition ? 3 : 3 - size;
    for (int k = 0; k < size; ++k) rows.push_back(base + first + k);
  }
  const auto size = static_cast<Eigen::Index>(6 * gaussian.mean.size());
  gaussian.information.setZero(size, size);
  gaussian.information(rows, rows) = older->hessian();
  return gaussian;
}

void Window::Marginalise(int new_start) {
  if (new_start <= start_) return;
  EstimationProblem leaving(rig_, planar_, &state_->trajectory, &state_->landmarks);
  if (start_ == 0) AddStart(&leaving);
  AddMotionPriors(&leaving, start_, new_start - 1);
  std::vector<int> staying;
  std::vector<const Observation*> gone;
  for (const int index : window_) {
    const Observation& observation = state_->observations[static_cast<size_t>(index)];
    const int first =
        state_->trajectory.Locate(observation.measurement.node_times_ns[0]).first;
    if (first >= new_start) {
      staying.push_back(index);
    } else {
      gone.push_back(&observation);
    }
  }
  leaving.AddSegments(gone, kHuberWidth, &groups_);
  const NormalEquations added = leaving.Linearise();
  groups_.ForgetBefore(new_start);

  // The history's gradient where its blocks stand now.
  NormalEquations& past = history_.equations;
  Eigen::VectorXd moved(past.size());
  for (size_t i = 0; i < past.blocks.size(); ++i) {
    moved.segment(past.offsets[i], Size(past, i)) = Moved(leaving, i);
  }
  past.gradient += past.hessian * moved;

  std::vector<BlockId> blocks = past.blocks;
  blocks.insert(blocks.end(), added.blocks.begin(), added.blocks.end());
  NormalEquations all = ZeroSystem(std::move(blocks), leaving);
  AddTo(past, past.blocks, &all);
  AddTo(added, added.blocks, &all);
  // Control points come first, by time: those that leave are the leading blocks.
  size_t num_leaving = 0;
  while (!IsLandmark(all.blocks[num_leaving]) && all.blocks[num_leaving].index < new_start) {
    ++num_leaving;
  }
  const int leaving_rows = all.offsets[num_leaving];
  const std::optional<Elimination> rest =
      Elimination::Make(all.hessian, all.gradient, leaving_rows);
  if (!rest) throw Error(kNotDetermined);
  past.blocks.assign(all.blocks.begin() + static_cast<std::ptrdiff_t>(num_leaving),
                     all.blocks.end());
  past.offsets.clear();
  for (size_t i = num_leaving; i < all.offsets.size(); ++i) {
    past.offsets.push_back(all.offsets[i] - leaving_rows);
  }
  past.hessian = rest->hessian();
  past.gradient = rest->gradient();
  history_.at.clear();
  for (const BlockId& block : past.blocks) {
    history_.at.emplace_back(
        Eigen::Map<const Eigen::VectorXd>(leaving.Data(block), leaving.AmbientSize(block)));
  }
  window_ = std::move(staying);
  start_ = new_start;
}

void Window::MergeLandmarks(int into, int from) {
  NormalEquations& past = history_.equations;
  const auto find = [&](int id) {
    return static_cast<size_t>(
        std::find(past.blocks.begin(), past.blocks.end(), LandmarkBlock(id)) -
        past.blocks.begin());
  };
  const size_t from_at = find(from);
  if (from_at == past.blocks.size()) return;
  const size_t into_at = find(into);
  Eigen::VectorXd value = history_.at[from_at];
  if (into_at < past.blocks.size()) {
    // Both about the same values first.
    value = history_.at[into_at];
    Eigen::VectorXd shift = value - history_.at[from_at];
    if (shift.size() == 2) shift[0] = std::remainder(shift[0], 2.0 * M_PI);
    past.gradient += past.hessian.middleCols(past.offsets[from_at], shift.size()) * shift;
  }
  std::vector<BlockId> names = past.blocks;
  names[from_at] = LandmarkBlock(into);
  std::map<BlockId, Eigen::VectorXd> at;
  for (size_t i = 0; i < names.size(); ++i) at[names[i]] = history_.at[i];
  at[LandmarkBlock(into)] = value;
  const EstimationProblem sizes(rig_, planar_, &state_->trajectory, &state_->landmarks);
  NormalEquations merged = ZeroSystem(names, sizes);
  AddTo(past, names, &merged);
  const Landmark& landmark = state_->landmarks[static_cast<size_t>(into)];
  history_.at.clear();
  for (size_t i = 0; i < merged.blocks.size(); ++i) {
    const BlockId& block = merged.blocks[i];
    history_.at.push_back(at.at(block));
    if (!(block == LandmarkBlock(into)) || !landmark.heading_fixed) continue;
    merged.hessian.row(merged.offsets[i]).setZero();  // a held direction has no say
    merged.hessian.col(merged.offsets[i]).setZero();
    merged.gradient[merged.offsets[i]] = 0.0;
  }
  past = std::move(merged);
}

}  // namespace plumbline
