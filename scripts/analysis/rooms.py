#!/usr/bin/python3
"""Holds the rooms of a floor plan (rooms.json) against the building that was simulated.

The truth comes from the building file alone: of a floor plan (.yaml) the outlines without walls,
pillars and shafts, of a mesh (.ply with the .json of its elements) what its walls enclose at a
height above doors and windows. That holds what openings in the floor take from a room, so that it
is compared with the room's area and theirs. The plan's frame is laid on that of the building by the
true path.
"""

import argparse
import json
import math
import pathlib
import sys

import numpy as np
import yaml

try:
    from shapely.geometry import LineString, Point, Polygon
    from shapely.ops import polygonize, unary_union
except ImportError:
    sys.exit("rooms.py: needs Shapely (apt-get install python3-shapely)")

MIN_ROOM_M2 = 1.0
ARC_STEP = math.radians(0.5)
GRID_M = 1e-5  # corners of a mesh's triangles so close are one


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("plan", help="directory with rooms.json")
    parser.add_argument("--result", help="directory that plumbline_map wrote (default: plan)")
    parser.add_argument("--truth", required=True, help="directory that plumbline_simulate wrote")
    parser.add_argument("--building", required=True, help="building file (.yaml or .ply)")
    parser.add_argument("--height", type=float, default=2.4,
                        help="of the section through a mesh above the floor, m (default 2.4)")
    parser.add_argument("--output", help="JSON file for the figures")
    return parser.parse_args()


# Truth.

def with_arcs(corners):
    """The corners of an outline, arcs as short chords."""
    points = []
    for corner in corners:
        if not isinstance(corner, dict):
            points.append(tuple(corner))
            continue
        a, b, c = (complex(*p) for p in (points[-1], corner["through"], corner["to"]))
        w = (c - a) / (b - a)
        centre = (b - a) * (w - abs(w) ** 2) / (2j * w.imag) + a
        radius = abs(a - centre)
        start = math.atan2((a - centre).imag, (a - centre).real)

        def turn(p):
            angle = math.atan2((p - centre).imag, (p - centre).real) - start
            return angle % (2 * math.pi)
        end = turn(c) if turn(b) < turn(c) else turn(c) - 2 * math.pi
        steps = max(2, math.ceil(abs(end) / ARC_STEP))
        for i in range(1, steps + 1):
            angle = start + end * i / steps
            points.append((centre.real + radius * math.cos(angle),
                           centre.imag + radius * math.sin(angle)))
    return points


def plan_rooms(path, floor):
    """Rooms of a floor plan's storey whose floor lies nearest to a height: doors count as closed."""
    building = yaml.safe_load(path.read_text(encoding="utf-8"))
    if "storeys" in building:
        building = min(building["storeys"], key=lambda s: abs(s["floor_height_m"] - floor))
    space = unary_union([Polygon(with_arcs(o["corners"])) for o in building["outlines"]])
    solids = [Polygon(with_arcs(s["corners"])) for s in building.get("solids", [])]
    for wall in building.get("walls", []):
        line = LineString([wall["from"], wall["to"]])
        solids.append(line.buffer(wall["thickness_m"] / 2, cap_style=2))
    solids += [Polygon(with_arcs(o["corners"])) for o in building.get("floor_openings", [])]
    ramps = [LineString([r["from"][:2], r["to"][:2]]).buffer(r["width_m"] / 2, cap_style=2)
             for r in building.get("ramps", [])]
    return parts_of(unary_union([space, *ramps]).difference(unary_union(solids)))


def read_mesh(path):
    with open(path, "rb") as file:
        counts = {}
        for line in iter(file.readline, b"end_header\n"):
            if line.startswith(b"element "):
                counts[line.split()[1]] = int(line.split()[2])
        points = np.frombuffer(file.read(12 * counts[b"vertex"]), "<f4").reshape(-1, 3)
        faces = np.frombuffer(file.read(), np.dtype(
            [("n", "u1"), ("corners", "<i4", 3), ("element", "<i4"), ("glass", "u1")]))
    return points.astype(float)[faces["corners"]], faces["element"]


def section(triangles, height):
    """The pieces in which triangles cut a level plane."""
    pieces = []
    for triangle in triangles:
        cuts = []
        for a, b in ((0, 1), (1, 2), (2, 0)):
            za, zb = triangle[a, 2] - height, triangle[b, 2] - height
            if (za > 0) != (zb > 0):
                p = triangle[a] + za / (za - zb) * (triangle[b] - triangle[a])
                cuts.append(tuple(np.round(p[:2] / GRID_M) * GRID_M))
        if len(cuts) == 2 and cuts[0] != cuts[1]:
            pieces.append(LineString(cuts))
    return pieces


def mesh_rooms(path, height):
    """What the walls of a mesh enclose at a height: above doors and windows they have no gaps."""
    elements = json.loads(path.with_suffix(".json").read_text(encoding="utf-8"))["elements"]
    triangles, element = read_mesh(path)
    solids = []
    for number in np.unique(element):
        kind = elements.get(str(number), {}).get("type", "")
        if not kind.startswith(("IfcWall", "IfcColumn")):
            continue
        pieces = section(triangles[element == number], height)
        solids += list(polygonize(unary_union(pieces))) if pieces else []
    # Walls that only touch are one.
    walls = unary_union([solid.buffer(1e-4, join_style=2) for solid in solids])
    return [Polygon(hole).buffer(1e-4, join_style=2) for part in parts_of(walls, 0.0)
            for hole in part.interiors if Polygon(hole).area > MIN_ROOM_M2]


