#!/usr/bin/python3
"""Installs the build below a temporary prefix and uses it as others do: programs, pages, completion,
and projects of their own that link the libraries. Argument: the build directory."""

import email.utils
import gzip
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

import yaml

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = None
PROGRAMS = sorted(path.stem for path in (ROOT / "apps").glob("plumbline_*.cc"))
# Prints what bash offers for the word that the cursor is in: arguments are the completion's file,
# and the words. The words are split as bash splits them, at "=".
COMPLETE = """
source "$1"; shift
COMP_WORDS=()
for word; do
  if [[ $word == -*=* ]]; then
    COMP_WORDS+=("${word%%=*}" "=")
    [[ -n ${word#*=} ]] && COMP_WORDS+=("${word#*=}")
  else
    COMP_WORDS+=("$word")
  fi
done
COMP_CWORD=$(( ${#COMP_WORDS[@]} - 1 ))
compopt() { :; }  # works in a completion that readline has asked for only
"_${COMP_WORDS[0]}"
printf '%s\\n' "${COMPREPLY[@]}"
"""


def run(*command, **options):
    result = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True,
                            check=False, **options)
    assert result.returncode == 0, f"{command}: {result.stdout}{result.stderr}"
    return result.stdout


class InstallTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        directory = tempfile.TemporaryDirectory()
        cls.addClassCleanup(directory.cleanup)
        cls.directory = pathlib.Path(directory.name)
        cls.prefix = cls.directory / "prefix"
        run("cmake", "--install", BUILD, "--prefix", cls.prefix)
        cls.data = cls.prefix / "share/plumbline"
        cls.room = cls.directory / "room"
        run(cls.program("plumbline_simulate"), f"--output={cls.room}",
            f"--experiment={cls.data}/configs/experiments/room.yaml")

    @classmethod
    def program(cls, name):
        return cls.prefix / "bin" / name

    def build(self, source, target):
        build = self.directory / target
        run("cmake", "-S", source, "-B", build, "-G", "Ninja", f"-DCMAKE_PREFIX_PATH={self.prefix}",
            "-DCMAKE_BUILD_TYPE=Debug", "-DCMAKE_CXX_FLAGS=-O0 -g0")
        run("cmake", "--build", build)
        return build / target

    def test_nothing_is_compiled_for_one_kind_of_processor(self):
        commands = json.loads((BUILD / "compile_commands.json").read_text())
        self.assertTrue(commands)
        for command in commands:
            self.assertNotRegex(command["command"], r" -m(arch|tune|cpu|avx|sse|fma|bmi)")

    def test_debian_packages(self):
        if not (shutil.which("dpkg-shlibdeps") and shutil.which("file")):
            self.skipTest("no dpkg-shlibdeps or no file")
        packages = self.directory / "packages"
        run("cpack", "-G", "DEB", "-B", packages, "-D", "CPACK_DEBIAN_COMPRESSION_TYPE=gzip",
            cwd=BUILD)
        programs, libraries = sorted(packages.glob("*.deb"), reverse=True)
        self.assertRegex(programs.name, r"^plumbline_\d+\.\d+\.\d+_amd64\.deb$")
        self.assertRegex(libraries.name, r"^libplumbline-dev_\d+\.\d+\.\d+_amd64\.deb$")
        depends = run("dpkg-deb", "-f", programs, "Depends")
        for library in ("libc6 (", "libjemalloc2", "libgflags", "libtbb"):
            self.assertIn(library, depends)
        self.assertNotIn("-dev", depends)
        description = run("dpkg-deb", "-f", programs, "Description")
        for name in PROGRAMS:
            self.assertIn(name, description)
        self.assertLess(programs.stat().st_size, 20e6)
        self.check_content(programs, "plumbline")
        self.check_content(libraries, "libplumbline-dev")

    def check_content(self, package, name):
        """Holds a package's files against the installed ones."""
        listed = run("dpkg-deb", "--contents", package)
        self.assertIn(f"./usr/share/doc/{name}/copyright", listed)
        files = {pathlib.PurePosixPath(line.split()[-1]).relative_to("usr")
                 for line in listed.splitlines() if not line.endswith("/")}
        installed = {path.relative_to(self.prefix) for path in self.prefix.rglob("*")
                     if path.is_file()}
        self.assertEqual(files - installed, set())
        wanted = "bin" if name == "plumbline" else "lib"
        self.assertEqual({path for path in installed if path.parts[0] == wanted},
                         {path for path in files if path.parts[0] == wanted})

    def test_all_programs_are_there_and_say_their_version(self):
        self.assertEqual(sorted(path.name for path in (self.prefix / "bin").iterdir()), PROGRAMS)
        for name in PROGRAMS:
            self.assertRegex(run(self.program(name), "--version"),
                             rf"^{name} \d+\.\d+\.\d+( \(commit [0-9a-f]+\+?\))?\n$")

    def test_version_and_day_of_the_release_are_the_same_everywhere(self):
        version = run(self.program("plumbline_map"), "--version").split()[1]
        citation = yaml.safe_load((self.data / "CITATION.cff").read_text())
        self.assertEqual(citation["version"], version)
        newest = re.search(r"(?m)^## (\S+) \((\S+)\)$", (self.data / "CHANGELOG.md").read_text())
        self.assertEqual(newest[1], version)
        debian = gzip.decompress((self.prefix / "share/doc/plumbline/changelog.gz").read_bytes()).decode()
        self.assertTrue(debian.startswith(f"plumbline ({version}) "))
        day = email.utils.parsedate_to_datetime(re.search(r"(?m)^ -- .*>  (.*)$", debian)[1])
        self.assertEqual(newest[2], day.date().isoformat())

    def test_licence_and_pages_lie_beside_the_settings_as_their_links_say(self):
        for name in ("LICENSE", "CHANGELOG.md", "CITATION.cff", "docs/terms.md",
                     "configs/rigs/paper.yaml", "configs/buildings/README.md"):
            self.assertEqual((self.data / name).read_bytes(), (ROOT / name).read_bytes())

    def test_commands_of_the_pages_are_those_of_an_installation(self):
        pages = [self.data / "README.md", *sorted((self.data / "docs").glob("*.md"))]
        for page in pages:
            text = page.read_text()
            self.assertNotIn("build/bin/", text, page)
            for file in re.findall(rf"{self.data}/configs/[\w./]+\.yaml", text):
                self.assertTrue(pathlib.Path(file).is_file(), f"{page}: {file}")
        self.assertIn(f"plumbline_simulate --experiment={self.data}/configs/experiments/room.yaml",
                      (self.data / "docs" / "guide.md").read_text())

    def test_bound_addresses_can_not_be_written(self):
        if not shutil.which("readelf"):
            self.skipTest("no readelf")
        for name in PROGRAMS:
            dynamic = run("readelf", "--dynamic", "--wide", self.program(name))
            self.assertRegex(dynamic, r"\(FLAGS_1\).*NOW.*PIE", name)
            self.assertIn("GNU_RELRO", run("readelf", "--program-headers", self.program(name)))

    def test_man_pages_name_every_flag_and_have_no_faults(self):
        for name in PROGRAMS:
            packed = self.prefix / f"share/man/man1/{name}.1.gz"
            text = gzip.decompress(packed.read_bytes()).decode()
            flags = re.findall(r"(?m)^  --(\w+)", run(self.program(name), "--help"))
            self.assertTrue(flags)
            for flag in flags:
                self.assertIn(rf"\fB\-\-{flag}\fR", text)
            if shutil.which("man"):
                result = subprocess.run(["man", "--warnings", "-E", "UTF-8", "-l", packed],
                                        capture_output=True, text=True, check=True,
                                        env={**os.environ, "MANWIDTH": "80", "LC_ALL": "C.UTF-8"})
                self.assertEqual(result.stderr, "")
                self.assertIn(name, result.stdout)

    def complete(self, *words, directory=ROOT):
        completion = self.prefix / "share/bash-completion/completions" / words[0]
        text = run("bash", "--norc", "-c", COMPLETE, "bash", completion, *words, cwd=directory)
        return sorted(text.split("\n")[:-1]) if text != "\n" else []

    def test_completion_offers_flags(self):
        for name in PROGRAMS:
            flags = re.findall(r"(?m)^  (--\w+)", run(self.program(name), "--help"))
            offered = [word.rstrip("=") for word in self.complete(name, "--")]
            self.assertEqual(offered, sorted(flags + ["--help", "--version"]))
        self.assertEqual(self.complete("plumbline_map", "--rec"), ["--recording="])
        self.assertEqual(self.complete("plumbline_map", "--rig=a", "--res"), ["--resume"])
        self.assertEqual(self.complete("plumbline_map", "--no_such"), [])

    def test_completion_offers_files_and_directories(self):
        (self.directory / "my bag.bag").write_text("")
        offered = self.complete("plumbline_map", "--recording=my", directory=self.directory)
        self.assertEqual(offered, ["my bag.bag"])
        for words in (("--rig=configs/r",), ("--rig", "configs/r"), ("-rig=configs/r",)):
            self.assertEqual(self.complete("plumbline_map", *words), ["configs/rigs"])
        self.assertIn("README.md", self.complete("plumbline_map", "--rig="))
        self.assertIn("docs", self.complete("plumbline_map", "--output="))
        self.assertNotIn("README.md", self.complete("plumbline_map", "--output="))
        self.assertEqual(self.complete("plumbline_map", "--threads="), [])

    def test_a_project_of_its_own_maps_with_the_libraries(self):
        program = self.build(self.data / "docs/example", "list_surfaces")
        rig = self.room / "rig.yaml"
        listed = run(program, self.room / "recording.bag", rig, self.directory / "linked")
        run(self.program("plumbline_map"), f"--recording={self.room}/recording.bag", f"--rig={rig}",
            f"--output={self.directory}/mapped")
        planes = (self.directory / "mapped/planes.json").read_bytes()
        self.assertEqual((self.directory / "linked/planes.json").read_bytes(), planes)
        expected = [f"{plane['distance']:.4f}" for plane in json.loads(planes)]
        self.assertEqual(re.findall(r"distance +(-?[\d.]+) m \+-", listed), expected)
        self.assertIn("the map is consistent\n", listed)

    def test_the_simulator_is_a_component_of_the_package(self):
        program = self.build(ROOT / "test/packaging/simulator_user", "simulator_user")
        output = self.directory / "simulated"
        self.assertEqual(run(program, self.data / "configs/experiments/room.yaml", output),
                         run(self.program("plumbline_simulate"), f"--output={output}",
                             f"--experiment={self.data}/configs/experiments/room.yaml"))

    def test_a_component_that_is_none_is_refused(self):
        source = self.directory / "wrong"
        source.mkdir()
        (source / "CMakeLists.txt").write_text(
            "cmake_minimum_required(VERSION 3.22)\nproject(wrong C CXX)\n"
            "find_package(plumbline REQUIRED COMPONENTS no_such)\n")
        result = subprocess.run(["cmake", "-S", source, "-B", source / "build", "-G", "Ninja",
                                 f"-DCMAKE_PREFIX_PATH={self.prefix}"],
                                capture_output=True, text=True, check=False)
        self.assertNotEqual(result.returncode, 0)
        self.assertIn("no_such", result.stderr)


if __name__ == "__main__":
    BUILD = pathlib.Path(sys.argv.pop(1)).resolve()
    unittest.main()
