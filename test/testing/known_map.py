"""A map.ply of known points, written here and not by plumbline, for tests of the exports."""

import numpy

FIELDS = [("x", "f4"), ("y", "f4"), ("z", "f4"), ("time", "f8"), ("scanner", "u1"),
          ("plane_id", "i4"), ("residual", "f4"), ("red", "u1"), ("green", "u1"), ("blue", "u1"),
          ("alpha", "u1"), ("nx", "f4"), ("ny", "f4"), ("nz", "f4")]
NAMES = {"f4": "float", "f8": "double", "u1": "uchar", "i4": "int"}


def known_points(num_points):
    """Points on the planes 0 to 8, on none (-1) and on what moves (-2); colours are black."""
    random = numpy.random.RandomState(7)
    points = numpy.zeros(num_points, FIELDS)
    for axis, size in (("x", 40.0), ("y", 25.0), ("z", 3.0)):
        points[axis] = random.uniform(-size, size, num_points)
    points["time"] = 0.5 + 1e-4 * numpy.arange(num_points)
    points["scanner"] = numpy.arange(num_points) % 3
    points["plane_id"] = random.randint(-2, 9, num_points)
    on_plane = points["plane_id"] >= 0
    points["residual"] = numpy.where(on_plane, random.normal(0, 0.03, num_points), numpy.nan)
    angle = points["plane_id"] * 0.5
    points["nx"] = numpy.where(on_plane, numpy.cos(angle), 0)
    points["ny"] = numpy.where(on_plane, numpy.sin(angle), 0)
    points["alpha"] = 255
    return points


def write_map(path, points):
    header = "ply\nformat binary_little_endian 1.0\n" + f"element vertex {len(points)}\n"
    header += "".join(f"property {NAMES[kind]} {name}\n" for name, kind in FIELDS)
    with open(path, "wb") as file:
        file.write(header.encode() + b"end_header\n" + points.tobytes())
