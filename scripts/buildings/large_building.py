#!/usr/bin/python3
"""Makes the large building: one floor of about a hundred rooms, and an hour's walk through it.

Six corridors lead from a cross corridor to an end room each. Rooms of differing width and depth
line both sides of the corridors. The walk goes out along a corridor through the rooms on its left,
turns in the end room and comes back through the rooms on the other side, so that every corridor is
seen twice on the way; when it has been everywhere it returns along the cross corridor and begins
again.

A hall without an end in sight leaves the way along it open. Walls with a passage, as fire doors
have them, divide the corridors, so that there is always one within some fifteen metres.
"""

import argparse
import os
import pathlib
import random
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]

SEED = 2014
NUM_CORRIDORS = 6
CORRIDOR_SPACING = 14.2   # m, from middle to middle
FIRST_CORRIDOR = 7.6      # m, from the building's southern side
HALF_CORRIDOR = 1.3       # m, from a corridor's middle to its wall's
CROSS_CORRIDOR = 2.6      # m, width
CORRIDOR_LENGTH = 40.0    # m
END_ROOM_LENGTH = 6.4     # m
CEILING = 2.8             # m
DOOR = {"width_m": 1.0, "height_m": 2.1}
FIRE_DOOR = {"width_m": 1.4, "height_m": 2.1}
WALK_LENGTH = 3600.0      # m
CLEARANCE = 1.0           # m, from the way inside a room to its walls' middles


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--output", type=pathlib.Path, default=ROOT / "configs", metavar="DIR",
                        help="buildings/ and experiments/ below it receive large_building.yaml "
                        "(default: configs)")
    return parser.parse_args()


class Plan:
    """What the building file says, in the order in which it was added."""

    def __init__(self):
        self.walls = []
        self.solids = []

    def add_wall(self, begin, end, thickness, openings=()):
        """openings: places on the wall (x for walls along x, else y) and what opens there."""
        along = 0 if begin[1] == end[1] else 1
        self.walls.append((begin, end, thickness, [
            (place - begin[along], opening) for place, opening in sorted(openings, key=first)]))

    def add_block(self, low, high):
        self.solids.append([low, (high[0], low[1]), high, (low[0], high[1])])


def first(pair):
    return pair[0]


def centimetres(value):
    return round(value, 2)


class Room:
    """A room beside a corridor: left and right end, depth and door, seen from above."""

    def __init__(self, left, right, numbers):
        self.left = left
        self.right = right
        self.depth = centimetres(numbers.uniform(4.6, 6.0))
        offset = centimetres(numbers.uniform(1.1, 1.6))
        self.door = centimetres(numbers.choice([left + offset, right - offset]))

    def turn(self):
        """How far the way inside the room goes sideways from the door, with its sign."""
        rooms = (self.right - self.door, self.left - self.door)
        side = max(rooms, key=abs)
        length = min(abs(side) - CLEARANCE, 2.6)
        return centimetres(length if side > 0 else -length)


def make_rooms(begin, end, numbers):
    """Rooms side by side that fill the stretch along a corridor."""
    count = round((end - begin) / 4.8)
    shares = [numbers.uniform(0.85, 1.2) for _ in range(count)]
    scale = (end - begin) / sum(shares)
    ends, place = [], begin
    for share in shares[:-1]:
        place = centimetres(place + scale * share)
        ends.append(place)
    ends.append(end)
    return [Room(left, right, numbers) for left, right in zip([begin] + ends, ends)]


def add_rooms(plan, rooms, wall_y, side, numbers):
    """The walls of the rooms along one side (+1: north, -1: south) of a corridor."""
    plan.add_wall((rooms[0].left, wall_y), (rooms[-1].right, wall_y), 0.2,
                  [(room.door, DOOR) for room in rooms])
    for room, after in zip(rooms, rooms[1:]):
        depth = max(room.depth, after.depth)
        plan.add_wall((room.right, wall_y), (room.right, wall_y + side * depth),
                      numbers.choice([0.1, 0.12, 0.16]))
    for room in rooms:
        back = centimetres(wall_y + side * room.depth)
        plan.add_wall((room.left, back), (room.right, back), 0.14)
        if numbers.random() < 0.4:
            add_shaft(plan, room, back, side, numbers)


def add_shaft(plan, room, back, side, numbers):
    """A block in the corner of the room that the way does not come to."""
    width = centimetres(numbers.uniform(0.5, 0.8))
    depth = centimetres(numbers.uniform(0.7, 1.2))
    left = room.left if room.turn() > 0 else room.right - width
    low, high = sorted([back, back - side * depth])
    plan.add_block((left, low), (left + width, high))


def way_through(room, wall_y, side, middle_y):
    """From the corridor's middle into the room, around in it, and back."""
    near = wall_y + side * CLEARANCE
    far = wall_y + side * (room.depth - CLEARANCE)
    beside = room.door + room.turn()
    return [(room.door, middle_y), (room.door, far), (beside, far), (beside, near),
            (room.door, near), (room.door, middle_y)]


def divide_corridor(plan, north, south, middle_y):
    """A fire door near the corridor's middle, away from the doors beside it."""
    doors = [room.door for room in north + south]
    begin, end = north[0].left, north[-1].right
    steps = [centimetres(begin + 0.1 * step) for step in range(int((end - begin) / 0.1))]

    def badness(place):
        return (min(abs(place - door) for door in doors) < 1.2,
                abs(place - (begin + end) / 2))

    place = min(steps, key=badness)
    plan.add_wall((place, middle_y - HALF_CORRIDOR), (place, middle_y + HALF_CORRIDOR), 0.2,
                  [(middle_y, FIRE_DOOR)])


