#!/usr/bin/python3
"""Draws buildings and walks through them at random, to judge the mapper on worlds that nothing was
tuned on.

    furnished   rooms along a corridor, with cupboards, shelves and tables
    crowd       such rooms, with people and swinging doors
    recessed    such rooms; a door leaf lies behind each end wall of the corridor
    closets     such rooms, and dead ends that are hardly deeper than the rig
    storeys     two storeys with the same rooms, some centimetres apart; a straight stair
    attic       below a pitched roof
    ramp        two halls and a ramp between them
    round       a corridor that leads into a round room
    curved      a corridor that bends
    racks       a hall with rows of racks

A world is drawn from its kind and its number alone. Of world N of a kind, buildings/KIND_N.yaml and
experiments/KIND_N.yaml are written below --output, for plumbline_simulate and for
scripts/experiments/robustness.py --experiments.
"""

import argparse
import math
import os
import pathlib
import random
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]

CLEARANCE = 0.7       # m, between the way and what stands in a room
DOOR_HEIGHT = 2.1     # m
STEP_HEIGHT = 0.18    # m, of stairs, about
GRID = 0.02           # m
RIGS = ("paper", "paper_1cm", "orthogonal")


class Numbers(random.Random):
    """Random numbers in steps of 2 cm, so that faces lie on whole centimetres and meet."""

    def uniform(self, a, b):
        return round(super().uniform(a, b) / GRID) * GRID


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("kinds", nargs="*", metavar="KIND", help="(default: all)")
    parser.add_argument("--first", type=int, default=1, metavar="N",
                        help="number of the first world (1)")
    parser.add_argument("--number", type=int, default=6, metavar="N", help="worlds of a kind (6)")
    parser.add_argument("--rig", choices=RIGS, default="paper",
                        help="of configs/rigs (paper)")
    parser.add_argument("--output", type=pathlib.Path, required=True, metavar="DIR")
    return parser.parse_args()


def rounded(value):
    """Numbers to millimetres, also those in lists and dictionaries."""
    if isinstance(value, float):
        return round(value, 3)
    if isinstance(value, (list, tuple)):
        return [rounded(one) for one in value]
    if isinstance(value, dict):
        return {key: rounded(one) for key, one in value.items()}
    return value


def yaml_text(mapping, indent=0):
    """YAML of a mapping whose lists have an element a line, in flow style."""
    lines = []
    for key, value in mapping.items():
        if isinstance(value, dict) and indent == 0:
            lines += [f"{key}:"] + yaml_text(value, 2)
        elif isinstance(value, list) and value and isinstance(value[0], (list, dict)):
            lines += [f"{' ' * indent}{key}:"]
            lines += [f"{' ' * indent}  - {flow(one)}" for one in value]
        else:
            lines.append(f"{' ' * indent}{key}: {flow(value)}")
    return lines


def flow(value):
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key}: {flow(one)}" for key, one in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(flow(one) for one in value) + "]"
    if isinstance(value, bool):
        return str(value).lower()
    return str(value)


def box(low, high):
    return {"corners": [low, (high[0], low[1]), high, (low[0], high[1])]}


class World:
    """A building of one storey, what moves in it, and the way of the rig."""

    def __init__(self, numbers):
        self.numbers = numbers
        self.storey = {"floor_height_m": 0.0, "ceiling_height_m": numbers.uniform(2.4, 3.2),
                       "outlines": [], "solids": [], "walls": [], "furniture": []}
        self.more_storeys = []
        self.way = []
        self.people = []
        self.doors = []

    def building(self):
        storeys = [{key: value for key, value in storey.items() if value != []}
                   for storey in (self.storey, *self.more_storeys)]
        return storeys[0] if len(storeys) == 1 else {"storeys": storeys}

    def experiment(self, name, rig):
        numbers = self.numbers
        moving = {key: value for key, value in (("people", self.people), ("doors", self.doors))
                  if value}
        return {
            "building": f"../buildings/{name}.yaml", "rig": rig,
            "path": {"way_points": self.way, "corner_radius_m": 0.4,
                     "body_height_m": numbers.uniform(1.2, 1.6), "max_turn_rate_deg_s": 60},
            "speed_m_s": numbers.uniform(0.6, 1.1),
            "motion": {axis: {unit: numbers.uniform(*amplitudes),
                              "frequency_hz": numbers.uniform(*frequencies)}
                       for axis, unit, amplitudes, frequencies in (
                           ("roll", "amplitude_deg", (1.0, 3.0), (0.8, 1.1)),
                           ("pitch", "amplitude_deg", (1.0, 3.0), (0.9, 1.3)),
                           ("height", "amplitude_m", (0.0, 0.025), (1.6, 2.0)))},
            "noise": {"dropout": numbers.uniform(0.0, 0.02)},
            **({"moving": moving} if moving else {})}


