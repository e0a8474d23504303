#!/usr/bin/python3
"""Makes buildings that slope, as triangle meshes, and walks through them: two halls with a ramp
between them, and an attic below a roof."""

import argparse
import math
import pathlib
import sys

import look_alike_floors

ROOT = pathlib.Path(__file__).resolve().parents[2]

HALL_LENGTH, HALL_WIDTH, HEIGHT = 10.0, 8.0, 2.8   # m
RAMP_LENGTH = 8.0                                  # m
RAMP_SIDES = (3.0, 5.6)                            # m, across the halls
RISES = {"halls_gentle_ramp": 0.2, "halls_ramp": 0.8}   # m
MORE_RISES = {"halls_ramp_0.1_m": 0.1, "halls_ramp_0.4_m": 0.4}
# Pillars in the halls: along, across (m); the second pair stands in the upper one.
PILLARS = ((4.0, 4.5, 1.5, 2.0), (7.0, 7.4, 6.3, 6.8), (21.0, 21.6, 6.0, 6.5),
           (24.0, 24.5, 1.5, 2.2))

ATTIC_LENGTH, ATTIC_WIDTH = 16.0, 8.0
# Slope of the roof (deg), and the height (m) that it begins at
ROOFS = {"attic_12_deg": (12.0, 2.6), "attic_35_deg": (35.0, 1.3)}
MORE_ROOFS = {"attic_5_deg": (5.0, 2.6), "attic_20_deg": (20.0, 1.9), "attic_45_deg": (45.0, 0.8)}
POSTS = ((5.0, 5.4, 2.0, 2.4), (11.0, 11.4, 6.4, 6.8), (8.0, 8.2, -0.5, 2.8))
ATTIC_WALK = ((2, 4), (5, 5.5), (8, 4.5), (11, 3.5), (14, 4.5), (12.5, 5.4), (9, 5.2), (7, 4),
              (3, 3))

EXPERIMENT = """\
# {what} Made by scripts/buildings/slopes.py.
building: ../../buildings/{name}.ply
rig: ../../rigs/paper.yaml
path:
  way_points:
{points}
  corner_radius_m: 0.6
  body_height_m: 1.5
  max_turn_rate_deg_s: 60
speed_m_s: 1.0
motion:
  height: {{amplitude_m: 0.02, frequency_hz: 1.8}}
  roll: {{amplitude_deg: 3.0, frequency_hz: 0.9}}
  pitch: {{amplitude_deg: 3.0, frequency_hz: 1.1}}
"""


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--output", type=pathlib.Path, default=ROOT / "configs", metavar="DIR",
                        help="buildings/ and experiments/robustness/ below it receive the "
                        "files (default: configs)")
    parser.add_argument("--more", action="store_true",
                        help="other rises and slopes too, which are not shipped")
    return parser.parse_args()


def two_triangles(a, b, c, d):
    return [(a, b, c), (a, c, d)]


def raised(points, height):
    return [(x, y, z + height) for x, y, z in points]


def wall(begin, end, height):
    """From begin to end, seen from its left."""
    return two_triangles(end, begin, *raised((begin, end), height))


def passage(corners, sides):
    """Floor, ceiling, and the walls along the given sides of a room, seen from inside. corners:
    of the floor, counter-clockwise from above; sides: (begin, end) on its rim."""
    triangles = two_triangles(*corners) + two_triangles(*raised(corners[::-1], HEIGHT))
    for begin, end in sides:
        triangles += wall(begin, end, HEIGHT)
    return triangles


def hall(x, floor, door_x):
    """A hall from x on whose wall at door_x the ramp leaves open."""
    south, north = RAMP_SIDES
    a, b, c, d = ((x, 0.0, floor), (x + HALL_LENGTH, 0.0, floor),
                  (x + HALL_LENGTH, HALL_WIDTH, floor), (x, HALL_WIDTH, floor))
    sides = [(a, b), (c, d)]
    for begin, end in ((b, c), (d, a)):
        if begin[0] != door_x:
            sides.append((begin, end))
            continue
        first, second = (south, north) if begin[1] < end[1] else (north, south)
        sides += [(begin, (door_x, first, floor)), ((door_x, second, floor), end)]
    return passage((a, b, c, d), sides)