def with_floor_openings(room):
    openings_m2 = sum(opening["area_m2"] for opening in room.get("floor_openings", []))
    return {**room, "area_m2": room["area_m2"] + openings_m2}


def parts_of(shape, min_area=MIN_ROOM_M2):
    parts = getattr(shape, "geoms", [shape])
    return [part for part in parts if part.area > min_area]


# The plan's frame.

def truth_from_model(result, truth):
    """Heading and shift that lay the estimated path on the true one."""
    estimate = np.loadtxt(result / "trajectory.tum")
    true = np.loadtxt(truth / "truth_trajectory.tum")
    at = np.column_stack([np.interp(estimate[:, 0], true[:, 0], true[:, i]) for i in (1, 2, 3)])
    a = estimate[:, 1] + 1j * estimate[:, 2]
    b = at[:, 0] + 1j * at[:, 1]
    turn = np.sum((b - b.mean()) * np.conj(a - a.mean()))
    turn /= abs(turn)
    shift = b.mean() - turn * a.mean()
    return turn, shift, float(np.mean(at[:, 2] - estimate[:, 3])), at


def transformed(points, turn, shift):
    moved = [turn * complex(*p) + shift for p in points]
    return [(p.real, p.imag) for p in moved]


def compare(storey, rooms, turn, shift, path):
    """A row for each true room that was found or that the path enters."""
    shapes = [(room, Polygon(transformed(room["outline"], turn, shift),
                             [transformed(hole, turn, shift) for hole in room["holes"]]).buffer(0))
              for room in storey["rooms"]]
    rows = []
    for truth in rooms:
        way = LineString(path).intersection(truth).length if len(path) > 1 else 0.0
        best = max(shapes, key=lambda item: item[1].intersection(truth).area, default=None)
        overlap = best[1].intersection(truth).area if best else 0.0
        found = best is not None and overlap > 0.5 * truth.area and overlap > 0.5 * best[1].area
        if way < 0.5 and not found:
            continue
        row = {"true_area_m2": truth.area, "way_m": way, "room": None,
               "at": [truth.representative_point().x, truth.representative_point().y]}
        if found:
            room = best[0]
            row.update(room=room["number"], area_m2=room["area_m2"], entered=room["entered"],
                       sigma_area_m2=room["sigma_area_m2"],
                       error_percent=100.0 * (room["area_m2"] / truth.area - 1.0))
        rows.append(row)
    matched = {row["room"] for row in rows}
    extra = [room["number"] for room, _ in shapes if room["number"] not in matched]
    return rows, extra


def main():
    arguments = parse_arguments()
    plan = json.loads((pathlib.Path(arguments.plan) / "rooms.json").read_text(encoding="utf-8"))
    turn, shift, lift, path = truth_from_model(
        pathlib.Path(arguments.result or arguments.plan), pathlib.Path(arguments.truth))
    building = pathlib.Path(arguments.building)
    figures = []
    for storey in plan["storeys"]:
        floor = (storey["floor_m"] or 0.0) + lift
        here = path[(path[:, 2] > floor + 0.3) & (path[:, 2] < floor + 2.0)]
        if building.suffix == ".ply":
            rooms = mesh_rooms(building, floor + arguments.height)
            storey["rooms"] = [with_floor_openings(room) for room in storey["rooms"]]
        else:
            rooms = plan_rooms(building, floor)
        if not rooms:
            sys.exit(f"rooms.py: {building}: no room is enclosed {floor + arguments.height:.2f} m "
                     "high: set --height to where its walls have no openings, below the ceiling")
        rows, extra = compare(storey, rooms, turn, shift, [tuple(p[:2]) for p in here])
        figures.append({"storey": storey["storey"], "rooms": rows, "not_in_truth": extra})
        print(f"storey {storey['storey']}: true area, found, stated standard deviation, error, way in it")
        for row in sorted(rows, key=lambda row: (row["room"] is None, row["room"])):
            if row["room"] is None:
                print(f"  missed  {row['true_area_m2']:8.3f} m2 at {row['at'][0]:.2f} "
                      f"{row['at'][1]:.2f}, way {row['way_m']:.1f} m")
                continue
            print(f"  room {row['room']:2d} {row['true_area_m2']:8.3f} {row['area_m2']:8.3f} "
                  f"+- {row['sigma_area_m2']:.3f} m2  {row['error_percent']:+.3f} %  "
                  f"way {row['way_m']:.1f} m{'' if row['entered'] else ', only looked into'}")
        if extra:
            print("  not in the truth: rooms", ", ".join(map(str, extra)))
    if arguments.output:
        pathlib.Path(arguments.output).write_text(json.dumps(figures, indent=1) + "\n",
                                                  encoding="utf-8")


if __name__ == "__main__":
    main()