class Room:
    """A room beside the corridor: its box, its door in the corridor's wall, and its way in."""

    def __init__(self, low, high, wall_y, numbers):
        self.low, self.high = low, high
        self.wall_y = wall_y
        self.side = 1.0 if low[1] >= wall_y - 1e-9 else -1.0
        self.door_width = numbers.uniform(0.85, 1.05)
        margin = self.door_width / 2 + 0.25
        self.door = numbers.uniform(low[0] + margin, high[0] - margin)

    @property
    def width(self):
        return self.high[0] - self.low[0]

    @property
    def depth(self):
        return self.high[1] - self.low[1]

    def inside(self, along, across):
        """A place in the room: from its western wall, and from the corridor's wall (m)."""
        return (self.low[0] + along, self.wall_y + self.side * across)

    def way(self):
        """From before the door to a turn in the room and back; a place that is too small for a
        turn is entered and left."""
        before = (self.door, self.wall_y - self.side * 0.7)
        far_end = max((CLEARANCE, self.width - CLEARANCE),
                      key=lambda along: abs(self.low[0] + along - self.door))
        if self.depth < 2.6 or self.width < 2.2:
            return [before, (self.door, self.wall_y + self.side * (self.depth - 0.55)), before]
        across = min(1.5, self.depth - 1.1)
        begin = (self.door, self.wall_y + self.side * across)
        return [before, begin, self.inside(far_end, across), begin, before]


def rooms_beside(begin, end, wall_y, side, widths, depths, numbers):
    """Rooms side by side that fill a stretch of the corridor."""
    rooms, place = [], begin
    while end - place >= widths[0]:
        width = min(numbers.uniform(*widths), end - place)
        if end - place - width < widths[0]:
            width = end - place
        depth = numbers.uniform(*depths)
        far = wall_y + side * depth
        rooms.append(Room((place, min(wall_y, far)), (place + width, max(wall_y, far)), wall_y,
                          numbers))
        place += width
    return rooms


def add_rooms(world, rooms, length, wall_thickness):
    """One outline about all rooms of a side, walls between them, and doors to the corridor."""
    numbers, wall_y, side = world.numbers, rooms[0].wall_y, rooms[0].side
    depth = max(room.depth for room in rooms)
    far = wall_y + side * depth
    openings = [{"position_m": room.door, "width_m": room.door_width, "height_m": DOOR_HEIGHT}
                for room in rooms]
    world.storey["outlines"].append(box((0.0, min(wall_y, far)), (length, max(wall_y, far))))
    world.storey["walls"].append({"from": (0.0, wall_y), "to": (length, wall_y),
                                  "thickness_m": wall_thickness, "openings": openings})
    for room in rooms[:-1]:
        world.storey["walls"].append({"from": (room.high[0], wall_y), "to": (room.high[0], far),
                                      "thickness_m": numbers.uniform(0.08, 0.2)})
    for room in rooms:
        back = wall_y + side * room.depth
        if depth - room.depth > 0.25:
            world.storey["solids"].append(box((room.low[0], min(back, far)),
                                              (room.high[0], max(back, far))))