def make_halls(rise):
    south, north = RAMP_SIDES
    low, high = HALL_LENGTH, HALL_LENGTH + RAMP_LENGTH
    a, b, c, d = (low, south, 0.0), (high, south, rise), (high, north, rise), (low, north, 0.0)
    rooms = (hall(0.0, 0.0, low) + hall(high, rise, high) +
             passage((a, b, c, d), [(a, b), (c, d)]))
    return [rooms] + [box(pillar, -0.5, HEIGHT + rise + 0.5) for pillar in PILLARS]


def box(sides, low, high):
    x0, x1, y0, y1 = sides
    return list(look_alike_floors.triangles_of(((x0, x1), (y0, y1), (low, high))))


def make_attic(slope_deg, knee):
    length, width = ATTIC_LENGTH, ATTIC_WIDTH
    ridge = knee + math.tan(math.radians(slope_deg)) * width / 2
    floor = ((0.0, 0.0, 0.0), (length, 0.0, 0.0), (length, width, 0.0), (0.0, width, 0.0))
    south = ((length, 0.0, knee), (0.0, 0.0, knee))
    north = ((0.0, width, knee), (length, width, knee))
    top = ((0.0, width / 2, ridge), (length, width / 2, ridge))
    triangles = two_triangles(*floor)
    triangles += wall(floor[0], floor[1], knee) + wall(floor[2], floor[3], knee)
    triangles += two_triangles(*south, *top) + two_triangles(*north, *top[::-1])
    for gable in ((floor[0], floor[3], north[0], top[0], south[1]),
                  (floor[2], floor[1], south[0], top[1], north[1])):
        triangles += [(gable[0], gable[i], gable[i + 1]) for i in (1, 2, 3)]
    return [triangles] + [box(post, -0.5, ridge + 1.0) for post in POSTS]


def halls_walk(rise):
    low, high = HALL_LENGTH, HALL_LENGTH + RAMP_LENGTH
    middle = sum(RAMP_SIDES) / 2
    there = [(2, 2, 0), (2.5, 6, 0), (8, middle, 0), (low, middle, 0), (high, middle, rise),
             (20, middle, rise), (22, 2, rise), (26, 4, rise)]
    return there + [(20, middle, rise), (high, middle, rise), (low, middle, 0), (6, middle, 0),
                    (3, 3, 0)]


def write(output, name, what, elements, walk):
    look_alike_floors.write_ply(output / "buildings" / f"{name}.ply", elements)
    points = "\n".join(f"    - [{x:g}, {y:g}, {z:g}]" for x, y, z in walk)
    (output / "experiments" / "robustness" / f"{name}.yaml").write_text(
        EXPERIMENT.format(what=what, name=name, points=points), encoding="utf-8")


def main():
    arguments = parse_arguments()
    output = arguments.output
    rises = {**RISES, **(MORE_RISES if arguments.more else {})}
    roofs = {**ROOFS, **(MORE_ROOFS if arguments.more else {})}
    (output / "buildings").mkdir(parents=True, exist_ok=True)
    (output / "experiments" / "robustness").mkdir(parents=True, exist_ok=True)
    for name, rise in rises.items():
        write(output, name, f"Two halls, and a ramp that rises {rise:g} m in {RAMP_LENGTH:g} m.",
              make_halls(rise), halls_walk(rise))
    for name, (slope, knee) in roofs.items():
        write(output, name, f"Below a roof of {slope:g} degrees.", make_attic(slope, knee),
              [(x, y, 0) for x, y in ATTIC_WALK])
    return 0


if __name__ == "__main__":
    sys.exit(main())
