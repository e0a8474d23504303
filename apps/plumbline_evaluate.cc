// Compares a result of plumbline_map with the truth of plumbline_simulate.

#include <gflags/gflags.h>

#include <iostream>

#include "apps/app.h"
#include "simulation/evaluation/evaluation.h"

DEFINE_string(result, "", "directory that plumbline_map wrote");
DEFINE_string(truth, "", "directory that plumbline_simulate wrote");
DEFINE_string(output, "", "JSON file for the errors; without it, they are only printed");

int main(int argc, char** argv) {
  return plumbline::RunApp(
      argc,
      argv,
      "compares a map and its trajectory with the simulated truth",
      __FILE__,
      {"result", "truth"},
      [] {
        const plumbline::Evaluation evaluation =
            plumbline::Evaluate(plumbline::ReadEvaluationInput(FLAGS_result, FLAGS_truth), {});
        if (!FLAGS_output.empty()) plumbline::WriteEvaluation(evaluation, FLAGS_output);
        std::cout << plumbline::EvaluationTable(evaluation);
        if (!FLAGS_output.empty()) std::cout << "Written to " << FLAGS_output << '\n';
      });
}