def along_corridor(numbers, widths=(3.0, 6.0), depths=(3.4, 5.5), visited=0.6):
    """Rooms on both sides of a straight corridor; the way goes along it through some of them, and
    back to its begin. Returns the world and its rooms."""
    world = World(numbers)
    length, half = numbers.uniform(14.0, 22.0), numbers.uniform(0.85, 1.3)
    world.storey["outlines"].append(box((0.0, -half), (length, half)))
    rooms = []
    for side in (-1.0, 1.0):
        of_side = rooms_beside(0.0, length, side * half, side, widths, depths, numbers)
        add_rooms(world, of_side, length, numbers.uniform(0.1, 0.24))
        rooms += of_side
    block = numbers.uniform(0.3, 0.6)
    world.storey["solids"].append(box((0.0, half - block), (numbers.uniform(0.2, 0.5), half)))
    rooms.sort(key=lambda room: room.door)
    seen = [room for room in rooms if numbers.random() < visited] or rooms[:1]
    world.way = [(1.1, 0.0)]
    for room in seen:
        world.way += [(room.door, 0.0), *room.way()[1:-1], (room.door, 0.0)]
    world.way += [(length - 1.2, 0.0), (1.3, 0.1)]
    return world, rooms, length, half


def furnish(world, rooms):
    """Cupboards, shelves and tables along the back walls, clear of the way."""
    numbers = world.numbers
    for room in rooms:
        place = 0.05
        while place < room.width - 0.8:
            kind = numbers.choice(("box", "box", "shelf", "table", "gap"))
            size = [numbers.uniform(0.45, 1.4), numbers.uniform(0.35, 0.8),
                    numbers.uniform(0.7, 2.0)]
            if kind == "table":
                size[2] = numbers.uniform(0.7, 0.78)
            if place + size[0] > room.width - 0.1:
                break
            across = room.depth - size[1] / 2 - numbers.uniform(0.0, 0.06) - 0.01
            if kind != "gap" and across - size[1] / 2 > min(1.5, room.depth - 1.1) + 0.45:
                world.storey["furniture"].append({
                    "kind": kind, "position": room.inside(place + size[0] / 2, across),
                    "size_m": size, "yaw_deg": 0.0 if room.side > 0 else 180.0})
            place += size[0] + numbers.choice((0.0, 0.02, numbers.uniform(0.1, 0.8)))


def furnished(numbers):
    world, rooms, _, _ = along_corridor(numbers)
    furnish(world, rooms)
    return world


def crowd(numbers):
    world, rooms, length, half = along_corridor(numbers, visited=0.5)
    for _ in range(numbers.randint(3, 8)):
        y = numbers.uniform(-half + 0.3, half - 0.3)
        ends = sorted((numbers.uniform(0.5, length / 2), numbers.uniform(length / 2, length - 0.5)))
        numbers.shuffle(ends)
        world.people.append({"walks": [(ends[0], y), (ends[1], y)],
                             "speed_m_s": numbers.uniform(0.5, 1.4)})
    for room in rooms:
        if numbers.random() < 0.5:
            world.people.append({
                "walks": [room.inside(0.6, 0.8), room.inside(room.width - 0.6, room.depth - 0.6)],
                "speed_m_s": numbers.uniform(0.3, 1.0)})
        if numbers.random() < 0.4:
            world.doors.append({
                "hinge": (room.door - room.door_width / 2, room.wall_y),
                "width_m": room.door_width, "height_m": DOOR_HEIGHT - 0.05, "shut_deg": 0.0,
                "open_deg": room.side * 90.0, "period_s": numbers.uniform(6.0, 15.0)})
    world.people.append(numbers.choice((
        {"follows_m": numbers.uniform(0.9, 1.8)},
        {"circles_m": numbers.uniform(0.8, 1.2), "speed_m_s": numbers.uniform(0.4, 0.8)})))
    return world


def recessed(numbers):
    world, _, length, half = along_corridor(numbers)
    for end in (0.0, length):
        depth = numbers.uniform(0.03, 0.12)
        x = depth / 2 if end == 0.0 else length - depth / 2
        world.storey["walls"].append({
            "from": (x, -half), "to": (x, half), "thickness_m": depth,
            "openings": [{"position_m": half, "width_m": numbers.uniform(0.8, 1.0),
                          "height_m": DOOR_HEIGHT}]})
    world.storey["solids"] = [solid for solid in world.storey["solids"]
                              if solid["corners"][0][0] > 0.0 or abs(solid["corners"][0][1]) > half]
    return world


def closets(numbers):
    world, _, _, _ = along_corridor(numbers, widths=(1.3, 4.0), depths=(1.2, 3.0))
    return world


