"""The rules of the CityJSON 2.0 specification that building.city.json has to keep.

Written from the text of the specification (https://www.cityjson.org/specs/2.0.1/): sections 2
(file), 3 (city objects: parents and children), 4 (geometry), 5 (semantics), 6 (transform). It is
no replacement for the published schema, which is not in Debian.
"""

import re

FIRST_LEVEL = {"Building"}
PARENTS = {"BuildingStorey": {"Building", "BuildingPart"},
           "BuildingRoom": {"Building", "BuildingPart", "BuildingStorey", "BuildingUnit"}}
SURFACES = {"RoofSurface", "GroundSurface", "WallSurface", "ClosureSurface",
            "OuterCeilingSurface", "OuterFloorSurface", "Window", "Door", "InteriorWallSurface",
            "CeilingSurface", "FloorSurface"}
DEPTH = {"MultiSurface": 2, "Solid": 3}  # of boundaries above a ring
TOP = {"type", "version", "transform", "CityObjects", "vertices", "metadata"}
OBJECT = {"type", "attributes", "parents", "children", "geometry", "geographicalExtent"}


def violations(city):
    """What is wrong with the file, in words; empty where nothing is."""
    return (_file(city) + _objects(city["CityObjects"]) + _vertices(city) +
            [f"{name}: {wrong}" for name, thing in city["CityObjects"].items()
             for geometry in thing.get("geometry", [])
             for wrong in _geometry(geometry, city["vertices"])])


def _file(city):
    wrong = []
    if city.get("type") != "CityJSON" or city.get("version") != "2.0":
        wrong.append("not CityJSON 2.0")
    missing = {"type", "version", "transform", "CityObjects", "vertices"} - set(city)
    wrong += [f"no {key}" for key in missing]
    wrong += [f"{key} is no member of the specification" for key in set(city) - TOP]
    for key in ("scale", "translate"):
        values = city["transform"].get(key, [])
        if len(values) != 3 or not all(isinstance(v, (int, float)) for v in values):
            wrong.append(f"transform: {key} is not three numbers")
    return wrong


def _objects(objects):
    wrong = []
    for name, thing in objects.items():
        kind = thing.get("type")
        wrong += [f"{name}: {key} is no member of a city object" for key in set(thing) - OBJECT]
        parents = thing.get("parents", [])
        if kind in FIRST_LEVEL:
            if parents:
                wrong.append(f"{name}: has parents")
        elif kind not in PARENTS:
            wrong.append(f"{name}: is of no type known here: {kind}")
        elif len(parents) != 1 or objects.get(parents[0], {}).get("type") not in PARENTS[kind]:
            wrong.append(f"{name}: has no parent that it may have")
        for parent in parents:
            if name not in objects.get(parent, {}).get("children", []):
                wrong.append(f"{name}: is no child of its parent")
        for child in thing.get("children", []):
            if objects.get(child, {}).get("parents") != [name]:
                wrong.append(f"{name}: is no parent of its child {child}")
    return wrong


def _vertices(city):
    vertices = city["vertices"]
    wrong = [f"vertex {i} is not three whole numbers" for i, v in enumerate(vertices)
             if len(v) != 3 or not all(type(c) is int for c in v)]
    if len({tuple(v) for v in vertices}) != len(vertices):
        wrong.append("vertices stand twice")
    used = {index for thing in city["CityObjects"].values()
            for geometry in thing.get("geometry", []) for index in _flat(geometry["boundaries"])}
    if used != set(range(len(vertices))):
        wrong.append("vertices are missing or unused")
    extent = city.get("metadata", {}).get("geographicalExtent")
    if extent is not None:
        transform = city["transform"]
        for axis in range(3):
            values = [v[axis] * transform["scale"][axis] + transform["translate"][axis]
                      for v in vertices]
            if abs(min(values) - extent[axis]) > 1e-6 or abs(max(values) - extent[3 + axis]) > 1e-6:
                wrong.append("geographicalExtent is not that of the vertices")
    return wrong


def _flat(boundaries):
    if not isinstance(boundaries, list):
        return [boundaries]
    return [index for part in boundaries for index in _flat(part)]


def _rings(boundaries, depth):
    if depth == 1:
        return boundaries
    return [ring for part in boundaries for ring in _rings(part, depth - 1)]


def _geometry(geometry, vertices):
    kind = geometry.get("type")
    if kind not in DEPTH:
        return [f"geometry of type {kind}"]
    wrong = []
    if not re.fullmatch(r"[0-3](\.[0-3])?", str(geometry.get("lod", 0.5))) or \
            not isinstance(geometry["lod"], str):
        wrong.append("lod is no level of detail")
    boundaries = geometry["boundaries"]
    for ring in _rings(boundaries, DEPTH[kind]):
        if len(ring) < 3 or len(set(ring)) != len(ring):
            wrong.append("a ring has less than three corners, or one twice")
        if not all(type(index) is int and 0 <= index < len(vertices) for index in ring):
            wrong.append("a ring names a vertex that does not exist")
    semantics = geometry.get("semantics")
    if semantics is not None:
        wrong += _semantics(semantics, boundaries, kind)
    if kind == "Solid":
        for shell in boundaries:
            wrong += _shell(shell)
    return wrong


def _semantics(semantics, boundaries, kind):
    wrong = [f"surface of type {surface.get('type')}" for surface in semantics["surfaces"]
             if surface.get("type") not in SURFACES]
    values = semantics["values"]
    shells = zip(values, boundaries) if kind == "Solid" else [(values, boundaries)]
    if kind == "Solid" and len(values) != len(boundaries):
        wrong.append("semantic values are not one list a shell")
    for of_shell, surfaces in shells:
        if len(of_shell) != len(surfaces):
            wrong.append("semantic values are not one a surface")
        if not all(v is None or 0 <= v < len(semantics["surfaces"]) for v in of_shell):
            wrong.append("a semantic value names no surface")
    return wrong


def _shell(shell):
    """A shell is closed where every edge is passed once in each direction."""
    edges = [(ring[i], ring[(i + 1) % len(ring)])
             for surface in shell for ring in surface for i in range(len(ring))]
    if len(set(edges)) != len(edges) or any((b, a) not in set(edges) for a, b in edges):
        return ["the shell is not closed, or its surfaces look either way"]
    return []
