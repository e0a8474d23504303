// States how precise a map of an experiment can be at best, without estimating one.

#include <gflags/gflags.h>

#include <iostream>

#include "apps/app.h"
#include "apps/progress.h"
#include "core/options/config.h"
#include "simulation/bound/bound.h"

DEFINE_string(experiment, "", "experiment file (YAML), such as configs/experiments/room.yaml");
DEFINE_string(config, "", "mapper settings (YAML) in place of the experiment's own");
DEFINE_int64(seed,
             -1,
             "estimate from noise of this seed, with every beam on its true plane, which is "
             "the best that "
             "any mapper could do; -1: the bound alone, no noise and no estimation");
DEFINE_string(output, "", "directory for the planes, the trajectory and their covariances");

namespace {

plumbline::Bound Compute() {
  const plumbline::Experiment experiment = plumbline::ReadExperiment(FLAGS_experiment);
  const plumbline::MapperOptions options =
      plumbline::ReadMapperOptions(FLAGS_config.empty() ? FLAGS_experiment : FLAGS_config);
  plumbline::Progress progress("bound");
  const auto report = [&](const auto& state) { progress.Report(state); };
  if (FLAGS_seed < 0) return plumbline::ComputeBound(experiment, options, report);
  return plumbline::EstimateWithTrueAssociations(
      experiment, options, static_cast<uint64_t>(FLAGS_seed), report);
}

}  // namespace

int main(int argc, char** argv) {
  return plumbline::RunApp(
      argc,
      argv,
      "computes the Cramer-Rao bound of an experiment: the standard deviations that planes "
      "and poses can have at best",
      __FILE__,
      {"experiment", "output"},
      [] {
        const plumbline::Bound bound = Compute();
        plumbline::WriteBound(bound, FLAGS_output);
        std::cout << plumbline::BoundTable(bound) << "Written to " << FLAGS_output
                  << ": planes.json, trajectory.tum and their covariances (CSV)"
                  << (bound.calibration.empty() ? "\n" : ", calibration.json\n");
      });
}
