#include "core/judging/scanner_outlook.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "core/geometry/angles.h"
#include "core/judging/levels.h"
#include "core/util/quantiles.h"

namespace plumbline {
namespace {

constexpr double kShortStep = 0.2;  // s, in which a turn is measured
constexpr double kMinLength = 0.5;  // m, of a trace whose turn counts
constexpr double kMaxTurn = 40.0 * kRadiansPerDegree;
constexpr double kTogether = 0.7;  // of a level scanner's traces turn with the rig
constexpr double kMinSeen = 3.0;   // m of traces
constexpr double kStill = 1.0 * kRadiansPerDegree;   // of a trace that does not
constexpr double kSpread = 1.5 * kRadiansPerDegree;  // of traces that turn together
// Hardly any trace of a level scanner stays; of a tilted one those of floor and ceiling do.
constexpr double kTiltedShare = 0.15;
constexpr double kLevelShare = 0.1;
// In turns, of which any scanner's traces tell.
constexpr double kOftenAlike = 0.8;
// In clutter, traces are often taken for others; but where nothing that any scanner sees
// stays, less is enough.
constexpr double kNothingStays = 0.02;
constexpr double kAlikeInClutter = 0.4;
constexpr int kManyTurns = 20;
constexpr double kRarelyAlike = 0.25;
// Heights.
const double kMinTilt = std::sin(12.0 * kRadiansPerDegree);  // of a plane that sees heights
constexpr double kMinHeight = 0.2;                           // m, above or below the body
constexpr double kBin = 0.1;                                 // m

struct TurnedTrace {
  double turn_rad = 0.0;
  double length_m = 0.0;
};

// The direction of a trace, modulo half a turn.
double DirectionOf(const SampledSegment& segment) {
  const Eigen::Vector2d along = segment.end - segment.start;
  return std::atan2(along.y(), along.x());
}

double HalfTurn(double angle) { return angle - M_PI * std::round(angle / M_PI); }

// Traces of a line with those of a later one that may be of the same surface.
std::vector<TurnedTrace> MatchTraces(const SampledLine& before, const SampledLine& after) {
  std::vector<TurnedTrace> turned;
  for (const SampledSegment& segment : before.segments) {
    if (segment.length_m() < kMinLength) continue;
    double nearest = 1e9;
    TurnedTrace best;
    for (const SampledSegment& other : after.segments) {
      if (other.length_m() < kMinLength) continue;
      const double turn = HalfTurn(DirectionOf(other) - DirectionOf(segment));
      const double ratio = other.length_m() / segment.length_m();
      if (std::abs(turn) > kMaxTurn || ratio > 2.0 || ratio < 0.5) continue;
      const double distance = (other.At(0.5) - segment.At(0.5)).norm();
      if (distance > nearest) continue;
      nearest = distance;
      best = {turn, std::min(segment.length_m(), other.length_m())};
    }
    if (nearest < 2.0) turned.push_back(best);
  }
  return turned;
}

// The turn that lies in the middle of the length that turned at all.
double CommonTurn(std::vector<TurnedTrace> traces) {
  traces.erase(std::remove_if(traces.begin(),
                              traces.end(),
                              [](const auto& one) { return std::abs(one.turn_rad) < kStill; }),
               traces.end());
  std::sort(traces.begin(), traces.end(), [](const auto& a, const auto& b) {
    return a.turn_rad < b.turn_rad;
  });
  double length = 0.0;
  for (const TurnedTrace& one : traces) length += one.length_m;
  double below = 0.0;
  for (const TurnedTrace& one : traces) {
    below += one.length_m;
    if (below >= 0.5 * length) return one.turn_rad;
  }
  return 0.0;
}

double LengthWithin(const std::vector<TurnedTrace>& traces, double turn_rad, double spread) {
  double length = 0.0;
  for (const TurnedTrace& one : traces) {
    if (std::abs(one.turn_rad - turn_rad) < spread) length += one.length_m;
  }
  return length;
}

// The first line of each step.
std::map<int64_t, const SampledLine*> FirstsOf(const std::vector<SampledLine>& lines,
                                               double step_s) {
  std::map<int64_t, const SampledLine*> firsts;
  for (const SampledLine& line : lines) {
    firsts.emplace(line.stamp_ns / NanosecondsFromSeconds(step_s), &line);
  }
  return firsts;
}

// By step: the traces of the step's first line with those of the next step's.
std::map<int64_t, std::vector<TurnedTrace>> TurnsOf(const std::vector<SampledLine>& lines,
                                                    double step_s) {
  const std::map<int64_t, const SampledLine*> firsts = FirstsOf(lines, step_s);
  std::map<int64_t, std::vector<TurnedTrace>> turns;
  for (const auto& [step, line] : firsts) {
    const auto next = firsts.find(step + 1);
    if (next == firsts.end()) continue;
    turns[step] = MatchTraces(*line, *next->second);
  }
  return turns;
}

// The mean instant at which the traces of a line were seen.
int64_t MeanInstant(const SampledLine& line) {
  int64_t sum_ns = 0;
  for (const SampledSegment& segment : line.segments) {
    sum_ns += line.InstantAt(segment.At(0.5)) - line.stamp_ns;
  }
  return line.stamp_ns +
         sum_ns / std::max<int64_t>(1, static_cast<int64_t>(line.segments.size()));
}

}  // namespace

std::vector<StepTurn> CommonTurns(const std::vector<SampledLine>& lines) {
  std::vector<StepTurn> turns;
  const std::map<int64_t, const SampledLine*> firsts = FirstsOf(lines, kShortStep);
  for (const auto& [step, traces] : TurnsOf(lines, kShortStep)) {
    const double turn = CommonTurn(traces);
    const double all = LengthWithin(traces, 0.0, 10.0);
    if (all < kMinSeen || LengthWithin(traces, turn, kSpread) < kTogether * all) continue;
    turns.push_back({MeanInstant(*firsts.at(step)), MeanInstant(*firsts.at(step + 1)), turn});
  }
  return turns;
}

std::vector<OwnAttitude> JudgeAttitudes(const std::vector<std::vector<SampledLine>>& sample) {
  std::vector<std::map<int64_t, std::vector<TurnedTrace>>> turns;
  std::vector<std::set<int64_t>>
      together;               // by scanner: steps in which most traces turn alike
  std::set<int64_t> turning;  // steps in which any scanner's do
  for (const std::vector<SampledLine>& lines : sample) {
    turns.push_back(TurnsOf(lines, kMotionStep));
    together.emplace_back();
    for (const auto& [step, traces] : turns.back()) {
      const double turn = CommonTurn(traces);
      const double all = LengthWithin(traces, 0.0, 10.0);
      if (std::abs(turn) < kMinTurnRate * kMotionStep || all < kMinSeen) continue;
      if (LengthWithin(traces, turn, kSpread) > kTogether * all) together.back().insert(step);
    }
    turning.insert(together.back().begin(), together.back().end());
  }
  std::vector<OwnAttitude> attitudes;
  for (size_t i = 0; i < sample.size(); ++i) {
    OwnAttitude own;
    double still = 0.0;
    double all = 0.0;
    int num_alike = 0;
    for (const int64_t step : turning) {
      const auto found = turns[i].find(step);
      if (found == turns[i].end() || found->second.empty()) continue;
      ++own.num_turns;
      num_alike += static_cast<int>(together[i].count(step));
      still += LengthWithin(found->second, 0.0, kStill);
      all += LengthWithin(found->second, 0.0, 10.0);
    }
    if (all > 0.0) own.still_share = still / all;
    if (own.num_turns >= kMinSteps) {
      own.alike_share = static_cast<double>(num_alike) / own.num_turns;
      if (own.still_share > kTiltedShare && own.alike_share < kRarelyAlike) {
        own.attitude = Attitude::kTilted;
      } else if (own.still_share < kLevelShare && own.alike_share > kOftenAlike) {
        own.attitude = Attitude::kLevel;
      }
    }
    attitudes.push_back(own);
  }
  const bool nothing_stays =
      std::all_of(attitudes.begin(), attitudes.end(), [](const OwnAttitude& own) {
        return own.num_turns >= kManyTurns && own.still_share < kNothingStays;
      });
  for (OwnAttitude& own : attitudes) {
    if (nothing_stays && own.alike_share > kAlikeInClutter) own.attitude = Attitude::kLevel;
  }
  return attitudes;
}

HeightView FindHeights(const std::vector<SampledLine>& lines, const Scanner& scanner) {
  HeightView view;
  const Eigen::Vector3d normal = scanner.body_from_scanner.rotation * Eigen::Vector3d::UnitZ();
  view.is_tilted = normal.head<2>().norm() > kMinTilt ||
                   (scanner.mount && scanner.mount->axis.cross(normal).norm() > kMinTilt);
  if (!view.is_tilted || lines.empty()) return view;
  std::map<int, std::vector<double>> heights;  // by bin, one entry a line
  for (const SampledLine& line : lines) {
    std::map<int, double> of_line;
    for (const SampledSegment& segment : line.segments) {
      const Rigid3d body_from_scanner = scanner.BodyFromScanner(
          line.InstantAt(segment.At(0.5)) + NanosecondsFromSeconds(scanner.time_offset_s));
      const auto to_body = [&](const Eigen::Vector2d& p) {
        return Eigen::Vector3d(body_from_scanner * Eigen::Vector3d(p.x(), p.y(), 0.0));
      };
      const Eigen::Vector3d along = to_body(segment.end) - to_body(segment.start);
      if (std::abs(along.z()) > std::sin(kParallelAngle) * along.norm() || along.norm() < 0.3)
        continue;
      const double height = to_body(segment.At(0.5)).z();
      if (std::abs(height) < kMinHeight) continue;
      of_line[static_cast<int>(std::lround(height / kBin))] = height;
    }
    for (const auto& [bin, height] : of_line) heights[bin].push_back(height);
  }
  const auto num_lines = static_cast<double>(lines.size());
  for (const bool is_floor : {true, false}) {
    LevelTraces& traces = is_floor ? view.floor : view.ceiling;
    for (const auto& [bin, values] : heights) {
      if ((bin < 0) != is_floor) continue;
      std::vector<double> near = values;
      const auto next = heights.find(bin + 1);
      if (next != heights.end() && (bin + 1 < 0) == is_floor) {
        near.insert(near.end(), next->second.begin(), next->second.end());
      }
      const double share = std::min(1.0, static_cast<double>(near.size()) / num_lines);
      if (share < kSome || share <= traces.share) continue;
      traces = {true, Median(std::move(near)), share};
    }
  }
  return view;
}

}  // namespace plumbline
