#!/usr/bin/python3
"""The log of a real robot is as right as the best published maps of it.

    aces_test.py PLUMBLINE_MAP

Skipped where the log is not at hand: it is not shipped.
"""

import bz2
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
LOGS = SOURCE.parent / "shared" / "data" / "radish"
mapper = None


class AcesTest(unittest.TestCase):
    def test_relations_that_people_found(self):
        log = LOGS / "aces.clf.bz2"
        if not log.exists():
            self.skipTest(f"no {log.name} in shared/data/radish beside the source")
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            (folder / "aces.clf").write_bytes(bz2.decompress(log.read_bytes()))
            run = subprocess.run(
                [mapper, f"--recording={folder / 'aces.clf'}",
                 f"--rig={SOURCE / 'configs' / 'rigs' / 'radish_aces.yaml'}",
                 f"--output={folder / 'map'}"], capture_output=True, text=True, check=False)
            # 3: a map, with a verdict that says not to trust it.
            self.assertIn(run.returncode, (0, 3), run.stderr[-2000:])
            subprocess.run(
                [SOURCE / "scripts" / "evaluate_relations.py", folder / "map", "--relations",
                 LOGS / "aces.relations", "--output", folder / "figures.json"],
                capture_output=True, text=True, check=True)
            figures = json.loads((folder / "figures.json").read_text())
            warnings = json.loads((folder / "map" / "summary.json").read_text())["warnings"]
        self.assertEqual(figures["covered"], 1279)
        self.assertLess(figures["translation_m"]["mean"], 0.05)
        self.assertLess(figures["rotation_deg"]["mean"], 0.5)
        self.assertTrue(any("stated standard deviations know nothing of it" in warning
                            for warning in warnings), warnings)


if __name__ == "__main__":
    mapper = sys.argv.pop(1)
    unittest.main()
