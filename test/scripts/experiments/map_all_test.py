#!/usr/bin/python3
"""Tests scripts/experiments/map_all.py with stand-ins for the programs."""

import json
import pathlib
import signal
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "testing"))
# pylint: disable=wrong-import-position
from fake_programs import PATIENCE_S, ScriptTest, wait_until

RESULTS = ["config_used.yaml", "map.ply", "planes.json", "summary.json", "trajectory.tum",
           "trajectory_covariance.csv"]


class MapAllTest(ScriptTest):
    script = "experiments/map_all.py"

    def setUp(self):
        super().setUp()
        self.folder = self.directory / "recordings"
        self.rig = self.directory / "common_rig.yaml"
        self.rig.write_text(" common")
        for name in ("hall", "attic/one", "attic/two"):
            self.add_recording(name)
        (self.folder / "attic" / "rig.yaml").write_text(" of the attic")
        (self.folder / "notes.txt").write_text("not a recording")

    def add_recording(self, name):
        path = self.folder / f"{name}.bag"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(path.stem)

    def map_all(self, *arguments):
        return self.run_script(self.folder, "--rig", self.rig, "--jobs", "2", *arguments)

    def test_maps_every_recording_with_its_rig(self):
        result = self.map_all()
        self.check_done(result)
        self.assertEqual(self.entries(), ["attic_one", "attic_two", "hall", "setup.json",
                                          "summary.json"])
        self.assertEqual(self.entries(hidden=True), [])
        for name, rig in (("hall", "common"), ("attic_one", "of the attic")):
            directory = self.output / name
            self.assertEqual(sorted(path.name for path in directory.iterdir()), RESULTS)
            self.assertEqual((directory / "config_used.yaml").read_text(),
                             f"config_used.yaml {rig}")
        self.assertIn("3 recordings mapped, 0 failed", result.stdout)
        row = [line.split() for line in result.stdout.splitlines() if "hall" in line][0]
        self.assertEqual(row, ["hall", "1.0", "4", "20.00", "1.00", "5.0", "0", "-"])

    def test_goes_on_when_a_batch_system_has_ended_it(self):
        self.set_control("hold")
        process = self.start_script(self.folder, "--rig", self.rig, "--jobs", "1")
        wait_until(self.attempts)
        process.send_signal(signal.SIGTERM)
        self.assertEqual(process.wait(PATIENCE_S), 130)
        self.assertFalse(self.programs_running())
        self.assertEqual(self.entries(), ["setup.json"])
        self.unset_control("hold")
        self.check_done(self.map_all())
        self.check_done(self.map_all())
        self.assertEqual(self.seeds(), ["hall", "one", "one", "two"])

    def test_failures_are_listed_and_new_recordings_mapped(self):
        self.set_control("fail_two")
        self.assertEqual(self.map_all().returncode, 1)
        self.add_recording("cellar")
        result = self.map_all()
        self.assertEqual(result.returncode, 1)
        self.assertIn("failed: attic/two.bag: plumbline_map: lost in two", result.stdout)
        self.assertEqual(self.seeds(), ["cellar", "hall", "one", "two"])
        summary = json.loads((self.output / "summary.json").read_text())
        self.assertEqual(sorted(summary["recordings"]), ["attic_one", "cellar", "hall"])
        self.assertEqual(summary["failed"], 1)
        failure = json.loads((self.output / "failed_attic_two.json").read_text())
        self.assertEqual(failure["recording"], "attic/two.bag")
        self.unset_control("fail_two")
        self.check_done(self.map_all("--retry-failed"))

    def test_other_settings_are_not_mixed(self):
        self.check_done(self.map_all())
        config = self.directory / "config.yaml"
        config.write_text("window: {}\n")
        self.check_error("another config", self.folder, "--rig", self.rig, "--config", config)
        self.rig.write_text("moved")
        self.check_error("another rig", self.folder, "--rig", self.rig)

    def test_a_map_in_parts_and_one_that_is_not_trusted_are_kept(self):
        self.set_control("parts_hall")
        self.set_control("contradict_one")
        self.check_done(self.map_all())
        self.assertEqual((self.output / "hall" / "part_2" / "map.ply").read_text(), "part")
        self.assertTrue((self.output / "attic_one" / "map.ply").exists())

    def test_odd_names(self):
        for name in ("..bag", "setup.json.bag"):
            (self.folder / name).write_text(name)
        (self.folder / "directory.bag").mkdir()
        (self.folder / "nowhere.bag").symlink_to("nowhere")
        self.check_done(self.map_all())
        self.assertEqual(self.entries(), ["_", "attic_one", "attic_two", "hall", "setup.json",
                                          "setup.json_", "summary.json"])
        self.check_done(self.map_all())
        self.assertEqual(len(self.seeds()), 5)
        (self.folder / "....bag").write_text("the same name")
        self.check_error("would both become _", self.folder, "--rig", self.rig)

    def test_other_formats(self):
        for name in ("a.mcap", "b.db3", "c.clf.bz2", "d.bag.zstd", "notes.txt"):
            (self.folder / name).write_text(name)
        folder = self.folder / "walk"
        folder.mkdir()
        (folder / "metadata.yaml").write_text("")
        (folder / "walk_0.db3").write_text("")
        self.check_done(self.map_all())
        self.assertEqual(self.entries(), ["a", "attic_one", "attic_two", "b", "c", "d", "hall",
                                          "setup.json", "summary.json", "walk"])

    def test_damaged_files_of_earlier_runs(self):
        self.set_control("fail_two")
        self.map_all()
        self.unset_control("fail_two")
        (self.output / "failed_attic_two.json").write_text('{"recording"')
        (self.output / "hall" / "summary.json").write_text("[]")
        for path in (self.output / "attic_one").iterdir():
            path.unlink()
        result = self.map_all()
        self.assertEqual(result.returncode, 1)
        self.assertEqual(self.seeds(), ["hall", "one", "one", "two", "two"])
        for text in ("failed_attic_two.json", "hall is damaged", "attic_one is empty"):
            lines = [line for line in result.stderr.splitlines() if text in line]
            self.assertEqual(len(lines), 1, result.stderr)
        self.assertNotIn("Traceback", result.stderr)
        summary = json.loads((self.output / "summary.json").read_text())
        self.assertEqual(summary["damaged"], ["hall"])
        self.assertEqual(sorted(summary["recordings"]), ["attic_one", "attic_two"])
        for text in ("", "[]"):
            (self.output / "setup.json").write_text(text)
            self.check_error("setup.json", self.folder, "--rig", self.rig)

    def test_errors(self):
        self.check_error("hall.bag", self.folder)
        self.check_error("nowhere", self.folder / "nowhere")
        self.check_error("no_rig.yaml", self.folder, "--rig", "no_rig.yaml")
        self.add_recording("attic_one")
        self.check_error("attic_one", self.folder, "--rig", self.rig)
        self.check_error("no *.bag", self.binaries)
        self.assertFalse(self.output.exists())

    def test_usage(self):
        self.check_usage_error()
        self.check_usage_error(self.folder, "--jobs", "0")
        self.assertEqual(self.run_script("--help").returncode, 0)


if __name__ == "__main__":
    unittest.main()
