#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "core/mapping/mapper.h"
#include "core/sensor/rig.h"

namespace plumbline {

class EstimationProblem;

// The start of a shipped experiment, simulated and mapped: what single steps of the mapper are
// timed on.
class MappedWalk {
 public:
  // experiment: its name; length_m: how far along its path; factor: of the batch, kPoint also
  // keeps the single beams.
  MappedWalk(const std::string& experiment, double length_m, FactorKind factor);
  ~MappedWalk();
  MappedWalk(const MappedWalk&) = delete;
  MappedWalk& operator=(const MappedWalk&) = delete;

  const Rig& rig() const { return rig_; }
  const MapperOptions& options() const { return options_; }
  const MapResult& result() const { return *result_; }
  std::string recording() const { return (directory_ / "recording.bag").string(); }
  double scan_period_s() const { return scan_period_s_; }

  // The batch's last problem over a copy of the mapped state, which outlives it.
  std::unique_ptr<EstimationProblem> BatchProblem(FactorKind factor, MapState* state) const;

 private:
  std::filesystem::path directory_;  // of the simulated files; removed at the end
  Rig rig_;
  MapperOptions options_;
  double scan_period_s_ = 0.0;
  std::unique_ptr<MapResult> result_;
};

// Each is made when it is first asked for.
const MappedWalk& CorridorWalk();                       // few planes
const MappedWalk& OfficeWalk();                         // many planes
const MappedWalk& WalkWithSinglePoints();               // short, in the corridor
const MappedWalk& WalkByName(const std::string& name);  // "corridor" or "office"

}  // namespace plumbline
