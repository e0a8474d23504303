#!/usr/bin/python3
"""Makes a house of two storeys that look alike, as a triangle mesh, and a walk through both.

Both storeys have the same rooms. On each, the eastern half lies 6 cm above the western one, so that
floors and ceilings come in pairs that a map may take for one plane; a straight stair joins the
storeys.
"""

import argparse
import pathlib
import struct
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]

STOREY = 2.9       # m, from floor to floor
SLAB = 0.3         # m
STEP = 0.06        # m, of the eastern half
WEST, EAST = 0.0, 14.0
SOUTH, NORTH = 0.0, 8.0
MIDDLE = 7.0       # m, where the step is
WALL = 0.2         # m
DOOR_WIDTH, DOOR_HEIGHT = 1.0, 2.1
# Walls from south to north: x of their middle, and y of their door's middle.
INNER_WALLS = ((2.7, 7.0), (MIDDLE, 4.0), (10.5, 2.0))
PILLARS = ((5.2, 1.6), (12.6, 6.2))   # south-western corners, 0.4 m wide
STAIR_WIDTH, STAIR_BEGIN, STAIR_END = 1.3, 1.5, 6.0
NUM_STEPS = 16
HOLE_BEGIN = 2.3   # m, where the slab above the stair opens

EXPERIMENT = """\
# Two storeys with the same rooms, halves of which lie 6 cm higher. Made by
# scripts/buildings/look_alike_floors.py.
building: ../../buildings/look_alike_floors.ply
rig: ../../rigs/paper.yaml
path:
  way_points:
{points}
  corner_radius_m: 0.5
  body_height_m: 1.5
  max_turn_rate_deg_s: 60
speed_m_s: 0.9
motion:
  height: {{amplitude_m: 0.02, frequency_hz: 1.8}}
  roll: {{amplitude_deg: 3.0, frequency_hz: 0.9}}
  pitch: {{amplitude_deg: 3.0, frequency_hz: 1.1}}
noise: {{dropout: 0.01}}
"""


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--output", type=pathlib.Path, default=ROOT / "configs", metavar="DIR",
                        help="buildings/ and experiments/robustness/ below it receive "
                        "look_alike_floors (default: configs)")
    return parser.parse_args()


def is_east(x):
    return x >= MIDDLE


def storey_boxes(floor):
    """Inner walls and pillars of a storey, from its floor to the ceiling above."""
    boxes = []
    for x, door in INNER_WALLS:
        low, high = floor, floor + STOREY
        x_range = (x - WALL / 2, x + WALL / 2)
        begin, end = door - DOOR_WIDTH / 2, door + DOOR_WIDTH / 2
        lintel = floor + STEP * is_east(x) + DOOR_HEIGHT
        boxes.append((x_range, (SOUTH, begin), (low, high)))
        boxes.append((x_range, (end, NORTH), (low, high)))
        boxes.append((x_range, (begin, end), (lintel, high)))
    for x, y in PILLARS:
        boxes.append(((x, x + 0.4), (y, y + 0.4), (floor, floor + STOREY)))
    return boxes


def slab_boxes(top, with_hole):
    """The slab whose western top is at the given height."""
    south, north = (SOUTH - WALL, NORTH + WALL)
    z_west, z_east = (top - SLAB, top), (top + STEP - SLAB, top + STEP)
    boxes = [((MIDDLE, EAST + WALL), (south, north), z_east)]
    if not with_hole:
        return boxes + [((WEST - WALL, MIDDLE), (south, north), z_west)]
    return boxes + [
        ((WEST - WALL, MIDDLE), (south, HOLE_BEGIN), z_west),
        ((STAIR_WIDTH, MIDDLE), (HOLE_BEGIN, STAIR_END), z_west),
        ((WEST - WALL, MIDDLE), (STAIR_END, north), z_west)]


