#!/usr/bin/python3
"""Tests scripts/analysis/surfaces.py on small runs made here."""

import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[3] / "scripts" / "analysis" / "surfaces.py"


def surface(number, kind, normal, distance):
    """A surface of 2 x 2 m about the foot of the normal from the origin."""
    foot = [distance * n for n in normal]
    along = [-normal[1], normal[0], 0.0] if kind != "horizontal" else [1.0, 0.0, 0.0]
    up = [0.0, 0.0, 1.0] if kind != "horizontal" else [0.0, 1.0, 0.0]
    outline = [[f + a * i + u * j for f, a, u in zip(foot, along, up)]
               for i, j in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    return {"id": number, "type": kind, "normal": normal, "distance": distance, "centre": foot,
            "outline": outline, "num_points": 3000}


class SurfacesTest(unittest.TestCase):
    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.folder = pathlib.Path(directory.name)

    def write_run(self, name, largest_m):
        """Floor and wall are 2 and 3 of their standard deviations of 1 mm off; a phantom."""
        run = self.folder / name
        run.mkdir()
        truth = [surface(0, "horizontal", [0.0, 0.0, 1.0], 0.0),
                 surface(1, "vertical", [1.0, 0.0, 0.0], -2.0)]
        planes = [surface(0, "horizontal", [0.0, 0.0, 1.0], 0.002),
                  surface(1, "vertical", [1.0, 0.0, 0.0], -2.003),
                  surface(2, "cylinder", [0.0, 1.0, 0.0], -3.0)]
        judged = [{"id": 0, "status": "matched", "true_faces": [0]},
                  {"id": 1, "status": "matched", "true_faces": [1], "angle_deg": 0.6,
                   "sigma_angle_deg": 0.1},
                  {"id": 2, "status": "wrong", "true_faces": []}]
        files = {"planes.json": planes, "truth_planes.json": truth,
                 "evaluation.json": {
                     "trajectory": {"aligned": {"position_m": {"max": largest_m},
                                                "rotation_deg": {"max": 0.1}}},
                     "model_from_truth": {"translation": [0, 0, 0], "rotation_xyzw": [0, 0, 0, 1]},
                     "planes": {"list": judged}}}
        for file, content in files.items():
            (run / file).write_text(json.dumps(content))
        (run / "truth_trajectory.tum").write_text("0 0 0 0 0 0 0 1\n1 1 0 0 0 0 0 1\n")
        (run / "plane_covariance.csv").write_text(
            "plane,parameter,0:d,1:angle,1:d\n0,d,1e-6,0,0\n1,angle,0,1e-6,0\n1,d,0,0,1e-6\n")

    def run_script(self):
        output = self.folder / "figures.json"
        done = subprocess.run([sys.executable, SCRIPT, self.folder, "--output", output],
                              capture_output=True, text=True, check=True)
        return done.stdout, json.loads(output.read_text())

    def test_right_maps_alone_count(self):
        self.write_run("hall_0001", 0.01)
        self.write_run("hall_0002", 0.06)
        text, figures = self.run_script()
        hall = figures["hall"]
        self.assertEqual([hall[key] for key in ("maps", "surfaces", "phantoms", "headings",
                                                "beyond", "arcs")], [1, 3, 1, 1, 1, 1])
        # Distances 2 and 3 standard deviations off, the heading right: 13 over 3.
        self.assertAlmostEqual(hall["nees_median"], 13 / 3, places=6)
        self.assertIn("| `hall` | 1 | 3 | 33.3 % | 100.0 % | 4.33 (4.33) | 1 |", text)

    def test_a_folder_without_runs_is_an_error(self):
        done = subprocess.run([sys.executable, SCRIPT, self.folder], capture_output=True,
                              text=True, check=False)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("holds no run", done.stderr)


if __name__ == "__main__":
    unittest.main()
