#!/usr/bin/python3
"""Tests scripts/benchmark/benchmark.py with stand-ins for the programs."""

import json
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "testing"))
# pylint: disable=wrong-import-position
from fake_programs import PATIENCE_S, ROOT, ScriptTest, wait_until

sys.path += [str(ROOT / "scripts" / folder) for folder in ("benchmark", "experiments")]
import comparison
import job_runner

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


class ComparisonTest(ScriptTest):
    script = "benchmark/benchmark.py"

    def setUp(self):
        super().setUp()
        self.other = self.directory / "other"
        self.other.mkdir()
        self.set_other(f'exec {self.binaries}/plumbline_map "$@"')

    def set_other(self, last_line):
        """The other build: tells of each run beside the first build's attempts."""
        program = self.other / "plumbline_map"
        program.write_text("#!/bin/sh\n"
                           'if [ "$1" = --version ]; then echo other 1; exit; fi\n'
                           f"echo other 0 >> {self.control}/attempts\n{last_line}\n")
        program.chmod(0o755)

    def compare(self, *arguments):
        return self.run_script("--against-bin", self.other, *arguments)

    def results(self):
        return json.loads((self.output / "against.json").read_text())

    def test_two_builds_take_turns(self):
        result = self.compare("--repeat", "2", "--case", "office, 270")
        self.check_done(result)
        self.assertEqual([seed for seed, _ in self.attempts()],
                         ["1", "other", "1", "other", "1", "1"])
        results = self.results()
        self.assertEqual(results["setup"]["other"]["programs"], {"plumbline_map": "other 1"})
        self.assertEqual(list(results["cases"]), ["office, 270 beams"])
        case = results["cases"]["office, 270 beams"]
        for figure in ("wall_s", "cpu_s", "peak_memory_mb"):
            self.assertEqual(case["ratios"][figure],
                             [ours[figure] / theirs[figure] for ours, theirs in
                              zip(case["this"]["runs"], case["other"]["runs"])])
        rows = [line for line in result.stdout.splitlines() if line.startswith("| office")]
        self.assertEqual(len(rows), 1)
        self.assertRegex(rows[0], r"\d \((\d+\.\d\d) to (\d+\.\d\d)\) \|$")
        self.assertEqual(self.entries(), ["against.json", "recordings"])
        self.assertEqual(self.entries(hidden=True), [])

    def test_ratios_are_this_build_over_the_other(self):
        run = {"wall_s": 3.0, "cpu_s": 1.0, "peak_memory_mb": 50.0}
        other = {"wall_s": 2.0, "cpu_s": 2.0, "peak_memory_mb": 40.0}
        ratios = comparison.ratios_of([run, other], [other, other])
        self.assertEqual(ratios, {"wall_s": [1.5, 1.0], "cpu_s": [0.5, 1.0],
                                  "peak_memory_mb": [1.25, 1.0]})
        self.assertEqual(comparison.ratio_cell(ratios["wall_s"]), "1.25 (1.00 to 1.50)")
        self.assertEqual(comparison.ratio_cell([1.5]), "1.50")

    def test_all_whole_jobs_unless_named(self):
        self.check_done(self.compare("--repeat", "1"))
        self.assertEqual([case["group"] for case in self.results()["cases"].values()],
                         ["jobs"] * 4)

    def test_a_map_that_contradicts_itself_takes_its_time_too(self):
        self.set_control("contradict_1")
        self.check_done(self.compare("--repeat", "1", "--case", "office, 270"))
        case = self.results()["cases"]["office, 270 beams"]
        self.assertEqual(case["this"]["runs"][0]["exit_code"], 3)

    def test_a_failure_says_whose_it_is(self):
        self.set_other("echo lost >&2; exit 1")
        result = self.compare("--repeat", "2", "--case", "office, 270")
        self.assertEqual(result.returncode, 1)
        self.assertEqual(result.stdout, f"failed: office, 270 beams: lost, {self.other}\n")
        self.assertEqual(self.results()["cases"], {})
        self.assertEqual(len(self.attempts()), 2)

    def test_errors(self):
        self.check_error("no case is named hangar", "--against-bin", self.other,
                         "--case", "hangar")
        self.check_error("no commit nowhere in", "--against", "nowhere")
        self.check_error("no commit --all in", "--against=--all")
        self.check_error("no plumbline_map in", "--against-bin", self.directory)

    def test_usage(self):
        self.check_usage_error("--against", "HEAD", "--against-bin", self.other)
        self.check_usage_error("--case", "office")
        self.check_usage_error("--against-bin", self.binaries)
        self.check_usage_error("--against")


class BuildOfACommitTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.builds = pathlib.Path(folder.name) / "builds"
        self.repository = pathlib.Path(folder.name) / "repository"
        (self.repository / "scripts").mkdir(parents=True)
        self.git("init", "-q")

    def git(self, *arguments):
        return subprocess.run(["git", "-C", self.repository, "-c", "user.name=a",
                               "-c", "user.email=a@b", *arguments], check=True,
                              capture_output=True, text=True).stdout.strip()

    def commit(self, line):
        script = self.repository / "scripts" / "build.sh"
        script.write_text(f'#!/bin/sh\ncd "$(dirname "$0")/.." && {line}\n')
        script.chmod(0o755)
        self.git("add", ".")
        self.git("commit", "-qm", "a")
        return self.git("rev-parse", "HEAD")

    def test_each_commit_has_a_folder_of_its_own(self):
        line = 'mkdir -p build/bin && echo "{} $1 $CCACHE_BASEDIR" >> build/bin/plumbline_map'
        first = self.commit(line.format("first"))
        second = self.commit(line.format("second"))
        (self.repository / "scripts" / "build.sh").write_text("not committed")
        for name in (first, second, first):
            built = comparison.build_commit(
                self.repository, comparison.find_commit(self.repository, name), self.builds)
            self.assertEqual(built, self.builds / name[:12] / "build" / "bin")
        text = (self.builds / first[:12] / "build" / "bin" / "plumbline_map").read_text()
        self.assertEqual(text, f"first plumbline_map {self.builds / first[:12]}\n" * 2)
        self.assertTrue((self.builds / second[:12] / "build" / "bin" / "plumbline_map")
                        .read_text().startswith("second plumbline_map"))
        self.assertEqual(comparison.find_commit(self.repository, "HEAD~1"), first)
        self.assertEqual(self.git("status", "--porcelain"), "M scripts/build.sh")
        self.assertEqual(sorted(path.name for path in self.builds.iterdir()),
                         sorted([first[:12], second[:12]]))

    def test_a_commit_that_does_not_build(self):
        commit = self.commit("exit 3")
        with self.assertRaisesRegex(job_runner.InputError, f"{commit[:12]} does not build"):
            comparison.build_commit(self.repository, commit, self.builds)


if __name__ == "__main__":
    unittest.main()