def storeys(numbers):
    world = World(numbers)
    length, depth = numbers.uniform(9.5, 13.0), numbers.uniform(5.8, 8.0)
    stair = numbers.uniform(1.15, 1.35)
    height = numbers.uniform(2.7, 3.1)
    clear = height - numbers.uniform(0.25, 0.35)
    begin, run = numbers.uniform(2.4, 2.8), numbers.uniform(4.3, 5.0)
    wall_y = stair + numbers.uniform(0.05, 0.1)
    inner_x = numbers.uniform(0.42, 0.6) * length
    door = numbers.uniform(1.0, depth - wall_y - 1.0)
    thickness = [numbers.uniform(0.1, 0.2) for _ in range(2)]
    pillar = (length - numbers.uniform(1.0, 1.6), depth - numbers.uniform(1.0, 1.5))
    # by which outer walls of the upper storey stand elsewhere: outwards, over the lower ones'
    apart = numbers.uniform(0.03, 0.1) * numbers.choice((-1.0, 1.0))
    moved = [apart * (numbers.random() < 0.6) for _ in range(2)]
    if moved == [0.0, 0.0]:
        moved[0] = apart
    step = 0.3 * run / 4.5
    for level in (0, 1):
        outline = box((0.0, 0.0), (length + level * moved[0], depth + level * moved[1]))
        storey = {"floor_height_m": level * height, "ceiling_height_m": level * height + clear,
                  "outlines": [outline], "walls": [
                      {"from": (begin, wall_y) if level == 0 else (0.0, wall_y + 0.15),
                       "to": (begin + run + 0.4, wall_y + 0.15 * level),
                       "thickness_m": thickness[0]},
                      {"from": (inner_x, wall_y), "to": (inner_x, depth + level * moved[1]),
                       "thickness_m": thickness[1],
                       "openings": [{"position_m": door, "width_m": 1.0,
                                     "height_m": DOOR_HEIGHT}]}],
                  "solids": [box(pillar, (pillar[0] + 0.4, pillar[1] + 0.4))]}
        if level == 0:
            storey["stairs"] = [{"from": (begin, stair / 2, 0.0),
                                 "to": (begin + run, stair / 2, height), "width_m": stair,
                                 "steps": round(height / STEP_HEIGHT), "thickness_m": 0.3}]
            world.storey = storey
        else:
            storey["floor_openings"] = [box((begin + 0.7 + step, 0.0), (begin + run, stair))]
            world.more_storeys = [storey]
    door_y = wall_y + door
    high = (height,)
    east = (length - 1.1, door_y if door_y < depth - 2.2 else depth - 2.2)
    corner = (min(begin - 1.0, 1.2),)
    world.way = [(*east, 0.0), (inner_x + 0.8, door_y, 0.0), (inner_x - 1.2, door_y, 0.0),
                 (*corner, door_y, 0.0), (*corner, stair / 2 + 0.05, 0.0),
                 (begin, stair / 2, 0.0), (begin + run, stair / 2) + high,
                 (begin + run + 0.9, stair / 2 + 0.2) + high, (*east,) + high,
                 (inner_x + 0.8, door_y) + high, (inner_x - 1.2, door_y) + high,
                 (1.4, depth - 1.1) + high]
    return world


def attic(numbers):
    world = World(numbers)
    length, width = numbers.uniform(11.0, 18.0), numbers.uniform(6.5, 9.0)
    slope = numbers.uniform(6.0, 48.0)
    ridge = numbers.uniform(2.7, 3.2) + 0.25 * width * math.tan(math.radians(slope)) / 2
    world.storey["ceiling_height_m"] = ridge + 1.0
    eave = ridge - width / 2 * math.tan(math.radians(slope))
    if eave < 0.3:   # a roof that meets the floor would end the room
        ridge += 0.3 - eave
        world.storey["ceiling_height_m"] = ridge + 1.0
    # the way keeps to where a man can stand
    half = min(width / 2 - 0.9, (ridge - 2.1) / math.tan(math.radians(slope)))
    middle = width / 2
    world.storey["outlines"].append(box((0.0, 0.0), (length, width)))
    world.storey["roof"] = [{"ridge": [(0.0, middle), (length, middle)], "height_m": ridge,
                             "slope_deg": slope}]
    for place in (0.3, 0.7):
        x, y = place * length, middle + numbers.choice((-1.0, 1.0)) * (half + 0.4)
        y = min(max(y, 0.05), width - 0.45)
        world.storey["solids"].append(box((x, y), (x + 0.4, y + 0.4)))
    wanderings = [(share * length, middle + numbers.uniform(-half, half) * 0.7)
                  for share in (0.12, 0.35, 0.55, 0.88)]
    world.way = [*wanderings, (0.8 * length, middle), (0.45 * length, middle + 0.2 * half),
                 (0.2 * length, middle - 0.3 * half)]
    return world


