#!/usr/bin/python3
"""Tests scripts/experiments/check_cases.py with stand-ins for the programs."""

import json
import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "testing"))
# pylint: disable=wrong-import-position
from fake_programs import SCRIPTS, ScriptTest

sys.path.insert(0, str(SCRIPTS / "experiments"))
import check_cases  # noqa: E402
import experiment_files  # noqa: E402

CHECK = '''#!/usr/bin/python3
import json, pathlib, sys
if "--version" in sys.argv:
    sys.exit(2)
flags = dict(argument[2:].split("=", 1) for argument in sys.argv[1:])
seed = int(pathlib.Path(flags["recording"]).read_text())
findings = [dict(severity="note", subject="", sentence="a note")]
if seed % 2 == 0:
    findings.append(dict(severity="stop", subject="", sentence="scanner top is mirrored | so"))
pathlib.Path(flags["output"]).mkdir()
(pathlib.Path(flags["output"]) / "check.json").write_text(
    json.dumps(dict(mappable="in_3d", findings=findings)))
sys.exit(3 if seed % 2 == 0 else 0)
'''


class CheckCasesTest(ScriptTest):
    script = "experiments/check_cases.py"

    def setUp(self):
        super().setUp()
        program = self.binaries / "plumbline_check"
        program.write_text(CHECK)
        program.chmod(0o755)

    def test_says_of_each_run_what_was_told(self):
        result = self.run_script("mirrored", "room", "--first-seed", "1", "--seeds", "2")
        self.assertEqual(result.returncode, 0, result.stderr)
        rows = json.loads((self.output / "check_cases.json").read_text())
        self.assertEqual([row["outcome"] for row in rows],
                         ["not told", "told", "clear", "alarm"])
        self.assertIn("| `mirrored` | 2 | 1 told, 1 not told | scanner top is mirrored / so |",
                      result.stdout)
        self.assertIn("1 told, 1 not told, 1 clear, 1 alarm", result.stdout)

    def test_unknown_case(self):
        result = self.run_script("no_such_case")
        self.assertEqual(result.returncode, 1)
        self.assertIn("no case no_such_case", result.stderr)


class OutcomeTest(unittest.TestCase):
    FAULT = {"severity": "warning", "subject": "/left_scan",
             "sentence": "scanner left seems to be stamped 49 ms too late"}
    OTHER = {"severity": "warning", "subject": "/top_scan", "sentence": "is frozen"}

    def test_the_fault_alone_is_told(self):
        self.assertEqual(check_cases.outcome_of("clock_50_ms", 0, [self.FAULT]), "told")
        self.assertEqual(check_cases.outcome_of("clock_50_ms", 0, [self.FAULT, self.OTHER]),
                         "in doubt")

    def test_other_words_or_exit_codes_are_not(self):
        self.assertEqual(check_cases.outcome_of("clock_50_ms", 0, [self.OTHER]), "not told")
        self.assertEqual(check_cases.outcome_of("clock_50_ms", 3, [self.FAULT]), "not told")
        twenty = {**self.FAULT, "sentence": "stamped 20 ms too late"}
        self.assertEqual(check_cases.outcome_of("clock_50_ms", 0, [twenty]), "not told")

    def test_good_worlds(self):
        self.assertEqual(check_cases.outcome_of("room", 0, []), "clear")
        self.assertEqual(check_cases.outcome_of("room", 0, [self.OTHER]), "alarm")

    def test_all_cases_exist(self):
        for case in (*check_cases.FAULTS, *check_cases.GOOD):
            self.assertTrue(experiment_files.of_case(case).exists())


if __name__ == "__main__":
    unittest.main()
