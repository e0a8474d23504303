#!/usr/bin/python3
"""Turns a floor of the MLSTRUCT-FP data set (fp.json) into a building file for the simulator.

The data set gives walls as rectangles in metres, interrupted at doors and windows, and the
floor's slab as a polygon. Heights are not in it.
"""

import argparse
import json
import math
import os
import sys

SAME_COORDINATE = 0.005  # m; drawing errors below this are taken out
COLUMNS = 92


class InputError(Exception):
    """Bad input; the message is one line and names the file."""


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("file", help="fp.json of MLSTRUCT-FP")
    parser.add_argument("--list", action="store_true", help="list the floors and stop")
    parser.add_argument("--floor", help="which floor to import")
    parser.add_argument("--output", help="building file to write")
    parser.add_argument("--ceiling-height", type=float, default=2.5, metavar="M",
                        help="above the floor, in metres (default: %(default)s)")
    arguments = parser.parse_args()
    if not arguments.list and not (arguments.floor and arguments.output):
        parser.error("--floor and --output are needed (or --list)")
    if not 0.1 <= arguments.ceiling_height <= 100.0:
        parser.error("--ceiling-height must lie between 0.1 and 100")
    return arguments


def read_floors(path):
    """Walls and slabs, lists of polygons [(x, y), ...] by floor id."""
    try:
        with open(path, encoding="utf-8") as file:
            data = json.load(file)
        floors = {str(floor): {"walls": [], "slabs": []} for floor in data["floor"]}
        for kind, key in (("walls", "rect"), ("slabs", "slab")):
            for item in data[key].values():
                polygon = [(float(x), float(y)) for x, y in zip(item["x"], item["y"])]
                floors[str(item["floorID"])][kind].append(polygon)
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}") from error
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise InputError(f"{path}: is not a floor plan of MLSTRUCT-FP: {error!r}") from error
    return floors


def merge_close(values):
    """Maps each value to one that all values in its neighbourhood share."""
    merged, group = {}, []
    for value in sorted(set(values)) + [float("inf")]:
        if group and value - group[-1] > SAME_COORDINATE:
            mean = round(sum(group) / len(group), 3)
            merged.update((member, mean) for member in group)
            group = []
        group.append(value)
    return merged


def straighten(polygons):
    """Makes coordinates that differ by a few millimetres equal, so that walls meet."""
    x = merge_close([corner[0] for polygon in polygons for corner in polygon])
    y = merge_close([corner[1] for polygon in polygons for corner in polygon])
    return [[(x[a], y[b]) for a, b in polygon] for polygon in polygons]


def cross(o, a, b):
    return (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0])


def segments_touch(a, b, c, d):
    def within(p, q, r):
        return (min(p[0], q[0]) <= r[0] <= max(p[0], q[0]) and
                min(p[1], q[1]) <= r[1] <= max(p[1], q[1]))

    sides = cross(a, b, c), cross(a, b, d), cross(c, d, a), cross(c, d, b)
    if sides[0] * sides[1] < 0 and sides[2] * sides[3] < 0:
        return True
    return ((sides[0] == 0 and within(a, b, c)) or (sides[1] == 0 and within(a, b, d)) or
            (sides[2] == 0 and within(c, d, a)) or (sides[3] == 0 and within(c, d, b)))


def clean(polygon):
    """Without repeated corners and corners on a straight edge."""
    corners = list(polygon)
    changed = True
    while changed and len(corners) >= 3:
        changed = False
        for i, corner in enumerate(corners):
            before, after = corners[i - 1], corners[(i + 1) % len(corners)]
            if corner in (before, after) or cross(before, corner, after) == 0:
                del corners[i]
                changed = True
                break
    return corners


def is_simple(polygon):
    count = len(polygon)
    if count < 3:
        return False
    edges = [(polygon[i], polygon[(i + 1) % count]) for i in range(count)]
    for i in range(count):
        for j in range(i + 2, count):
            neighbours = i == 0 and j == count - 1
            if not neighbours and segments_touch(*edges[i], *edges[j]):
                return False
    return True


def inset(polygon, distance):
    """The polygon with all edges moved inwards."""
    area = sum(cross((0, 0), polygon[i - 1], corner) for i, corner in enumerate(polygon))
    side = distance if area > 0 else -distance
    corners = []
    for i, corner in enumerate(polygon):
        before, after = polygon[i - 1], polygon[(i + 1) % len(polygon)]
        a, b = math.dist(before, corner), math.dist(corner, after)
        u = (corner[0] - before[0]) / a, (corner[1] - before[1]) / a
        v = (after[0] - corner[0]) / b, (after[1] - corner[1]) / b
        # Both moved edges pass through the corner plus this multiple of (v - u).
        scale = side / (u[0] * v[1] - u[1] * v[0])
        corners.append((corner[0] + scale * (v[0] - u[0]), corner[1] + scale * (v[1] - u[1])))
    return corners


