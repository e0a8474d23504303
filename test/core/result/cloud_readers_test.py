#!/usr/bin/python3
"""Opens a map in every format with other people's programs, those that are installed.

A room is simulated and mapped; what the programs read is compared with map.ply. Debian packages:
cloudcompare, gdal-bin, libfreecad-python3-0.20, meshlab, pcl-tools, python3-meshio,
python3-open3d, xvfb. For LAS, of which Debian has no reader, and for E57 also npm packages:
"npm ci" in test/core/result/readers.

Usage: cloud_readers_test.py DIRECTORY_OF_THE_PROGRAMS
"""

import importlib
import io
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

import numpy

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "test" / "testing"))
from known_map import FIELDS  # pylint: disable=wrong-import-position

NODE = pathlib.Path(__file__).resolve().parent / "readers"
PROGRAMS = pathlib.Path()
FREECAD = "/usr/lib/freecad-python3/lib"
FREECAD_SCRIPT = """
import json, sys
sys.path[:0] = ["/usr/lib/freecad-python3/lib", "/usr/lib/freecad/lib"]
import FreeCAD, Points
document = FreeCAD.newDocument("map")
Points.insert(sys.argv[1], "map")
cloud = document.Objects[0]
print("READ", json.dumps([list(map(tuple, cloud.Points.Points)),
                          [colour[:3] for colour in cloud.Color]]))
"""


def run(*command, **more):
    environment = {**os.environ, "QT_QPA_PLATFORM": "offscreen"}
    return subprocess.run([str(word) for word in command], capture_output=True, text=True,
                          check=True, env=environment, **more).stdout


def read_binary_ply(path):
    """The vertices by field, of files without other elements than vertices and faces."""
    data = pathlib.Path(path).read_bytes()
    header, _, body = data.partition(b"end_header\n")
    kinds = {"float": "f4", "double": "f8", "uchar": "u1", "int": "i4", "uint": "u4"}
    fields, count = [], None
    for line in header.decode().splitlines():
        words = line.split()
        if words[0] == "element":
            if count is not None:
                break
            count = int(words[2])
        elif words[0] == "property":
            fields.append((words[2], kinds[words[1]]))
    return numpy.frombuffer(body, fields, count)


class CloudReadersTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        directory = tempfile.TemporaryDirectory()
        cls.addClassCleanup(directory.cleanup)
        cls.result = pathlib.Path(directory.name) / "map"
        room = pathlib.Path(directory.name) / "room"
        run(PROGRAMS / "plumbline_simulate", "--seed=1", f"--output={room}",
            f"--experiment={ROOT / 'configs' / 'experiments' / 'room.yaml'}")
        run(PROGRAMS / "plumbline_map", f"--recording={room / 'recording.bag'}",
            f"--rig={room / 'rig.yaml'}", f"--output={cls.result}",
            "--formats=ply,pcd,las,las12,e57")
        cls.points = read_binary_ply(cls.result / "map.ply")
        assert cls.points.dtype == numpy.dtype(FIELDS)
        cls.xyz = numpy.stack([cls.points[name] for name in "xyz"], axis=1)
        cls.colours = numpy.stack([cls.points[name] for name in ("red", "green", "blue")], axis=1)
        cls.normals = numpy.stack([cls.points[name] for name in ("nx", "ny", "nz")], axis=1)

    def need_program(self, name, package):
        if shutil.which(name) is None:
            self.skipTest(f"{name} (Debian: {package}) is not installed")

    def need_module(self, name, package):
        try:
            return importlib.import_module(name)
        except ImportError:
            return self.skipTest(f"{name} (Debian: {package}) is not installed")

    def need_npm(self, name):
        self.need_program("node", "nodejs")
        if not (NODE / "node_modules" / name).exists():
            self.skipTest(f"{name} is not installed: npm ci in test/core/result/readers")

    def expect(self, read, ours, tolerance=0.0):
        self.assertEqual(read.shape, ours.shape)
        self.assertLessEqual(abs(read.astype(float) - ours).max(), tolerance)

    def test_open3d_reads_ply_and_pcd(self):
        open3d = self.need_module("open3d", "python3-open3d")
        for name in ("map.ply", "map.pcd"):
            cloud = open3d.io.read_point_cloud(str(self.result / name))
            self.expect(numpy.asarray(cloud.points), self.xyz)
            self.expect(numpy.asarray(cloud.colors) * 255, self.colours, 1e-9)
            self.expect(numpy.asarray(cloud.normals), self.normals)

    def test_open3d_reads_planes(self):
        open3d = self.need_module("open3d", "python3-open3d")
        mesh = open3d.io.read_triangle_mesh(str(self.result / "planes.ply"))
        planes = json.loads((self.result / "planes.json").read_text())
        corners = sum(len(plane["outline"]) for plane in planes)
        self.assertEqual(len(mesh.vertices), corners)
        self.assertEqual(len(mesh.triangles), corners - 2 * len(planes))

    def test_meshio_reads_all_fields(self):
        meshio = self.need_module("meshio", "python3-meshio")
        mesh = meshio.read(self.result / "map.ply")
        self.expect(mesh.points, self.xyz)
        for name in ("time", "scanner", "plane_id", "red", "nx"):
            read = mesh.point_data[name]
            if name == "red":
                read = read.view("u1")  # this version takes bytes for signed ones
            self.expect(read, self.points[name])
        numpy.testing.assert_array_equal(mesh.point_data["residual"], self.points["residual"])
        planes = meshio.read(self.result / "planes.ply")
        ids = {plane["id"] for plane in json.loads((self.result / "planes.json").read_text())}
        self.assertEqual(set(planes.cell_data["plane_id"][0].tolist()), ids)

    def test_pcl_reads_pcd(self):
        self.need_program("pcl_convert_pcd_ascii_binary", "pcl-tools")
        text = self.result / "ascii.pcd"
        run("pcl_convert_pcd_ascii_binary", self.result / "map.pcd", text, 0)
        lines = text.read_text().splitlines()
        self.assertIn("FIELDS x y z time scanner plane_id residual rgba normal_x normal_y normal_z",
                      lines)
        values = numpy.loadtxt(lines[lines.index("DATA ascii") + 1:])
        self.expect(values[:, :3], self.xyz, 1e-5)
        self.expect(values[:, 5], self.points["plane_id"])
        rgba = values[:, 7].astype(numpy.uint32)
        self.expect(numpy.stack([rgba >> 16 & 255, rgba >> 8 & 255, rgba & 255], 1), self.colours)

    def test_cloudcompare_reads_ply(self):
        self.need_program("CloudCompare", "cloudcompare")
        self.need_program("xvfb-run", "xvfb")
        with tempfile.TemporaryDirectory() as directory:
            for name in ("map.ply", "planes.ply"):
                shutil.copy(self.result / name, directory)
            told = run("xvfb-run", "-a", "CloudCompare", "-SILENT", "-O", "planes.ply", "-O",
                       "map.ply", "-C_EXPORT_FMT", "ASC", "-ADD_HEADER", "-NO_TIMESTAMP",
                       "-SAVE_CLOUDS", cwd=directory)
            self.assertNotIn("not triangular", told)
            text = (pathlib.Path(directory) / "map.asc").read_text()
        self.assertTrue(text.startswith("//X Y Z R G B Nx Ny Nz\n"), text[:80])
        values = numpy.loadtxt(io.StringIO(text), comments="//")
        self.expect(values[:, :3], self.xyz, 1e-6)
        self.expect(values[:, 3:6], self.colours)
        on_plane = self.points["plane_id"] >= 0  # CloudCompare packs normals into 21 bits
        self.expect(values[on_plane, 6:9], self.normals[on_plane], 0.01)

    def test_meshlab_reads_ply(self):
        self.need_program("meshlabserver", "meshlab")
        self.need_program("xvfb-run", "xvfb")
        for name in ("map.ply", "planes.ply"):
            run("xvfb-run", "-a", "meshlabserver", "-i", self.result / name, "-o",
                self.result / f"lab_{name}", "-m", "vc", "vn")
        vertices = read_binary_ply(self.result / "lab_map.ply")
        self.expect(numpy.stack([vertices[axis] for axis in "xyz"], 1), self.xyz)
        self.expect(numpy.stack([vertices[name] for name in ("red", "green", "blue")], 1),
                    self.colours)
        self.expect(numpy.stack([vertices[name] for name in ("nx", "ny", "nz")], 1),
                    self.normals, 1e-6)
        ours = (self.result / "planes.ply").read_text()
        corners = int(ours.split("element vertex ")[1].split()[0])
        self.assertEqual(len(read_binary_ply(self.result / "lab_planes.ply")), corners)

    def test_freecad_reads_e57(self):
        """FreeCAD reads E57 with libE57Format."""
        if not pathlib.Path(FREECAD, "Points.so").exists():
            self.skipTest("FreeCAD (Debian: libfreecad-python3-0.20) is not installed")
        for name in ("map.e57", "map.ply", "map.pcd"):
            told = run("/usr/bin/python3", "-c", FREECAD_SCRIPT, self.result / name)
            line = [line for line in told.splitlines() if line.startswith("READ ")][0]
            points, colours = json.loads(line[5:])
            self.expect(numpy.array(points), self.xyz, 1e-6)
            self.expect(numpy.array(colours) * 255, self.colours, 1e-4)

    def test_rust_e57_reads_e57(self):
        self.need_npm("web-e57")
        text = run("node", "--experimental-wasm-modules", NODE / "read_e57.mjs",
                   self.result / "map.e57")
        values = numpy.loadtxt(io.StringIO(text))
        self.expect(values[:, :3], self.xyz)
        self.expect(values[:, 3:], self.colours)

    def test_copc_reads_las(self):
        self.need_npm("copc")
        step = 101
        ours = self.points[::step]
        for name in ("map.las", "map_las12.las"):
            read = json.loads(run("node", NODE / "read_las.mjs", self.result / name, step))
            self.assertEqual(read["header"]["pointCount"], len(self.points))
            values = {key: numpy.array(value, float) for key, value in read["dimensions"].items()}
            for axis in "xyz":
                self.expect(values[axis.upper()], ours[axis], 0.51e-4)
            self.expect(values["GpsTime"], ours["time"])
            for channel in ("red", "green", "blue"):
                self.expect(values[channel.capitalize()] / 257, ours[channel])
            self.expect(values["UserData"], ours["scanner"])
            if name == "map.las":
                for field in ("scanner", "plane_id"):
                    self.expect(values[field], ours[field])
                numpy.testing.assert_array_equal(values["residual"].astype("f4"),
                                                 ours["residual"])
            else:
                self.expect(values["PointSourceId"], numpy.maximum(ours["plane_id"], -1) + 1)

    def test_gdal_reads_the_frame_of_las_and_csv(self):
        self.need_program("ogrinfo", "gdal-bin")
        las = (self.result / "map.las").read_bytes()
        start = las.index(b"LOCAL_CS[")
        wkt = self.result / "frame.wkt"
        wkt.write_bytes(las[start:las.index(b"\0", start)])
        self.assertIn("Validate Succeeds", run("gdalsrsinfo", "-V", wkt))
        for name in ("trajectory_covariance.csv", "plane_covariance.csv"):
            lines = (self.result / name).read_text().splitlines()
            told = run("ogrinfo", "-so", "-al", self.result / name)
            self.assertIn(f"Feature Count: {len(lines) - 1}\n", told)
            self.assertEqual(told.count(": String (0.0)"), len(lines[0].split(",")))


if __name__ == "__main__":
    PROGRAMS = pathlib.Path(sys.argv.pop(1))
    TESTS = unittest.main(exit=False, verbosity=2).result
    if TESTS.testsRun == len(TESTS.skipped):
        print("all readers skipped: none is installed")
    sys.exit(not TESTS.wasSuccessful())
