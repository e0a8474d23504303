#!/usr/bin/python3
"""Tests scripts/analysis/ablation.py with stand-ins for the programs."""

import pathlib
import re
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "testing"))
# pylint: disable=wrong-import-position
from fake_programs import ROOT, SCRIPTS, ScriptTest

sys.path.insert(0, str(SCRIPTS / "analysis"))
import ablation  # noqa: E402


class AblationTest(ScriptTest):
    script = "analysis/ablation.py"

    def test_counts_what_a_rule_gains_and_loses(self):
        # The stand-in's largest error is 1 cm times the seed, whatever the settings.
        result = self.run_script("bent_walls", "--own-cases", "--seeds", "2", "--first-seed", "5")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("| bent_walls | 4 | 2, 2 | 2, 2 | 0 | 0 | 1.00 |", result.stdout)
        self.assertEqual((self.output / "ablation.md").read_text(), result.stdout)
        self.assertEqual((self.output / "bent_walls.yaml").read_text(),
                         "rules: {bent_walls: false}\n")

    def test_an_unknown_rule_is_an_error(self):
        result = self.run_script("bent_wall")
        self.assertNotEqual(result.returncode, 0)
        self.assertIn("no rule bent_wall", result.stderr)


class SignTestTest(unittest.TestCase):
    def test_is_twice_the_tail_of_fair_tosses(self):
        self.assertEqual(ablation.sign_test(0, 0), 1.0)
        self.assertEqual(ablation.sign_test(3, 3), 1.0)
        self.assertAlmostEqual(ablation.sign_test(8, 1), 2 * (9 + 1) / 512)
        self.assertEqual(ablation.sign_test(8, 1), ablation.sign_test(1, 8))

    def test_a_row_counts_the_runs_of_both(self):
        with_rule = {("a", 1): "right", ("a", 2): "silent", ("b", 1): "right"}
        without = {("a", 1): "flagged", ("a", 2): "right"}
        self.assertEqual(ablation.row_of("x", with_rule, without),
                         ("x", "2", "1, 1", "1, 0", "1", "1", "1.00"))


class RulesTest(unittest.TestCase):
    def test_are_those_of_the_settings(self):
        text = (ROOT / "core/options/config.cc").read_text()
        section = text[text.index('v.Section("rules"'):]
        section = section[:section.index("});")]
        self.assertEqual(sorted(ablation.RULES), sorted(re.findall(r's\.Flag\("(\w+)"', section)))

    def test_have_cases_that_are_there(self):
        names = {path.stem for path in (ROOT / "configs/experiments/robustness").glob("*.yaml")}
        for cases in (*ablation.RULES.values(), ablation.OTHERS):
            self.assertLessEqual(set(cases), names)


if __name__ == "__main__":
    unittest.main()