def ramp(numbers):
    world = World(numbers)
    first, run, second = (numbers.uniform(*span) for span in ((7.0, 11.0), (5.0, 9.0), (7.0, 10.0)))
    rise, width = numbers.uniform(0.08, 0.9), numbers.uniform(6.5, 9.0)
    breadth = numbers.uniform(1.8, 2.8)
    middle = numbers.uniform(0.4, 0.6) * width
    begin, end = first, first + run
    last = end + second
    ceiling = world.storey["ceiling_height_m"]
    far = box((end, 0.0), (last, width))
    far.update(floor_height_m=rise, ceiling_height_m=ceiling + rise)
    world.storey["outlines"] = [box((0.0, 0.0), (first, width)), far]
    world.storey["ramps"] = [{"from": (begin, middle, 0.0), "to": (end, middle, rise),
                              "width_m": breadth}]
    world.storey["solids"] = [box((0.45 * first, 0.8), (0.45 * first + 0.4, 1.3)),
                              box((end + 0.5 * second, width - 1.4),
                                  (end + 0.5 * second + 0.5, width - 0.9))]
    world.way = [(1.2, middle - 1.0, 0.0), (0.7 * first, middle, 0.0), (begin, middle, 0.0),
                 (end, middle, rise), (end + 0.3 * second, middle, rise),
                 (last - 1.2, width - 2.6, rise), (last - 1.3, 1.5, rise),
                 (end + 0.4 * second, 1.6, rise), (end + 0.8, middle, rise), (end, middle, rise),
                 (begin, middle, 0.0), (0.6 * first, middle + 0.4, 0.0), (1.5, width - 1.4, 0.0)]
    return world


def round_room(numbers):
    world = World(numbers)
    radius, half = numbers.uniform(3.0, 6.0), numbers.uniform(0.9, 1.3)
    length = numbers.uniform(6.0, 12.0)
    mouth = math.sqrt(radius * radius - half * half)
    middle = length + mouth
    world.storey["outlines"] = [{"corners": [
        (0.0, -half), (length, -half), {"through": (middle + radius, 0.0), "to": (length, half)},
        (0.0, half)]}]
    world.storey["solids"] = [box((0.4 * length, half - 0.3), (0.4 * length + 0.5, half + 0.1))]
    for _ in range(numbers.randint(1, 3)):
        angle = math.radians(numbers.uniform(35.0, 325.0) + 180.0)
        away = radius - 0.35
        x, y = middle + away * math.cos(angle), away * math.sin(angle)
        world.storey["solids"].append(box((x - 0.2, y - 0.2), (x + 0.2, y + 0.2)))
    turn = radius - 1.6
    world.way = [(1.2, 0.0), (length, 0.0)]
    world.way += [(middle + turn * math.cos(angle), turn * math.sin(angle))
                  for angle in (math.radians(180 + side) for side in (20, 90, 180, 270, 340))]
    world.way += [(length, 0.0), (1.6, 0.1)]
    return world


