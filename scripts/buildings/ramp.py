#!/usr/bin/python3
"""Makes a corridor with a ramp in it, as a triangle mesh: floor and ceiling that are neither
horizontal nor vertical, between two level stretches with niches."""

import argparse
import pathlib
import sys

import look_alike_floors

ROOT = pathlib.Path(__file__).resolve().parents[2]

WIDTH = 2.6                                                # m
HEIGHT = 2.7                                               # m, of the ceiling above the floor
PROFILE = ((0.0, 0.0), (10.0, 0.0), (24.0, 1.2), (34.0, 1.2))  # m: along, and the floor's height
# Blocks on the level stretches: along, across (low and high, m), floor's height
BLOCKS = ((3.0, 3.8, 0.0, 0.5, 0.0), (7.0, 7.5, 2.0, 2.6, 0.0), (26.0, 27.0, 2.1, 2.6, 1.2),
          (30.0, 30.6, 0.0, 0.6, 1.2))


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--output", type=pathlib.Path, default=ROOT / "configs", metavar="DIR",
                        help="buildings/ below it receives ramp.ply (default: configs)")
    return parser.parse_args()


def corridor_quads():
    """Floor, ceiling and walls, counter-clockwise from inside."""
    for (x0, z0), (x1, z1) in zip(PROFILE, PROFILE[1:]):
        floor = [(x0, 0.0, z0), (x1, 0.0, z1), (x1, WIDTH, z1), (x0, WIDTH, z0)]
        ceiling = [(x, y, z + HEIGHT) for x, y, z in floor]
        yield floor
        yield ceiling[::-1]
        yield [floor[1], floor[0], ceiling[0], ceiling[1]]
        yield [floor[3], floor[2], ceiling[2], ceiling[3]]
    (x0, z0), (x1, z1) = PROFILE[0], PROFILE[-1]
    yield [(x0, 0.0, z0), (x0, WIDTH, z0), (x0, WIDTH, z0 + HEIGHT), (x0, 0.0, z0 + HEIGHT)]
    yield [(x1, WIDTH, z1), (x1, 0.0, z1), (x1, 0.0, z1 + HEIGHT), (x1, WIDTH, z1 + HEIGHT)]


def make_elements():
    """Triangles of each element: the corridor, and the blocks."""
    elements = [[triangle for a, b, c, d in corridor_quads()
                 for triangle in ((a, b, c), (a, c, d))]]
    for x0, x1, y0, y1, floor in BLOCKS:
        box = ((x0, x1), (y0, y1), (floor, floor + HEIGHT))
        elements.append(list(look_alike_floors.triangles_of(box)))
    return elements


def main():
    output = parse_arguments().output / "buildings"
    output.mkdir(parents=True, exist_ok=True)
    look_alike_floors.write_ply(output / "ramp.ply", make_elements())
    return 0


if __name__ == "__main__":
    sys.exit(main())