def bounding_rectangle(polygons):
    x = [corner[0] for polygon in polygons for corner in polygon]
    y = [corner[1] for polygon in polygons for corner in polygon]
    return [(min(x), min(y)), (max(x), min(y)), (max(x), max(y)), (min(x), max(y))]


def is_upright(rectangle):
    """Whether the sides run along the axes."""
    return len({x for x, _ in rectangle}) == 2 and len({y for _, y in rectangle}) == 2


def centre_line(rectangle):
    """Ends of the line along the middle of a wall, and the wall's thickness."""
    def middle(p, q):
        return (p[0] + q[0]) / 2, (p[1] + q[1]) / 2

    a, b, c, d = rectangle
    if math.dist(a, b) < math.dist(b, c):
        return middle(a, b), middle(c, d), (math.dist(a, b) + math.dist(c, d)) / 2
    return middle(b, c), middle(d, a), (math.dist(b, c) + math.dist(d, a)) / 2


def shorten(begin, end):
    """Cuts a slanted wall's ends by 3 cm.

    They were drawn up to the far side of the wall that they meet, but for fractions of a
    millimetre; now they end inside it. The simulator refuses faces below a millimetre.
    """
    length = math.dist(begin, end)
    cut = min(0.03, length / 10) / length
    return ((begin[0] + cut * (end[0] - begin[0]), begin[1] + cut * (end[1] - begin[1])),
            (end[0] + cut * (begin[0] - end[0]), end[1] + cut * (begin[1] - end[1])))


def point(corner):
    return "[" + ", ".join(f"{round(value, 4) + 0.0:.10g}" for value in corner) + "]"


def corner_list(polygon):
    lines, line = [], ""
    for corner in polygon:
        if len(line) + len(point(corner)) > COLUMNS - 20:
            lines.append(line)
            line = ""
        line += (", " if line else "") + point(corner)
    return "[" + (",\n" + " " * 15).join(lines + [line]) + "]"


def make_building(path, floor_id, floor, ceiling_height):
    """The text of the building file."""
    if not floor["walls"]:
        raise InputError(f"{path}: floor {floor_id} has no walls")
    for wall in floor["walls"]:
        if len(wall) != 4:
            raise InputError(f"{path}: floor {floor_id} has a wall of {len(wall)} corners")
    polygons = straighten(floor["walls"] + floor["slabs"])
    walls, slabs = polygons[:len(floor["walls"])], polygons[len(floor["walls"]):]
    outlines = [clean(slab) for slab in slabs]
    comment = "The outline is the slab's."
    if not outlines or not all(is_simple(outline) for outline in outlines):
        outlines = [bounding_rectangle(walls)]
        comment = "The slab crosses itself or is missing; the outline is the walls' rectangle."
    if not all(is_upright(wall) for wall in walls):
        # Into the outer walls, which coincide with it but for fractions of a millimetre.
        outlines = [inset(outline, 0.02) for outline in outlines]
    lines = [f"# Floor {floor_id} of MLSTRUCT-FP (MIT licence), walls as drawn, metres.",
             f"# {comment} The ceiling's height is assumed.",
             "floor_height_m: 0.0",
             f"ceiling_height_m: {ceiling_height:g}",
             "outlines:"]
    lines += [f"  - corners: {corner_list(outline)}" for outline in outlines]
    lines.append("walls:")
    for wall in walls:
        begin, end, thickness = centre_line(wall)
        if not is_upright(wall):
            begin, end = shorten(begin, end)
        lines += [f"  - from: {point(begin)}",
                  f"    to: {point(end)}",
                  f"    thickness_m: {round(thickness, 4):g}"]
    return "\n".join(lines) + "\n"


def list_floors(floors):
    print(f"{'floor':>6} {'walls':>6}   size / m")
    for floor_id in sorted(floors, key=lambda name: (len(name), name)):
        polygons = floors[floor_id]["walls"] + floors[floor_id]["slabs"]
        if polygons:
            (left, low), _, (right, high), _ = bounding_rectangle(polygons)
            size = f"{right - left:.1f} x {high - low:.1f}"
            print(f"{floor_id:>6} {len(floors[floor_id]['walls']):>6}   {size}")


def main():
    arguments = parse_arguments()
    try:
        floors = read_floors(arguments.file)
        if arguments.list:
            list_floors(floors)
            return 0
        if arguments.floor not in floors:
            raise InputError(f"{arguments.file}: has no floor {arguments.floor}; see --list")
        text = make_building(arguments.file, arguments.floor, floors[arguments.floor],
                             arguments.ceiling_height)
        partial = arguments.output + ".partial"
        with open(partial, "w", encoding="utf-8") as file:
            file.write(text)
        os.replace(partial, arguments.output)
    except (InputError, OSError) as error:
        print(f"import_floorplan.py: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
