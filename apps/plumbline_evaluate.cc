// Holds a result of plumbline_map against the truth of plumbline_simulate.

#include <gflags/gflags.h>

#include <iostream>

#include "apps/app.h"
#include "simulation/evaluation/evaluation.h"

DEFINE_string(result, "", "directory that plumbline_map wrote");
DEFINE_string(truth, "", "directory that plumbline_simulate wrote");
DEFINE_string(output, "", "JSON file for the evaluation; without it, the table only");

int main(int argc, char** argv) {
  return plumbline::RunApp(
      argc,
      argv,
      "errors of a map and a trajectory against the simulated truth",
      __FILE__,
      {"result", "truth"},
      [] {
        const plumbline::Evaluation evaluation =
            plumbline::Evaluate(plumbline::ReadEvaluationInput(FLAGS_result, FLAGS_truth), {});
        if (!FLAGS_output.empty()) plumbline::WriteEvaluation(evaluation, FLAGS_output);
        std::cout << plumbline::EvaluationTable(evaluation);
      });
}