def curved(numbers):
    world = World(numbers)
    half, radius = numbers.uniform(1.0, 1.4), numbers.uniform(6.0, 20.0)
    bend = math.radians(numbers.uniform(35.0, 110.0))
    legs = [numbers.uniform(5.0, 9.0) for _ in range(2)]

    def at(angle, across, further=0.0):
        """A place on the bend or past its end, and across it to the left."""
        r = radius - across
        return (legs[0] + r * math.sin(angle) + further * math.cos(angle),
                radius - r * math.cos(angle) + further * math.sin(angle))

    world.storey["outlines"] = [{"corners": [
        (0.0, -half), (legs[0], -half), {"through": at(bend / 2, -half), "to": at(bend, -half)},
        at(bend, -half, legs[1]), at(bend, half, legs[1]), at(bend, half),
        {"through": at(bend / 2, half), "to": (legs[0], half)}, (0.0, half)]}]
    inner = [at(bend, half + side, 0.5 * legs[1] + place)
             for side, place in ((0.1, 0.0), (0.1, 0.4), (-0.3, 0.4), (-0.3, 0.0))]
    world.storey["solids"] = [box((0.5 * legs[0], -half - 0.1), (0.5 * legs[0] + 0.4, -half + 0.3)),
                              {"corners": inner}]
    middle = [at(share * bend, 0.0) for share in (0.0, 0.25, 0.5, 0.75, 1.0)]
    end = at(bend, 0.0, legs[1] - 1.2)
    world.way = [(1.2, 0.0), *middle, end, *reversed(middle), (1.5, 0.1)]
    return world


def racks(numbers):
    world = World(numbers)
    length, width = numbers.uniform(16.0, 36.0), numbers.uniform(12.0, 26.0)
    world.storey["ceiling_height_m"] = numbers.uniform(4.0, 7.0)
    world.storey["outlines"] = [box((0.0, 0.0), (length, width))]
    aisle, depth = numbers.uniform(2.0, 3.0), numbers.uniform(0.8, 1.2)
    row, rows = 1.8 + depth / 2, []
    while row + depth / 2 < width - 1.8:
        rows.append(row)
        row += aisle + depth
    height = numbers.uniform(2.0, 3.2)
    for row in rows:
        place = 2.2
        while place < length - 4.0:
            size = numbers.uniform(1.8, 3.2)
            if place + size > length - 2.0:
                break
            if numbers.random() < 0.85:
                world.storey["furniture"].append({
                    "kind": numbers.choice(("shelf", "shelf", "box")),
                    "position": (place + size / 2, row), "size_m": [size, depth, height],
                    "yaw_deg": 0.0})
            place += size + 0.02
    aisles = [1.0] + [row + (aisle + depth) / 2 for row in rows[:4]]
    for number, y in enumerate(y for y in aisles if y <= width - 0.9):
        ends = [(1.1, y), (length - 1.0, y)]
        world.way += ends[::-1] if number % 2 else ends
    if len(world.way) < 4:
        world.way += [(1.1, width - 0.9)]
    return world


KINDS = {"furnished": furnished, "crowd": crowd, "recessed": recessed, "closets": closets,
         "storeys": storeys, "attic": attic, "ramp": ramp, "round": round_room, "curved": curved,
         "racks": racks}


def draw(kind, number):
    """World number N of a kind: the same at any time and place."""
    return KINDS[kind](Numbers(f"{kind} {number}"))


def write(kind, number, rig, output):
    world = draw(kind, number)
    name = f"{kind}_{number}"
    experiments = output / "experiments"
    rig_file = os.path.relpath(ROOT / "configs" / "rigs" / f"{rig}.yaml", experiments)
    for folder, content in (("buildings", world.building()),
                            ("experiments", world.experiment(name, rig_file))):
        path = output / folder / f"{name}.yaml"
        path.parent.mkdir(parents=True, exist_ok=True)
        text = "\n".join(yaml_text(rounded(content))) + "\n"
        path.write_text(f"# World {number} of kind {kind}, drawn at random by "
                        f"scripts/buildings/random_building.py.\n{text}", encoding="utf-8")


def main():
    arguments = parse_arguments()
    unknown = [kind for kind in arguments.kinds if kind not in KINDS]
    if unknown:
        sys.exit(f"error: no kind {unknown[0]}; there are {', '.join(KINDS)}")
    kinds = arguments.kinds or list(KINDS)
    for kind in kinds:
        for number in range(arguments.first, arguments.first + arguments.number):
            write(kind, number, arguments.rig, arguments.output)
    print(f"{len(kinds) * arguments.number} worlds below {arguments.output}")


if __name__ == "__main__":
    main()
