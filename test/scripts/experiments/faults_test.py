#!/usr/bin/python3
"""Tests scripts/experiments/faults.py with stand-ins for the programs."""

import json
import pathlib
import sys
import unittest

import yaml

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "testing"))
# pylint: disable=wrong-import-position
from fake_programs import SCRIPTS, ScriptTest

sys.path.insert(0, str(SCRIPTS / "experiments"))
sys.path.insert(0, str(SCRIPTS / "recordings"))
import driver_faults  # noqa: E402
import experiment_files  # noqa: E402
import faults  # noqa: E402

CHECK = '''#!/usr/bin/python3
import json, pathlib, sys
if "--version" in sys.argv:
    sys.exit(2)
flags = dict(argument[2:].split("=", 1) for argument in sys.argv[1:])
seed = int(pathlib.Path(flags["recording"]).read_text())
findings = [dict(severity="note", sentence="a note")]
if seed > 1:
    findings.append(dict(severity=["warning", "stop"][seed % 2], sentence="is | so"))
pathlib.Path(flags["output"]).mkdir()
(pathlib.Path(flags["output"]) / "check.json").write_text(json.dumps(dict(findings=findings)))
sys.exit(3 if seed == 3 else 0)
'''
# The first seed is named rightly, the second not at all, the third stops with an error.
MAP = '''#!/usr/bin/python3
import json, pathlib, sys
if "--version" in sys.argv:
    sys.exit(2)
flags = dict(argument[2:].split("=", 1) for argument in sys.argv[1:])
seed = int(pathlib.Path(flags["recording"]).read_text())
if seed == 3:
    sys.exit("plumbline_map: scanner top is mirrored")
pathlib.Path(flags["output"]).mkdir()
(pathlib.Path(flags["output"]) / "summary.json").write_text(json.dumps(dict(
    consistency=dict(verdict="doubtful" if seed == 1 else "consistent"), warnings=["a warning"],
    **(dict(cause=dict(name="a cause", evidence="is mirrored")) if seed == 1 else dict()))))
sys.exit(0)
'''


class FaultsTest(ScriptTest):
    script = "experiments/faults.py"

    def setUp(self):
        super().setUp()
        for name, text in (("plumbline_check", CHECK), ("plumbline_map", MAP)):
            program = self.binaries / name
            program.write_text(text)
            program.chmod(0o755)

    def test_says_of_each_run_what_was_named(self):
        result = self.run_script("mirrored", "room", "--first-seed", "1", "--seeds", "3")
        self.assertEqual(result.returncode, 0, result.stderr)
        rows = json.loads((self.output / "faults.json").read_text())
        outcomes = {(row["recording"], row["seed"]): row["outcome"] for row in rows
                    if row["case"] == "mirrored"}
        for recording in faults.SCANNERS:
            self.assertEqual([outcomes[recording, seed] for seed in (1, 2, 3)],
                             ["true", "silent", "true"])
        self.assertEqual([row["outcome"] for row in rows if row["case"] == "room"],
                         ["clear", "warned", "stopped"])
        self.assertIn("| `room` | room | 3 | stopped |  | is / so |", result.stdout)
        self.assertIn("9 faulty recordings: 6 true, 3 silent", result.stdout)
        self.assertIn("3 good recordings: 1 clear, 1 warned, 1 stopped", result.stdout)

    def test_experiments_hold_the_fault(self):
        result = self.run_script("turned_10_deg", "--first-seed", "1", "--seeds", "1")
        self.assertEqual(result.returncode, 0, result.stderr)
        folder = self.output / "experiments"
        experiment = yaml.safe_load((folder / "turned_10_deg_office_orthogonal.yaml").read_text())
        self.assertEqual(experiment["path"]["length_m"], 18.0)
        self.assertTrue(pathlib.Path(experiment["building"]).is_file())
        self.assertEqual(experiment["faults"]["scanners"][0]["name"], "along")
        slow = yaml.safe_load((folder / "turned_10_deg_room_slow_rig.yaml").read_text())
        self.assertEqual({scanner["scan_rate_hz"] for scanner in slow["scanners"]}, {10.0})

    def test_unknown_case(self):
        result = self.run_script("no_such_case")
        self.assertEqual(result.returncode, 1)
        self.assertIn("no case no_such_case", result.stderr)


class OutcomeTest(unittest.TestCase):
    def test_the_first_cause_counts(self):
        self.assertEqual(faults.outcome_of("frozen", ["is frozen", "other"], "doubtful"), "true")
        self.assertEqual(faults.outcome_of("frozen", ["other", "is frozen"], "doubtful"),
                         "behind")
        self.assertEqual(faults.outcome_of("frozen", ["other"], "contradictory"), "other")
        self.assertEqual(faults.outcome_of("frozen", ["other"], None), "other")

    def test_a_consistent_map_without_a_word_is_silent(self):
        self.assertEqual(faults.outcome_of("frozen", [], "consistent"), "silent")
        self.assertEqual(faults.outcome_of("frozen", ["other"], "consistent"), "silent")

    def test_all_faults_can_be_made_and_all_worlds_exist(self):
        for name, fault in faults.FAULTS.items():
            self.assertTrue(fault.simulated is not None or name in driver_faults.FAULTS, name)
        for recording in (*faults.SCANNERS.values(), *faults.WHEELS.values()):
            self.assertTrue(experiment_files.of_case(recording.experiment).exists())
        for case in faults.GOOD:
            self.assertTrue(experiment_files.of_case(case).exists())


if __name__ == "__main__":
    unittest.main()
