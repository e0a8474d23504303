#!/usr/bin/python3
"""Holds every include of the source against the folders that its own folder links in CMake.

A folder may include itself, what it links, and what these link publicly. Headers may include only
what is linked PUBLIC. Links are the arrows of docs/architecture.md: they must not form a circle.
"""

import pathlib
import re
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[1]
LAYERS = ("factors", "core", "simulation")
CALL = re.compile(r"plumbline_add_library\((\w+)\s(.*?)\)", re.DOTALL)
TYPE = re.compile(r"^(?:struct|class|enum class) (\w+)[^;\n]*\{$", re.MULTILINE)
INCLUDE = re.compile(r'^#include "([^"]+)"', re.MULTILINE)


def read_links(root):
    """{folder: (public folders, private folders)} as the CMakeLists.txt files say."""
    folders = {}
    for layer in LAYERS:
        for path in sorted((root / layer).glob("*/CMakeLists.txt")):
            folders["plumbline_" + "_".join(path.parent.relative_to(root).parts)] = path.parent
    links = {}
    for name, folder in folders.items():
        calls = CALL.findall((folder / "CMakeLists.txt").read_text(encoding="utf-8"))
        assert [call[0] for call in calls] == [name], f"{folder}: one library {name} expected"
        groups = {"PUBLIC": set(), "PRIVATE": set(), "SOURCES": set()}
        group = None
        for word in calls[0][1].split():
            if word in groups:
                group = word
            elif word in folders:
                groups[group].add(folders[word].relative_to(root).as_posix())
        links[folder.relative_to(root).as_posix()] = (groups["PUBLIC"], groups["PRIVATE"])
    return links


def reachable(links, start):
    """What may be included by someone who links the folders of start."""
    found, waiting = set(), list(start)
    while waiting:
        folder = waiting.pop()
        if folder not in found:
            found.add(folder)
            waiting += links[folder][0]
    return found


def wrong_includes(root, links):
    """["file includes header", ...] that no link allows."""
    wrong = []
    for folder, (public, private) in links.items():
        of_headers = reachable(links, public) | {folder}
        of_sources = reachable(links, public | private) | {folder}
        for path in sorted((root / folder).iterdir()):
            if path.suffix not in (".h", ".cc"):
                continue
            allowed = of_headers if path.suffix == ".h" else of_sources
            for header in INCLUDE.findall(path.read_text(encoding="utf-8")):
                if pathlib.PurePosixPath(header).parent.as_posix() not in allowed:
                    wrong.append(f"{path.relative_to(root)} includes {header}")
    return wrong


def doubled_types(texts):
    """Names of types that several headers define in our one namespace: whoever links both gets
    the functions of one of them for both."""
    names = [name for text in texts for name in TYPE.findall(text)]
    return sorted({name for name in names if names.count(name) > 1})


def circles(links):
    """Folders that reach themselves by links of either kind."""
    return [folder for folder in links
            if folder in reachable({key: (a | b, ()) for key, (a, b) in links.items()},
                                   links[folder][0] | links[folder][1])]


class Layers(unittest.TestCase):
    def setUp(self):
        self.links = read_links(ROOT)

    def test_no_include_runs_upwards(self):
        self.assertEqual(wrong_includes(ROOT, self.links), [])

    def test_links_form_no_circle(self):
        self.assertEqual(circles(self.links), [])

    def test_all_source_lies_in_a_folder_with_a_library(self):
        loose = [path.as_posix() for layer in LAYERS for path in (ROOT / layer).rglob("*")
                 if path.suffix in (".h", ".cc")
                 and path.parent.relative_to(ROOT).as_posix() not in self.links]
        self.assertEqual(loose, [])

    def test_simulation_shares_no_model_with_what_it_judges(self):
        for folder in ("simulation/world", "simulation/sensing", "simulation/evaluation"):
            shared = {room for room in reachable({key: (a | b, ()) for key, (a, b)
                                                  in self.links.items()}, [folder])
                      if room in ("core/trajectory", "core/map", "core/estimation")
                      or room.startswith("factors/")}
            self.assertEqual(shared, set(), folder)

    def test_no_two_types_have_one_name(self):
        texts = [path.read_text(encoding="utf-8") for layer in LAYERS + ("apps",)
                 for path in sorted((ROOT / layer).rglob("*.h"))]
        self.assertEqual(doubled_types(texts), [])
        self.assertEqual(doubled_types(["struct A {\n", "class A : public B {\n", "struct A;\n",
                                        "struct C {\n"]), ["A"])

    def test_an_include_upwards_is_found(self):
        links = dict(self.links)
        links["core/sensor"] = (set(), set())
        self.assertIn("core/sensor/rig.h includes core/geometry/rigid3.h",
                      wrong_includes(ROOT, links))

    def test_a_circle_is_found(self):
        links = dict(self.links)
        links["core/util"] = ({"core/mapping"}, set())
        self.assertIn("core/util", circles(links))


if __name__ == "__main__":
    unittest.main()
