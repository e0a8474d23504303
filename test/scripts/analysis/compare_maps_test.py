#!/usr/bin/python3
"""Tests scripts/analysis/compare_maps.py with stand-ins for the programs."""

import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[3] / "scripts" / "analysis" / "compare_maps.py"
MAPS = ("corridor", "office", "room", "robot")
# Writes the files of a result: "extra" and summary entries as the file beside the program says.
PROGRAM = '''#!/usr/bin/python3 -ES
import json, os, pathlib, sys
here = pathlib.Path(sys.argv[0]).parent
setup = json.loads((here / "setup.json").read_text())
flags = dict(argument[2:].split("=", 1) for argument in sys.argv[1:])
output = pathlib.Path(flags["output"])
name = output.name
if name == setup.get("fails"):
    sys.exit("a long story\\nlost track")
output.mkdir()
if "simulate" in sys.argv[0]:
    for file in ("recording.bag", "rig.yaml"):
        (output / file).write_text(flags["experiment"] + flags["seed"])
    sys.exit(0)
for flag in ("recording", "rig", "config"):
    if flag in flags:
        pathlib.Path(flags[flag]).read_bytes()
(output / "map.ply").write_text(name + setup.get("points", {}).get(name, ""))
(output / "config_used.yaml").write_text(str(here))
(output / "summary.json").write_text(json.dumps(dict(
    {"points": 9, "planes": 4, "stages": {"total": os.getpid()}}, **setup.get("summary", {}))))
for file in setup.get("files", []):
    (output / file).write_text("")
'''


class CompareMapsTest(unittest.TestCase):
    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.directory = pathlib.Path(directory.name)

    def write_programs(self, name, **setup):
        directory = self.directory / name
        directory.mkdir()
        (directory / "setup.json").write_text(json.dumps(setup))
        for program in ("plumbline_map", "plumbline_simulate"):
            (directory / program).write_text(PROGRAM)
            (directory / program).chmod(0o755)

    def compare(self, *more):
        return subprocess.run(
            [sys.executable, SCRIPT, "--before", self.directory / "before",
             "--after", self.directory / "after", *more],
            capture_output=True, text=True, check=False)

    def verdicts(self, result):
        """File of a result -> what is said of it."""
        return dict(line.split(maxsplit=1) for line in result.stdout.splitlines()[:-1])

    def test_same_maps(self):
        self.write_programs("before")
        self.write_programs("after")
        result = self.compare()
        self.assertEqual(result.returncode, 0, result.stderr)
        expected = {}
        for name in MAPS:
            expected[f"{name}/map.ply"] = "identical"
            expected[f"{name}/summary.json"] = "same figures"
        self.assertEqual(self.verdicts(result), expected)
        self.assertEqual(result.stdout.splitlines()[-1], "all the same")

    def test_other_points_show(self):
        self.write_programs("before")
        self.write_programs("after", points={"office": "moved"})
        result = self.compare()
        self.assertEqual(result.returncode, 1)
        verdicts = self.verdicts(result)
        self.assertEqual([file for file in verdicts if verdicts[file] == "differs"],
                         ["office/map.ply"])
        self.assertEqual(result.stdout.splitlines()[-1], "not the same")

    def test_file_that_one_does_not_write_shows(self):
        self.write_programs("before", files=["planes.json"])
        self.write_programs("after")
        result = self.compare("--map", "room")
        self.assertEqual(result.returncode, 1)
        self.assertEqual(self.verdicts(result)["room/planes.json"], "not written after")

    def test_figures_of_the_summary(self):
        self.write_programs("before", summary={"planes": 5, "old_name": 1})
        self.write_programs("after", summary={"new_name": 1})
        result = self.compare("--map", "robot")
        self.assertEqual(result.returncode, 1)
        self.assertEqual(self.verdicts(result)["robot/summary.json"],
                         "differs in planes (only one has new_name, old_name)")

    def test_results_can_be_kept(self):
        self.write_programs("before")
        self.write_programs("after")
        output = self.directory / "kept"
        self.assertEqual(self.compare("--map", "room", "--output", output).returncode, 0)
        for kept in ("recordings/room/recording.bag", "before/room/map.ply", "after/room/map.ply"):
            self.assertTrue((output / kept).exists(), kept)

    def test_failures_are_one_line(self):
        self.write_programs("before", fails="corridor")
        self.write_programs("after")
        result = self.compare()
        self.assertEqual(result.returncode, 1)
        self.assertEqual(len(result.stderr.splitlines()), 1)
        self.assertIn("before/plumbline_map: lost track", result.stderr)
        (self.directory / "before" / "plumbline_map").unlink()
        self.assertIn("No such file", self.compare().stderr)

    def test_usage(self):
        result = subprocess.run([sys.executable, SCRIPT, "--help"], capture_output=True,
                                text=True, check=False)
        self.assertEqual(result.returncode, 0)
        self.assertIn("byte by byte", result.stdout)
        self.assertEqual(self.compare("--map", "attic").returncode, 2)


if __name__ == "__main__":
    unittest.main()
