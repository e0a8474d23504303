#!/usr/bin/python3
"""Opens the report of a simulated room in Chromium, uses its controls and holds its numbers
against the files of the result.

    page_test.py BUILD_DIRECTORY
"""

import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

import numpy as np

from joint_precision import JointPrecision, read_covariance
from viewer_install import ROOT, find_program, install

BUILD_DIRECTORY = pathlib.Path(sys.argv.pop(1)).resolve()
SCRIPT = pathlib.Path(__file__).with_name("page_test.mjs")
POINT = np.dtype([("p", "<f4", 3), ("time", "<f8"), ("scanner", "u1"), ("plane", "<i4"),
                  ("residual", "<f4"), ("colour", "u1", 4), ("normal", "<f4", 3)])
# A floor plan whose script must not run.
FLOOR_PLAN = ('<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 4 3" width="400" height="300">'
              '<script>window.top.floorPlanRan = true</script><rect width="4" height="3"/></svg>')


def run(*command):
    subprocess.run([str(word) for word in command], check=True, capture_output=True)


def read_points(path):
    data = path.read_bytes()
    return np.frombuffer(data[data.index(b"end_header\n") + 11:], POINT)


def measurements(result, planes):
    """What lies between pairs of surfaces, at the first one's centre."""
    precision = JointPrecision(planes, *read_covariance(result / "plane_covariance.csv"))
    ids = [plane["id"] for plane in planes]
    return [{"a": a, "b": b, "angle": precision.angle(a, b),
             "distance": precision.separation(precision.planes[a]["centre"], a, b)}
            for a in ids[:6] for b in ids if a != b]


def expectations(result, evaluation):
    planes = json.loads((result / "planes.json").read_text(encoding="utf-8"))
    summary = json.loads((result / "summary.json").read_text(encoding="utf-8"))
    points = read_points(result / "map.ply")
    on_plane = points["residual"][points["plane"] >= 0].astype(float)
    poses = np.loadtxt(result / "trajectory.tum")
    return {
        "planes": planes,
        "summary": summary,
        "evaluation": json.loads(evaluation.read_text(encoding="utf-8")),
        "measurements": [{key: list(value) if isinstance(value, tuple) else value
                          for key, value in pair.items()}
                         for pair in measurements(result, planes)],
        "points": {
            "count": len(points),
            "mean": points["p"].astype(float).mean(axis=0).tolist(),
            "last_time": float(points["time"].max()),
            "by_scanner": np.bincount(points["scanner"]).tolist(),
            "by_plane": {str(number): int((points["plane"] == number).sum())
                         for number in np.unique(points["plane"])},
            "residual_rms": float(np.sqrt(np.mean(on_plane ** 2))),
        },
        "start": float(poses[0, 0]),
        "poses": poses[::50].tolist(),
    }


class Page(unittest.TestCase):
    def setUp(self):
        self.chromium = find_program("chromium", "chromium-browser", "google-chrome")
        self.packages = install(BUILD_DIRECTORY)
        self.directory = pathlib.Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.directory)

    def make_report(self):
        programs = BUILD_DIRECTORY / "bin"
        truth, result = self.directory / "truth", self.directory / "a room"
        evaluation = self.directory / "evaluation.json"
        run(programs / "plumbline_simulate", "--seed=1", f"--output={truth}",
            f"--experiment={ROOT / 'configs/experiments/room.yaml'}")
        run(programs / "plumbline_map", f"--recording={truth / 'recording.bag'}",
            f"--rig={truth / 'rig.yaml'}", f"--output={result}", "--report", "--threads=2")
        self.assertTrue((result / "report.html").exists())
        run(programs / "plumbline_evaluate", f"--result={result}", f"--truth={truth}",
            f"--output={evaluation}")
        (result / "floor_plan.svg").write_text(FLOOR_PLAN, encoding="utf-8")
        run(programs / "plumbline_report", result, f"--evaluation={evaluation}")
        return result, evaluation

    def test_page_shows_what_the_result_says(self):
        result, evaluation = self.make_report()
        expected = self.directory / "expected.json"
        expected.write_text(json.dumps(expectations(result, evaluation)), encoding="utf-8")
        # Its output is the test's, so that it shows how far it came.
        subprocess.run([find_program("node"), SCRIPT, self.packages, self.chromium,
                        result / "report.html", expected], timeout=240, check=True)


if __name__ == "__main__":
    unittest.main()
