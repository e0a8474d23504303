#!/usr/bin/python3
"""Tests jobs on Dask workers: a scheduler and two workers on this machine."""

import importlib.util
import json
import os
import pathlib
import signal
import subprocess
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "testing"))
# pylint: disable=wrong-import-position
from fake_programs import PATIENCE_S, ScriptTest, wait_until

HAVE_DASK = importlib.util.find_spec("distributed") is not None


@unittest.skipUnless(HAVE_DASK, "Debian's package python3-distributed is not installed")
class ClusterTest(ScriptTest):
    script = "experiments/monte_carlo.py"

    def setUp(self):
        super().setUp()
        self.contact = self.directory / "scheduler.json"
        self.scheduler = self.start("dask_scheduler", "--host", "127.0.0.1", "--port", "0")
        # Dask writes the file in place: only when it is whole do workers come.
        wait_until(lambda: self.scheduler_address() is not None)
        self.address = self.scheduler_address()
        self.workers = {}
        for _ in range(2):
            worker = self.start("dask_worker", "--host", "127.0.0.1", "--nthreads", "1",
                                "--no-nanny")
            self.workers[str(worker.pid)] = worker

    def scheduler_address(self):
        try:
            return json.loads(self.contact.read_text())["address"]
        except (FileNotFoundError, json.JSONDecodeError):
            return None

    def start(self, module, *arguments):
        # Dask itself would do a killed worker's run again. Not here, to see that the script does.
        process = subprocess.Popen(
            [sys.executable, "-m", f"distributed.cli.{module}", "--scheduler-file", self.contact,
             "--no-dashboard", *arguments], cwd=self.directory,
            env={**os.environ, "DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": "0"},
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        return process

    def start_runs(self, runs):
        return self.start_script("room", "--runs", str(runs), "--scheduler", self.address)

    def parents(self):
        return {parent for _, parent in self.attempts()}

    def test_a_killed_worker_loses_nothing(self):
        self.set_control("hold")
        self.set_control("fail_3")
        process = self.start_runs(6)
        wait_until(lambda: len(self.attempts()) == 2)
        self.assertEqual(self.parents(), set(self.workers))
        lost_seed, victim = self.attempts()[0]
        os.kill(int(victim), signal.SIGKILL)
        self.unset_control("hold")
        stdout, stderr = process.communicate(timeout=PATIENCE_S)
        self.assertEqual(process.returncode, 1, stderr)
        self.assertIn("5 runs done, 1 failed", stdout)
        self.assertIn("failed: seed 3: plumbline_map: lost in 3", stdout)
        self.assertEqual([name for name in self.entries() if name.startswith("run_")],
                         ["run_0001", "run_0002", "run_0004", "run_0005", "run_0006"])
        self.assertEqual(self.entries(hidden=True), [])
        # Nothing but the lost run has been begun twice.
        self.assertEqual(self.seeds(), sorted(["1", "2", "3", "4", "5", "6", lost_seed]))
        self.assertFalse(self.programs_running())

    def test_interrupted(self):
        self.set_control("hold")
        process = self.start_runs(3)
        wait_until(lambda: len(self.attempts()) == 2)
        os.killpg(process.pid, signal.SIGINT)
        process.communicate(timeout=PATIENCE_S)
        self.assertEqual(process.returncode, 130)
        wait_until(lambda: not self.programs_running())
        self.unset_control("hold")
        process = self.start_runs(3)
        stdout, stderr = process.communicate(timeout=PATIENCE_S)
        self.assertEqual(process.returncode, 0, stderr)
        self.assertIn("3 runs done, 0 failed", stdout)

    def test_a_lost_scheduler_is_told(self):
        self.set_control("hold")
        process = self.start_runs(3)
        wait_until(lambda: len(self.attempts()) == 2)
        self.scheduler.kill()
        _, stderr = process.communicate(timeout=PATIENCE_S)
        self.assertEqual(process.returncode, 1)
        self.assertIn("lost the Dask scheduler", stderr.splitlines()[-1])
        self.assertEqual(self.entries(), ["setup.json"])


if __name__ == "__main__":
    unittest.main()
