#!/usr/bin/python3
"""Tests scripts/experiments/monte_carlo.py with stand-ins for the programs."""

import json
import os
import pathlib
import signal
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "testing"))
# pylint: disable=wrong-import-position
from fake_programs import PATIENCE_S, SCRIPTS, ScriptTest, wait_until

sys.path.insert(0, str(SCRIPTS / "experiments"))
import job_runner  # noqa: E402

RESULTS = ["evaluation.json", "exit_codes.json", "planes.json", "rig.yaml", "summary.json",
           "trajectory.tum", "trajectory_covariance.csv", "truth_planes.json", "truth_trajectory.tum"]


class MonteCarloTest(ScriptTest):
    script = "experiments/monte_carlo.py"

    def setUp(self):
        super().setUp()
        self.experiment = self.directory / "hall.yaml"
        self.experiment.write_text("building: building.yaml\nrig: rig.yaml\n")
        self.building = self.directory / "building.yaml"
        self.building.write_text("floor_height_m: 0\n")
        (self.directory / "rig.yaml").write_text("scanners: []\n")

    def run_seeds(self, first, runs, *arguments):
        return self.run_script(self.experiment, "--first-seed", str(first), "--runs", str(runs),
                               "--jobs", "2", *arguments)

    def summary(self):
        return json.loads((self.output / "summary.json").read_text())

    def test_keeps_the_small_results_and_summarises(self):
        result = self.run_seeds(5, 3)
        self.check_done(result)
        self.assertEqual(self.entries(), ["run_0005", "run_0006", "run_0007", "setup.json",
                                          "summary.json"])
        self.assertEqual(self.entries(hidden=True), [])
        for run in ("run_0005", "run_0006", "run_0007"):
            names = sorted(path.name for path in (self.output / run).iterdir())
            self.assertEqual(names, RESULTS)
        summary = self.summary()
        self.assertEqual((summary["runs"], summary["failed"]), (3, 0))
        errors = summary["figures"]["position_rmse_unaligned_m"]
        self.assertEqual(errors, {"runs": 3, "min": 0.005, "median": 0.006, "max": 0.007})
        row = [line.split() for line in result.stdout.splitlines() if "unaligned" in line][0]
        self.assertEqual(row, ["position", "RMSE,", "unaligned", "mm", "3", "5.00", "6.00",
                               "7.00"])
        self.assertIn("3 of 3 runs finished", result.stderr)

    def test_finished_runs_are_not_done_again(self):
        self.check_done(self.run_seeds(1, 2))
        self.check_done(self.run_seeds(1, 4))
        self.assertEqual(self.seeds(), ["1", "2", "3", "4"])
        self.assertEqual(self.summary()["runs"], 4)

    def test_failed_runs_are_listed_and_retried_on_demand(self):
        self.set_control("fail_2")
        for _ in range(2):
            result = self.run_seeds(1, 3)
            self.assertEqual(result.returncode, 1)
            self.assertIn("failed: seed 2: plumbline_map: lost in 2", result.stdout)
            self.assertIn("2 runs done, 1 failed", result.stdout)
        self.assertEqual(self.seeds(), ["1", "2", "3"])
        failure = json.loads((self.output / "failed_0002.json").read_text())
        self.assertEqual(failure["seed"], 2)
        self.assertEqual(failure["error"], "plumbline_map: lost in 2")
        self.assertEqual(failure["exit_code"], 1)
        self.assertEqual(failure["stderr"], ["a long story", "plumbline_map: lost in 2"])
        self.assertEqual(self.entries(), ["failed_0002.json", "run_0001", "run_0003",
                                          "setup.json", "summary.json"])
        self.unset_control("fail_2")
        self.check_done(self.run_seeds(1, 3, "--retry-failed"))
        self.assertEqual(self.seeds(), ["1", "2", "2", "3"])
        self.assertNotIn("failed_0002.json", self.entries())
        self.assertEqual(self.summary()["failed"], 0)

    def test_a_map_that_is_not_trusted_is_a_result(self):
        self.set_control("contradict_2")
        result = self.run_seeds(1, 3)
        self.check_done(result)
        self.assertIn("3 runs done, 0 failed", result.stdout)
        self.assertIn("1 of the maps contradict their scans (exit code 3)", result.stdout)
        self.assertEqual(self.summary()["not_trusted"], 1)
        self.assertEqual(self.summary()["figures"]["position_rmse_unaligned_m"]["runs"], 3)

    def test_damaged_files_of_earlier_runs(self):
        self.set_control("fail_2")
        self.run_seeds(1, 4)
        self.unset_control("fail_2")
        (self.output / "failed_0002.json").write_bytes(b"\xff")
        (self.output / "failed_0009.json").write_text("{}")
        (self.output / "run_0003" / "evaluation.json").unlink()
        (self.output / "run_0004" / "summary.json").write_text("{")
        (self.output / "run_0005").mkdir()
        result = self.run_seeds(1, 5)
        self.assertEqual(result.returncode, 1)
        self.assertNotIn("Traceback", result.stderr)
        self.assertEqual(self.seeds(), ["1", "2", "2", "3", "4", "5"])
        summary = self.summary()
        self.assertEqual(summary["runs"], 3)
        self.assertEqual(summary["damaged"], ["run_0003", "run_0004"])
        for text in ("failed_0002.json", "failed_0009.json", "run_0003 is damaged",
                     "run_0004 is damaged", "run_0005 is empty"):
            lines = [line for line in result.stderr.splitlines() if text in line]
            self.assertEqual(len(lines), 1, result.stderr)

    def test_a_missing_result_is_a_failure(self):
        self.set_control("forget_planes")
        result = self.run_seeds(1, 1)
        self.assertEqual(result.returncode, 1)
        self.assertIn("did not write result/planes.json", result.stdout)
        self.assertNotIn("run_0001", self.entries())

    def stop_in_the_middle(self, number):
        """Does run 1, and is ended by a signal while it is at 2 and 3 of 4."""
        self.check_done(self.run_seeds(1, 1))
        self.set_control("hold")
        process = self.start_script(self.experiment, "--runs", "4", "--jobs", "2")
        wait_until(lambda: len(self.attempts()) == 3)
        self.assertEqual(self.entries(), ["run_0001", "setup.json", "summary.json"])
        self.assertTrue(self.programs_running())
        os.killpg(process.pid, number)
        process.wait(PATIENCE_S)
        wait_until(lambda: not self.programs_running())
        self.assertEqual(self.entries(), ["run_0001", "setup.json", "summary.json"])
        return process

    def check_goes_on(self):
        self.unset_control("hold")
        self.check_done(self.run_seeds(1, 4))
        self.assertEqual(self.seeds(), ["1", "2", "2", "3", "3", "4"])
        self.assertEqual(self.summary()["runs"], 4)
        self.assertEqual(self.entries(hidden=True), [])

    def test_interrupted(self):
        process = self.stop_in_the_middle(signal.SIGINT)
        self.assertEqual(process.returncode, 130)
        self.assertIn("interrupted", process.stderr.read())
        self.assertEqual(self.entries(hidden=True), [])
        self.check_goes_on()

    def test_killed(self):
        self.stop_in_the_middle(signal.SIGKILL)
        self.assertNotEqual(self.entries(hidden=True), [])
        self.check_goes_on()

    def test_a_second_script_is_refused(self):
        self.set_control("hold")
        self.start_script(self.experiment, "--runs", "1")
        wait_until(self.attempts)
        self.check_error("another script", self.experiment, "--runs", "1")

    def test_other_setups_are_not_mixed(self):
        self.check_done(self.run_seeds(1, 1))
        stored = json.loads((self.output / "setup.json").read_text())
        self.assertEqual(stored["experiment"]["name"], "hall")
        config = self.directory / "config.yaml"
        config.write_text("window: {}\n")
        self.check_error("another config", self.experiment, "--config", config)
        self.check_error("another experiment and config", "room")
        self.building.write_text("floor_height_m: 1\n")
        self.check_error("another experiment", self.experiment)
        self.assertEqual(self.seeds(), ["1"])

    def check_mixture(self, result, num_builds):
        self.check_done(result)
        self.assertIn(f"mixes results of {num_builds} builds", result.stderr)

    def test_another_build_is_accepted_only_on_demand(self):
        self.set_control("version", "plumbline 1.0")
        self.check_done(self.run_seeds(1, 1))
        self.set_control("version", "plumbline 2.0")
        self.check_error("another build (plumbline 1.0, now plumbline 2.0)", self.experiment)
        self.check_mixture(self.run_seeds(1, 2, "--accept-other-build"), 2)
        self.check_mixture(self.run_seeds(1, 3), 2)
        stored = json.loads((self.output / "setup.json").read_text())
        self.assertEqual(stored["version"]["plumbline_map"], "plumbline 2.0")
        self.assertEqual([build["version"]["plumbline_map"] for build in stored["earlier_builds"]],
                         ["plumbline 1.0"])
        self.set_control("version", "plumbline 1.0")  # it is no longer the newest of the two
        self.check_error("another build", self.experiment)
        self.check_mixture(self.run_seeds(1, 4, "--accept-other-build"), 2)
        self.assertEqual(self.seeds(), ["1", "2", "3", "4"])
        config = self.directory / "config.yaml"
        config.write_text("window: {}\n")
        self.check_error("another config", self.experiment, "--config", config,
                         "--accept-other-build")

    def test_programs_of_one_version_are_told_apart(self):
        self.check_done(self.run_seeds(1, 1))
        with open(self.binaries / "plumbline_map", "a", encoding="utf-8") as program:
            program.write("# built again\n")
        self.check_error("another plumbline_map of the same version", self.experiment)

    def test_directories_of_others_are_left_alone(self):
        (self.output / "run_0001").mkdir(parents=True)
        self.check_error("setup.json", self.experiment)

    def test_errors(self):
        self.check_error("no experiment no_such", "no_such")
        self.check_error("no_such.yaml", self.experiment, "--config", "no_such.yaml")
        self.building.unlink()
        self.check_error("building.yaml", self.experiment)
        self.experiment.write_text("[")
        self.check_error("hall.yaml", self.experiment)
        (self.binaries / "plumbline_map").unlink()
        self.check_error("plumbline_map", "room")
        self.assertFalse(self.output.exists())

    def test_without_dask(self):
        (self.directory / "distributed.py").write_text("raise ImportError")
        result = self.run_script(self.experiment, "--scheduler", "tcp://127.0.0.1:1",
                                 env={**os.environ, "PYTHONPATH": str(self.directory)})
        self.assertEqual(result.returncode, 1)
        self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
        self.assertIn("python3-distributed", result.stderr)

    def test_usage(self):
        self.check_usage_error()
        self.check_usage_error("room", "--runs", "0")
        self.check_usage_error("room", "--first-seed", "one")
        self.check_usage_error("room", "--jobs", "2", "--scheduler", "tcp://127.0.0.1:1")
        self.assertEqual(self.run_script("--help").returncode, 0)


