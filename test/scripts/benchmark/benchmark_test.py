#!/usr/bin/python3
"""Tests scripts/benchmark/benchmark.py with stand-ins for the programs."""

import json
import pathlib
import re
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "testing"))
# pylint: disable=wrong-import-position
from fake_programs import PATIENCE_S, ROOT, ScriptTest, wait_until

GROUPS = ("jobs", "factors", "threads", "long")


def marked(group, text=""):
    return f"<!-- begin {group} -->\n{text}<!-- end {group} -->\n"


class BenchmarkTest(ScriptTest):
    script = "benchmark/benchmark.py"

    def setUp(self):
        super().setUp()
        self.document = self.directory / "performance.md"
        self.document.write_text(
            "prose\n" + "more prose\n".join(marked(group, "old\n") for group in GROUPS))

    def measure(self, *arguments):
        return self.run_script("--document", self.document, *arguments)

    def results(self):
        return json.loads((self.output / "benchmark.json").read_text())

    def table(self, group):
        """The cells of the rows below the header of a group's table."""
        text = re.search(rf"<!-- begin {group} -->\n(.*?)<!-- end {group} -->",
                         self.document.read_text(), re.DOTALL).group(1)
        rows = [line for line in text.splitlines() if line.startswith("|")]
        return [[cell.strip() for cell in row.strip("|").split("|")] for row in rows[2:]]

    def test_measures_and_fills_in_the_tables(self):
        result = self.measure("--repeat", "2")
        self.check_done(result)
        cases = self.results()["cases"]
        self.assertEqual({case["group"] for case in cases.values()}, set(GROUPS) - {"long"})
        for case in cases.values():
            self.assertEqual(len(case["runs"]), 2)
            median = case["median"]
            self.assertAlmostEqual(median["wall_s"],
                                   sum(run["wall_s"] for run in case["runs"]) / 2)
            self.assertAlmostEqual(median["real_time_factor"], 1 / median["wall_s"])
            self.assertGreater(median["peak_memory_mb"], 1.0)
        self.assertEqual([row[0] for row in self.table("jobs")],
                         ["corridor, 270 beams", "corridor, 1080 beams", "office, 270 beams",
                          "office, 1080 beams"])
        self.assertEqual([row[3:6] for row in self.table("factors")],
                         [["0.40", "0.10", "4.0"]] * 2)
        self.assertEqual([row[4] for row in self.table("threads")], ["yes"] * 2)
        text = self.document.read_text()
        self.assertTrue(text.startswith("prose\n"))
        self.assertEqual(text.count("more prose"), 3)
        self.assertIn(marked("long", "old\n"), text)
        self.assertEqual(text.count("old\n"), 1)
        self.assertEqual(self.entries(hidden=True), [])

    def test_threads_that_change_the_bytes_are_told(self):
        self.set_control("threads_matter")
        self.check_done(self.measure("--group", "threads", "--repeat", "1"))
        self.assertEqual([row[4] for row in self.table("threads")], ["**no**"] * 2)

    def test_the_large_building_only_on_request(self):
        self.check_done(self.measure("--group", "threads", "--long", "--repeat", "1"))
        self.assertEqual(len(self.table("long")), 4)
        lengths = [case["recording"]["length_m"] for case in self.results()["cases"].values()
                   if case["group"] == "long"]
        self.assertEqual(lengths, [300.0, 600.0, 1200.0, 3600.0])
        self.check_done(self.measure("--group", "long", "--long", "10", "--repeat", "1"))
        self.assertEqual([row[:2] for row in self.table("long")], [["0", "270"]] * 2)
        self.assertEqual(len(self.results()["cases"]), 2)
        self.check_done(self.measure("--group", "long", "--long", "5", "--dense",
                                     "--repeat", "1"))
        self.assertEqual([row[1] for row in self.table("long")], ["270", "1080"])

    def test_recordings_are_kept_for_the_next_time(self):
        self.check_done(self.measure("--group", "threads", "--repeat", "1"))
        recordings = sorted((self.output / "recordings").iterdir())
        self.assertEqual(len(recordings), 2)
        (recordings[0] / "recording.bag").write_text("kept")
        self.check_done(self.measure("--group", "threads", "--repeat", "1"))
        self.assertEqual(sorted((self.output / "recordings").iterdir()), recordings)
        self.assertIn("kept", self.seeds())

    def test_failures_are_listed_and_the_rest_measured(self):
        self.set_control("fail_1")
        before = self.document.read_text()
        result = self.measure("--group", "threads")
        self.assertEqual(result.returncode, 1)
        self.assertIn("failed: corridor, 1 thread: plumbline_map: lost in 1", result.stdout)
        self.assertEqual(self.results()["cases"], {})
        self.assertEqual(len(self.results()["failed"]), 4)
        self.assertEqual(len(self.seeds()), 4)
        self.assertEqual(self.document.read_text(), before)

    def test_an_interruption_leaves_nothing_half_done(self):
        self.set_control("hold")
        before = self.document.read_text()
        process = self.start_script("--document", self.document, "--group", "jobs")
        wait_until(self.attempts)
        process.terminate()
        self.assertEqual(process.wait(PATIENCE_S), 130)
        self.assertFalse(self.programs_running())
        self.assertEqual(self.entries(), ["recordings"])
        self.assertEqual(self.entries(hidden=True), [])
        self.assertEqual(self.document.read_text(), before)

    def test_errors(self):
        self.check_error("nowhere.md", "--document", self.directory / "nowhere.md")
        (self.binaries / "plumbline_map").unlink()
        self.check_error("no plumbline_map", "--document", self.document)

    def test_the_shipped_document_has_a_place_for_every_table(self):
        text = (ROOT / "docs" / "performance.md").read_text()
        for group in GROUPS:
            self.assertRegex(text, rf"(?s)<!-- begin {group} -->\n.*<!-- end {group} -->")

    def test_usage(self):
        self.check_usage_error("--repeat", "0")
        self.check_usage_error("--group", "none")
        self.check_usage_error("--core", "100000")
        self.check_usage_error("--long", "1")
        self.assertEqual(self.run_script("--help").returncode, 0)


if __name__ == "__main__":
    unittest.main()
