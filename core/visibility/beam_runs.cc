#include "core/visibility/beam_runs.h"

#include <algorithm>
#include <cmath>

#include "core/surface/landmark_view.h"
#include "core/visibility/beam_tests.h"

namespace plumbline {
namespace {

// Largest number of stray beams within one run on a surface.
constexpr int kMaxBeamsBetween = 2;
// A segment on a cylinder bows by at most this: what is compressed of it is right to second
// order.
constexpr double kMaxBow = 0.03;  // m

using Run = BeamAssociation::PlaneBeams;

// Appends a run, or lets the last one go on where it lies on the same surface close by.
void Append(const Run& run, BeamRuns* found) {
  if (found->runs.empty() || found->runs.back().plane != run.plane ||
      run.first_beam - found->runs.back().last_beam > kMaxBeamsBetween + 1) {
    found->runs.push_back(run);
    return;
  }
  Run& last = found->runs.back();
  for (int beam = last.last_beam + 1; beam < run.first_beam; ++beam) {
    found->between.push_back(beam);
  }
  last.last_beam = run.last_beam;
  last.is_last_met = run.is_last_met;
}

// The length of a run along its surface, m: from point to point a few beams apart, since the
// ends of half a circle are as near as those of a chord.
double LengthOf(const ScanLine& scan_line, const Run& run) {
  constexpr int kStride = 8;
  const auto point = [&](int beam) -> Eigen::Vector2d {
    return scan_line.ranges[static_cast<size_t>(beam)] * scan_line.BeamDirection(beam);
  };
  double length_m = 0.0;
  for (int beam = run.first_beam; beam < run.last_beam; beam += kStride) {
    const double step = (point(std::min(beam + kStride, run.last_beam)) - point(beam)).norm();
    if (std::isfinite(step)) length_m += step;
  }
  return length_m;
}

// How many segments a run makes: on a plane one, on an arc chords.
int NumChords(const ScanLine& scan_line, const Run& run) {
  // The bow of a chord is an eighth of the curvature times its squared length.
  const double num_chords =
      std::sqrt(std::abs(run.plane->curvature) / (8.0 * kMaxBow)) * LengthOf(scan_line, run);
  return std::clamp(
      static_cast<int>(std::ceil(num_chords)), 1, run.last_beam - run.first_beam + 1);
}

std::vector<Run> SplitArcs(const ScanLine& scan_line, const std::vector<Run>& runs) {
  std::vector<Run> pieces;
  for (const Run& run : runs) {
    const int num_beams = run.last_beam - run.first_beam + 1;
    const int num_pieces = NumChords(scan_line, run);
    for (int i = 0; i < num_pieces; ++i) {
      pieces.push_back(run);
      pieces.back().first_beam = run.first_beam + num_beams * i / num_pieces;
      pieces.back().last_beam = run.first_beam + num_beams * (i + 1) / num_pieces - 1;
    }
  }
  return pieces;
}

}  // namespace

size_t BeamRuns::RunOf(const Observation& observation,
                       const std::vector<bool>& is_taken) const {
  size_t longest = runs.size();
  int length = 0;
  for (size_t i = 0; i < runs.size(); ++i) {
    const Run& run = runs[i];
    if (is_taken[i] || run.plane->landmark->id != observation.landmark_id ||
        run.last_beam < observation.first_beam || run.first_beam > observation.last_beam ||
        run.last_beam - run.first_beam < length) {
      continue;
    }
    longest = i;
    length = run.last_beam - run.first_beam;
  }
  return longest;
}

BeamRuns FindBeamRuns(const ScanLine& scan_line,
                      const Scanner& scanner,
                      const std::function<ScanPlacement(int beam)>& placement_at,
                      const PlaneSet& surfaces,
                      const std::vector<PlaneOpenings>& openings) {
  BeamRuns found;
  for (int first = 0; first < scan_line.num_beams(); first += kBeamsPerPlacement) {
    const int last = std::min(first + kBeamsPerPlacement, scan_line.num_beams()) - 1;
    const ScanPlacement placement = placement_at((first + last) / 2);
    const BeamAssociation association(
        scan_line, scanner, placement, surfaces, openings, BeamAssociation::Kind::kWholeLine);
    for (const Run& run : association.Associate(first, last)) Append(run, &found);
  }
  found.runs = SplitArcs(scan_line, found.runs);
  return found;
}

}  // namespace plumbline