class PublishTest(ScriptTest):
    def make_job(self, text):
        return job_runner.Job(destination=self.output / "run_0001",
                              commands=(("sh", "-c", f"echo {text} > text"),),
                              required=("text",))

    def test_the_first_of_two_attempts_stays(self):
        with job_runner.WorkDirectory(self.output) as work:
            self.assertIsNone(job_runner.run_job(self.make_job("first"), work))
            self.assertIsNone(job_runner.run_job(self.make_job("second"), work))
        self.assertEqual((self.output / "run_0001" / "text").read_text(), "first\n")
        self.assertEqual(self.entries(hidden=True), [])

    def test_an_attempt_whose_work_is_taken_away_gives_up(self):
        with job_runner.WorkDirectory(self.output) as work:
            pass
        with self.assertRaises(job_runner.GivenUp):
            job_runner.run_job(self.make_job("late"), work)
        self.assertEqual(self.entries(), [])

    def test_a_program_ended_by_a_signal(self):
        job = job_runner.Job(destination=self.output / "run_0001",
                             commands=(("sh", "-c", "kill -SEGV $$"),), required=())
        with job_runner.WorkDirectory(self.output) as work:
            failure = job_runner.run_job(job, work)
        self.assertEqual(failure["error"], f"sh was ended by signal {signal.SIGSEGV.value}")


if __name__ == "__main__":
    unittest.main()