def stair_boxes():
    tread = (STAIR_END - STAIR_BEGIN) / NUM_STEPS
    return [((WEST, STAIR_WIDTH),
             (STAIR_BEGIN + i * tread, STAIR_BEGIN + (i + 1) * tread),
             (0.0, (i + 1) * STOREY / NUM_STEPS)) for i in range(NUM_STEPS)]


def make_boxes():
    top = 2 * STOREY + STEP
    boxes = [((WEST - WALL, WEST), (SOUTH - WALL, NORTH + WALL), (-SLAB, top)),
             ((EAST, EAST + WALL), (SOUTH - WALL, NORTH + WALL), (-SLAB, top)),
             ((WEST, EAST), (SOUTH - WALL, SOUTH), (-SLAB, top)),
             ((WEST, EAST), (NORTH, NORTH + WALL), (-SLAB, top))]
    for storey in range(2):
        boxes += storey_boxes(storey * STOREY)
        boxes += slab_boxes(storey * STOREY, with_hole=storey == 1)
    return boxes + slab_boxes(2 * STOREY, with_hole=False) + stair_boxes()


def triangles_of(box):
    """Twelve triangles, counter-clockwise from outside."""
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for side in range(2):
            corners = []
            for at_u, at_v in ((0, 0), (1, 0), (1, 1), (0, 1)):
                corner = [0.0, 0.0, 0.0]
                corner[axis] = box[axis][side]
                corner[u] = box[u][at_u]
                corner[v] = box[v][at_v]
                corners.append(tuple(corner))
            if side == 0:
                corners.reverse()
            yield corners[0], corners[1], corners[2]
            yield corners[0], corners[2], corners[3]


def write_ply(path, elements):
    """elements: the triangles of each."""
    vertices = {}
    faces = []
    for element, triangles in enumerate(elements):
        for triangle in triangles:
            faces.append(([vertices.setdefault(p, len(vertices)) for p in triangle], element))
    header = ("ply\nformat binary_little_endian 1.0\ncomment metres, z up\n"
              f"element vertex {len(vertices)}\n"
              "property float x\nproperty float y\nproperty float z\n"
              f"element face {len(faces)}\n"
              "property list uchar int vertex_indices\nproperty int element\n"
              "property uchar glass\nend_header\n")
    with open(path, "wb") as file:
        file.write(header.encode())
        for vertex in vertices:
            file.write(struct.pack("<3f", *vertex))
        for corners, element in faces:
            file.write(struct.pack("<B4iB", 3, *corners, element, 0))


def make_walk():
    """From the eastern end of the ground floor up the stair to the eastern end above."""
    on_a_storey = [(1.9, 7.0), (2.7, 7.0), (4.0, 7.0), (5.0, 4.2), (6.7, 4.0), (7.3, 4.0),
                   (8.7, 2.4), (10.5, 2.0), (12.5, 2.0)]
    way = [(x, y, STEP * is_east(x)) for x, y in reversed(on_a_storey)]
    way += [(1.9, 1.0, 0.0), (STAIR_WIDTH / 2, 0.9, 0.0), (STAIR_WIDTH / 2, STAIR_BEGIN, 0.0),
            (STAIR_WIDTH / 2, STAIR_END, STOREY), (STAIR_WIDTH / 2, 6.9, STOREY)]
    return way + [(x, y, STOREY + STEP * is_east(x)) for x, y in on_a_storey]


def main():
    output = parse_arguments().output
    (output / "buildings").mkdir(parents=True, exist_ok=True)
    (output / "experiments" / "robustness").mkdir(parents=True, exist_ok=True)
    write_ply(output / "buildings" / "look_alike_floors.ply",
              [triangles_of(box) for box in make_boxes()])
    points = "\n".join(f"    - [{x:g}, {y:g}, {z:g}]" for x, y, z in make_walk())
    path = output / "experiments" / "robustness" / "look_alike_floors.yaml"
    path.write_text(EXPERIMENT.format(points=points), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