def add_end_room(plan, middle_y, north, south, numbers):
    """The room at the corridor's end; returns the way in it."""
    begin = north[-1].right
    end = centimetres(begin + END_ROOM_LENGTH + numbers.uniform(-1.0, 0.6))
    top = centimetres(middle_y + numbers.uniform(2.8, 4.2))
    bottom = centimetres(middle_y - numbers.uniform(2.8, 4.2))
    plan.add_wall((begin, min(bottom, middle_y - HALF_CORRIDOR - south[-1].depth)),
                  (begin, max(top, middle_y + HALF_CORRIDOR + north[-1].depth)), 0.2,
                  [(middle_y, DOOR)])
    plan.add_wall((begin, top), (end, top), 0.14)
    plan.add_wall((begin, bottom), (end, bottom), 0.14)
    plan.add_wall((end, bottom), (end, top), 0.14)
    near, far = begin + 1.4, end - 1.2
    return [(far, middle_y), (far, top - 1.2), (near, top - 1.2), (near, middle_y)]


def add_corridor(plan, middle_y, numbers):
    """One corridor with its rooms; returns the way through them from the cross corridor."""
    begin, end = CROSS_CORRIDOR, CROSS_CORRIDOR + CORRIDOR_LENGTH
    sides = {}
    for side in (1, -1):
        wall_y = centimetres(middle_y + side * HALF_CORRIDOR)
        sides[side] = make_rooms(begin, end, numbers)
        add_rooms(plan, sides[side], wall_y, side, numbers)
    divide_corridor(plan, sides[1], sides[-1], middle_y)
    way = [(CROSS_CORRIDOR / 2, middle_y)]
    for room in sides[1]:
        way += way_through(room, middle_y + HALF_CORRIDOR, 1, middle_y)
    way += add_end_room(plan, middle_y, sides[1], sides[-1], numbers)
    for room in reversed(sides[-1]):
        way += way_through(room, middle_y - HALF_CORRIDOR, -1, middle_y)
    return way + [(CROSS_CORRIDOR / 2, middle_y)]


def make_building():
    """The plan, its size (x, y) and the way points."""
    numbers = random.Random(SEED)
    plan = Plan()
    middles = [centimetres(FIRST_CORRIDOR + i * CORRIDOR_SPACING) for i in range(NUM_CORRIDORS)]
    size = (CROSS_CORRIDOR + CORRIDOR_LENGTH + END_ROOM_LENGTH + 1.0,
            centimetres(middles[-1] + FIRST_CORRIDOR))
    # Between the corridors' mouths; flush with the corridors' walls, which are 0.2 m thick.
    mouth = HALF_CORRIDOR - 0.1
    ends = [0.0] + [y + sign * mouth for y in middles for sign in (-1, 1)] + [size[1]]
    for low, high in zip(ends[::2], ends[1::2]):
        plan.add_wall((CROSS_CORRIDOR, low), (CROSS_CORRIDOR, high), 0.2)
    for low, high in zip(middles, middles[1:]):
        place = centimetres((low + high) / 2)
        plan.add_wall((0.0, place), (CROSS_CORRIDOR, place), 0.2,
                      [(CROSS_CORRIDOR / 2, FIRE_DOOR)])
    way = [(CROSS_CORRIDOR / 2, middles[0] + 4.0)]
    for middle_y in middles:
        way += add_corridor(plan, middle_y, numbers)
    return plan, size, way


def point(corner):
    return "[" + ", ".join(f"{centimetres(value) + 0.0:g}" for value in corner) + "]"


def building_text(plan, size):
    corners = [(0.0, 0.0), (size[0], 0.0), size, (0.0, size[1])]
    lines = ["# One floor of about a hundred rooms along six corridors, made by",
             "# scripts/buildings/large_building.py.",
             "floor_height_m: 0.0",
             f"ceiling_height_m: {CEILING:g}",
             "outlines:",
             f"  - corners: [{', '.join(map(point, corners))}]",
             "solids:"]
    lines += [f"  - corners: [{', '.join(map(point, solid))}]" for solid in plan.solids]
    lines.append("walls:")
    for begin, end, thickness, openings in plan.walls:
        lines.append(f"  - {{from: {point(begin)}, to: {point(end)}, thickness_m: {thickness:g}"
                     + (", openings: [" if openings else "}"))
        lines += [f"      {{position_m: {centimetres(place):g}, width_m: {opening['width_m']:g}, "
                  f"height_m: {opening['height_m']:g}}}"
                  + ("]}" if (place, opening) == openings[-1] else ",")
                  for place, opening in openings]
    return "\n".join(lines) + "\n"


def experiment_text(way):
    lines = ["# An hour's walk through the rooms and corridors of a large floor, made by",
             "# scripts/buildings/large_building.py.",
             "building: ../buildings/large_building.yaml",
             "rig: ../rigs/paper.yaml",
             "path:",
             "  way_points:"]
    lines += [f"    - {point(place)}" for place in way]
    lines += ["  closed: true",
              f"  length_m: {WALK_LENGTH:g}",
              "  corner_radius_m: 0.5",
              "  body_height_m: 1.5",
              "speed_m_s: 1.0"]
    return "\n".join(lines) + "\n"


def write(path, text):
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_name(path.name + ".partial")
    partial.write_text(text, encoding="utf-8")
    os.replace(partial, path)


def main():
    arguments = parse_arguments()
    plan, size, way = make_building()
    try:
        write(arguments.output / "buildings" / "large_building.yaml", building_text(plan, size))
        write(arguments.output / "experiments" / "large_building.yaml", experiment_text(way))
    except OSError as error:
        print(f"large_building.py: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
