#!/usr/bin/python3
"""Tests scripts/recordings/even_stamps.py with a made-up log."""

import pathlib
import random
import subprocess
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[3] / "scripts" / "recordings" / "even_stamps.py"


def scan(stamp, number):
    return f"FLASER 2 1.5 {number} 0 0 0 0 0 0 {stamp:.6f} host {stamp:.6f}"


def odometry(stamp, number):
    return f"ODOM {number} 0 0 0 0 0 {stamp:.6f} host {stamp:.6f}"


class EvenStampsTest(unittest.TestCase):
    def even(self, lines):
        with tempfile.TemporaryDirectory() as folder:
            log = pathlib.Path(folder) / "late.clf"
            log.write_text("\n".join(lines) + "\n")
            run = subprocess.run([SCRIPT, log, "--output", log.with_name("even.clf")],
                                 capture_output=True, text=True, check=False)
            if run.returncode != 0:
                return run.returncode, run.stderr
            return 0, log.with_name("even.clf").read_text().splitlines()

    def test_bursts_are_spread(self):
        # A scan each 0.2 s, taken in up to 0.8 s late, and a pause of 30 s after the 200th.
        numbers = random.Random(1)
        true = [0.2 * i + (30.0 if i >= 200 else 0.0) for i in range(400)]
        late = [t + numbers.choice([0.0, 0.1, 0.8]) for t in true]
        lines = ["# a comment"]
        for number, stamp in enumerate(late):
            lines += [odometry(stamp - 0.05, number), scan(stamp, number)]
        code, evened = self.even(lines)
        self.assertEqual(code, 0, evened)
        self.assertEqual(evened[0], "# a comment")
        scans = [line.split() for line in evened if line.startswith("FLASER")]
        self.assertEqual([int(words[3]) for words in scans], list(range(400)))
        stamps = [float(words[-3]) for words in scans]
        # The delay of a tenth is that of the median scan.
        for i in list(range(30, 170)) + list(range(230, 370)):
            self.assertAlmostEqual(stamps[i], true[i] + 0.1, delta=0.05)
        steps = [b - a for a, b in zip(stamps, stamps[1:])]
        self.assertGreater(min(steps), 0.0)
        self.assertGreater(stamps[230] - stamps[170], 30.0)
        of_odometry = [float(line.split()[-3]) for line in evened if line.startswith("ODOM")]
        self.assertEqual(of_odometry, stamps)

    def test_logs_without_scans_are_refused(self):
        code, text = self.even([odometry(1.0, 1)])
        self.assertEqual(code, 1)
        self.assertIn("has 0 scans", text)


if __name__ == "__main__":
    unittest.main()
