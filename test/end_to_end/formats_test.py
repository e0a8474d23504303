#!/usr/bin/python3
"""Recordings of all formats, written by other people's programs, give the same map.

    formats_test.py PLUMBLINE_SIMULATE PLUMBLINE_MAP FOLDER_FOR_NPM

Needs npm (which installs the libraries of test/testing/recordings), python3-rosbag, bzip2, zstd,
lz4 and sqlite3; skipped where one of them is absent.
"""

import filecmp
import json
import math
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
TOOLS = SOURCE / "test" / "testing" / "recordings"
SHIPPED = SOURCE / "test" / "data" / "recordings"
MAPPED = ("map.ply", "planes.json", "trajectory.tum")
FORMATS = ("chunked.mcap", "zstd.mcap", "lz4.mcap", "unchunked.mcap", "ros1.mcap",
           "recording.db3", "per_message.db3", "folder")

simulate, mapper, npm_folder = None, None, None


def run(*command, **options):
    return subprocess.run([str(word) for word in command], check=True, capture_output=True,
                          text=True, **options)


def install_libraries():
    """Copies the converter to a folder of the build, so that npm leaves the source alone."""
    npm_folder.mkdir(parents=True, exist_ok=True)
    for name in ("package.json", "package-lock.json", ".npmrc", "convert.mjs"):
        shutil.copy(TOOLS / name, npm_folder / name)
    stamp = npm_folder / "installed.json"
    lock = (TOOLS / "package-lock.json").read_text()
    if stamp.exists() and stamp.read_text() == lock:
        return
    run("npm", "ci", "--ignore-scripts", cwd=npm_folder, timeout=120)
    stamp.write_text(lock)


def convert(bag, output, kilobytes_of_a_chunk):
    run("node", npm_folder / "convert.mjs", bag, output, kilobytes_of_a_chunk)


class FormatsTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        for program in ("node", "npm", "bzip2", "zstd", "lz4", "sqlite3"):
            if shutil.which(program) is None:
                raise unittest.SkipTest(f"{program} is absent")
        try:
            install_libraries()
        except (subprocess.CalledProcessError, subprocess.TimeoutExpired) as error:
            raise unittest.SkipTest(f"npm can not install its libraries: {error}") from error

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="plumbline_")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def need_rosbag(self):
        try:
            run("/usr/bin/python3", "-c", "import rosbag, nav_msgs.msg, sensor_msgs.msg")
        except subprocess.CalledProcessError:
            self.skipTest("python3-rosbag, python3-nav-msgs or python3-sensor-msgs is absent")

    def test_shipped_recordings_are_made_anew(self):
        self.need_rosbag()
        run("/usr/bin/python3", TOOLS / "make_bag.py", self.folder / "source.bag")
        convert(self.folder / "source.bag", self.folder, 2)
        names = [path.relative_to(SHIPPED) for path in SHIPPED.rglob("*")
                 if path.is_file() and path.name != "README.md"]
        self.assertGreater(len(names), 9)
        for name in names:
            self.assertTrue(filecmp.cmp(self.folder / name, SHIPPED / name, shallow=False), name)

    def map(self, recording, name):
        output = self.folder / f"map_{name}"
        run(mapper, f"--recording={recording}", f"--rig={self.folder}/room/rig.yaml",
            f"--output={output}")
        return output

    def test_all_formats_give_the_same_map(self):
        run(simulate, f"--experiment={SOURCE}/configs/experiments/room.yaml", "--seed=1",
            f"--output={self.folder}/room")
        bag = self.folder / "room" / "recording.bag"
        convert(bag, self.folder / "converted", 64)
        expected = self.map(bag, "bag")
        self.assertGreater(len(json.loads((expected / "planes.json").read_text())), 5)
        for name in FORMATS:
            mapped = self.map(self.folder / "converted" / name, name)
            for file in MAPPED:
                self.assertTrue(filecmp.cmp(mapped / file, expected / file, shallow=False),
                                f"{name}: {file}")
            summaries = [json.loads((folder / "summary.json").read_text())
                         for folder in (mapped, expected)]
            self.assertEqual(summaries[0]["warnings"], summaries[1]["warnings"])

    def test_point_clouds_give_the_map_of_their_scan_lines(self):
        """A fourth of the beams, at odd angles: as clouds, and as scan lines with gaps."""
        self.need_rosbag()
        experiment = (SOURCE / "configs/experiments/room.yaml").read_text()
        experiment = experiment.replace("../", f"{SOURCE}/configs/").replace("paper", "paper_1080")
        (self.folder / "experiment.yaml").write_text(experiment)
        run(simulate, f"--experiment={self.folder}/experiment.yaml", "--seed=1",
            f"--output={self.folder}/room")
        clouds, scan_lines = self.folder / "clouds.bag", self.folder / "scan_lines.bag"
        run("/usr/bin/python3", TOOLS / "make_clouds.py", self.folder / "room" / "recording.bag",
            clouds, scan_lines)
        surfaces, ways = zip(*(self.figures(self.map(bag, bag.stem))
                               for bag in (clouds, scan_lines)))
        self.assertEqual(len(surfaces[0]), len(surfaces[1]))
        self.assertGreater(len(surfaces[0]), 5)
        for (one_type, one_m), (other_type, other_m) in zip(*surfaces):
            self.assertEqual(one_type, other_type)
            self.assertAlmostEqual(one_m, other_m, delta=0.003)
        self.assertEqual(len(ways[0]), len(ways[1]))
        self.assertLess(max(abs(one - other) for one, other in zip(*ways)), 0.005)

    @staticmethod
    def figures(folder):
        """The surfaces' types and distances, and how far the rig is from its start, scan by scan.

        The wall that the heading refers to may be another one: nothing else depends on it.
        """
        surfaces = [(surface["type"], surface["distance"])
                    for surface in json.loads((folder / "planes.json").read_text())]
        way = [math.hypot(*map(float, line.split()[1:4]))
               for line in (folder / "trajectory.tum").read_text().splitlines()
               if not line.startswith("#")]
        return sorted(surfaces), way


if __name__ == "__main__":
    simulate, mapper, npm_folder = (pathlib.Path(path).resolve() for path in sys.argv[1:4])
    unittest.main(argv=sys.argv[:1])
