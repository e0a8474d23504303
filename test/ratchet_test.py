#!/usr/bin/python3
"""Holds how much mechanism the source has against test/ratchet.txt, whose figures may only fall.

A line of the table is a room (a folder of source) with these figures:

  constants  named constants that hold numbers, of namespaces and functions
  members    those that are members of classes
  formats    both, where files are laid out, read and written (FORMATS below)
  branches   places that ask of what kind a surface is, a switch being one
  untested   .cc files without a test of their name at the same place below test/

A line "class" is a class with more than MAX_METHODS public methods. A figure above the table fails,
and one below it, too: so the table is lowered in the change that takes something away:

    test/ratchet_test.py --update
"""

import collections
import fnmatch
import io
import pathlib
import subprocess
import sys
import tarfile
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent / "testing"))
# pylint: disable=wrong-import-position
from layers_test import LAYERS, ROOT
from source_count import branches_on, numeric_constants, public_methods

TABLE = "test/ratchet.txt"
FIGURES = ("constants", "members", "formats", "branches", "untested")
SUMS = {"sum of core and factors": ("core", "factors"),
        "sum": ("core", "factors", "simulation", "apps")}
MAX_METHODS = 25
# The enumerations that say of what kind a surface is, and what stands for a comparison with them.
KINDS = ("PlaneModel", "PlaneType")
PREDICATES = ("IsCurved", "IsUpright", "is_curved", "is_vertical", "kIsCurved", "kIsUpright")
# The lengths, codes and limits of files, and the sizes of what is drawn and written into them.
FORMATS = ("core/recording/*", "core/result/cloud_export.*", "core/result/e57_*",
           "core/result/header_padding.*", "core/result/las_writer.*",
           "core/result/little_endian.*", "core/result/pcd_writer.*", "core/result/ply_*",
           "core/result/point_*", "core/result/result_*", "core/result/surface_colour.*",
           "core/judging/check_picture.*", "core/judging/check_text.*", "core/judging/svg_canvas.*",
           "core/outputs/data_section.*", "core/outputs/plan_[!s]*", "core/outputs/plan_svg.*",
           "core/outputs/point_statistics.*", "core/outputs/quantised_points.*",
           "core/outputs/report*", "core/outputs/viewer_bundle.*", "core/map/binary_archive.*",
           "core/util/atomic_file.*", "core/util/checksum.*", "core/util/large_file.*",
           "core/util/partial_files.*", "core/util/xml_text.*", "core/util/yaml_node.*")
NO_FORMATS = ("core/recording/point_cloud.*",)  # judges beams
HEAD = """\
# How much mechanism each room of the source has. No figure may rise, and what has fallen is lowered
# here by test/ratchet_test.py --update. What is counted, and why: docs/developing.md.
"""


def is_format(path):
    def is_one_of(patterns):
        return any(fnmatch.fnmatchcase(path, pattern) for pattern in patterns)

    return is_one_of(FORMATS) and not is_one_of(NO_FORMATS)


def count(root):
    """{room or "class ROOM NAME": {figure: [(file, what was counted)]}}, also of what is none."""
    found = {}
    for path in sorted(path for layer in (*LAYERS, "apps") for path in (root / layer).rglob("*")
                       if path.suffix in (".h", ".cc")):
        file, room = path.relative_to(root).as_posix(), path.parent.relative_to(root).as_posix()
        figures = found.setdefault(room, {figure: [] for figure in FIGURES})
        text = path.read_text(encoding="utf-8")
        constants, members = numeric_constants(text)
        if is_format(file):
            figures["formats"] += [(file, name) for name in constants + members]
        else:
            figures["constants"] += [(file, name) for name in constants]
            figures["members"] += [(file, name) for name in members]
        figures["branches"] += [(file, place) for place in branches_on(text, KINDS, PREDICATES)]
        test = root / "test" / path.parent.relative_to(root) / f"{path.stem}_test"
        if path.suffix == ".cc" and not any(
                test.with_suffix(suffix).is_file() for suffix in (".cc", ".py")):
            figures["untested"].append((file, path.name))
        for name, number in public_methods(text).items():
            if number > MAX_METHODS:
                found[f"class {room} {name}"] = {"methods": [(file, name)] * number}
    return found


def figures_of(found):
    """{line of the table: {figure: number}}, lines of sums included."""
    table = {line: {figure: len(what) for figure, what in figures.items()}
             for line, figures in found.items()}
    for line, layers in SUMS.items():
        table[line] = {figure: sum(figures[figure] for room, figures in table.items()
                                   if room.split("/")[0] in layers) for figure in FIGURES}
    return table


def write_table(table):
    """The text of the table: rooms, sums, classes."""
    width = max(map(len, table)) + 2
    sums = [line for line in SUMS if line in table]
    classes = sorted(line for line in table if line.startswith("class "))
    rooms = sorted(set(table) - set(sums) - set(classes))
    lines = [HEAD + "# " + "room".ljust(width - 2) + "".join(f"{name:>11}" for name in FIGURES)]
    lines += [line.ljust(width) + "".join(f"{table[line][name]:11}" for name in FIGURES)
              for line in rooms + sums]
    lines += [f"# {'public methods':{width - 2}}{'methods':>11}"] * bool(classes)
    lines += [f"{line:{width}}{table[line]['methods']:11}" for line in classes]
    return "\n".join(lines) + "\n"


def read_table(text):
    """The opposite of write_table. ValueError with the line where it can not be read."""
    table = {}
    for number, line in enumerate(text.splitlines(), 1):
        if not line.strip() or line.startswith("#"):
            continue
        names = ("methods",) if line.startswith("class ") else FIGURES
        name, *values = line.rsplit(maxsplit=len(names))
        if len(values) != len(names) or not all(map(str.isdecimal, values)) or name in table:
            raise ValueError(f"{TABLE}:{number}: a name and {len(names)} numbers expected, "
                             "each name once")
        table[name] = dict(zip(names, map(int, values)))
    return table


def compare(table, now):
    """([(line, figure, allowed, number)] above the table, the same below it). What the table does
    not have may have none, a class MAX_METHODS."""
    risen, fallen = [], []
    for line in [*now, *(line for line in table if line not in now)]:
        for figure in now.get(line) or table[line]:
            least = MAX_METHODS if figure == "methods" else 0
            allowed = table.get(line, {}).get(figure, least)
            number = now.get(line, {}).get(figure, least)
            if number != allowed or (line in table) != (line in now) and number == allowed == 0:
                (risen if number > allowed else fallen).append((line, figure, allowed, number))
    return risen, fallen


def count_when_table_was_written(root):
    """What the commit had that changed the table last; None where there is no such history."""
    def git(*arguments):
        return subprocess.run(["git", "-C", root, *arguments], capture_output=True,
                              check=True).stdout

    try:
        commit = git("log", "-1", "--format=%H", "--", TABLE).decode().strip()
        archive = git("archive", commit) if commit else None
    except (OSError, subprocess.CalledProcessError):
        return None
    if archive is None:
        return None
    with tempfile.TemporaryDirectory() as folder, tarfile.open(fileobj=io.BytesIO(archive)) as tar:
        members = [member for member in tar if member.isfile() and
                   member.name.split("/")[0] in (*LAYERS, "apps", "test")]
        tar.extractall(folder, members)
        return count(pathlib.Path(folder))


def added(then, now):
    """["name (file)"] of what is there now and was not then, without what moved between files."""
    then, now = collections.Counter(then), collections.Counter(now)
    gone = collections.Counter(name for _, name in (then - now).elements())
    new = []
    for file, name in (now - then).elements():
        if gone[name] > 0:
            gone[name] -= 1
        else:
            file = pathlib.PurePosixPath(file).name
            new.append(name if name == file else f"{name} ({file})")
    return new


def complaint(root, found):
    """What is above or below the table, as text; empty where nothing is."""
    risen, fallen = compare(read_table((root / TABLE).read_text(encoding="utf-8")),
                            figures_of(found))
    rooms = [entry for entry in risen if entry[0] not in SUMS] or risen
    lines = []
    before = count_when_table_was_written(root) if rooms else None
    for line, figure, allowed, number in rooms:
        new = [] if before is None or line in SUMS or figure == "methods" else added(
            before.get(line, {}).get(figure, []), found[line][figure])
        lines.append(f"{line}: {number} {figure}, where {TABLE} allows {allowed}"
                     + (f"; new: {', '.join(new)}" if new else ""))
    if lines:
        lines.append("A mechanism replaces another, or does not come. What has only moved between "
                     f"rooms is entered in both lines of {TABLE}.")
    elif fallen:
        lines = [f"{line}: {number} {figure}, fewer than the {allowed} of {TABLE}"
                 for line, figure, allowed, number in fallen]
        lines.append("Lower the table in the same change: test/ratchet_test.py --update")
    return "\n".join(lines)


def update(root):
    """Lowers the table to what the source has. Returns why it refuses to, nothing changed then."""
    path = root / TABLE
    found = count(root)
    now = figures_of(found)
    risen, fallen = compare(read_table(path.read_text(encoding="utf-8")), now)
    if risen:
        return complaint(root, found)
    if fallen:
        path.write_text(write_table(now), encoding="utf-8")
    return ""


class Counting(unittest.TestCase):
    """What is counted in a text, and what is not."""

    def constants(self, text):
        return numeric_constants(text)

    def test_constants_of_namespaces_and_functions(self):
        text = """
            constexpr double kGap = 0.3;  // not constexpr double kComment = 1.0;
            inline constexpr int64_t kWait = 1'000'000;
            const double kSine = std::sin(kAngle);
            constexpr auto kTwice = 2 * kGap;
            constexpr double kSteps[] = {1.0, 2.0};
            constexpr std::array<double, 2> kPair = {1.0, 2.0};
            constexpr SolverOptions kOptions = {4, 1e-4};
            constexpr int kBraced{3};
            constexpr int kOne = F(1, 2), kOther = 2;
            constexpr double kOnTwoLines =
                0.5;
            void F() { static constexpr size_t kNum = 4; }
        """
        self.assertEqual(self.constants(text), (
            ["kGap", "kWait", "kSine", "kTwice", "kSteps", "kPair", "kOptions", "kBraced", "kOne",
             "kOther", "kOnTwoLines", "kNum"], []))

    def test_constants_of_classes_are_members(self):
        text = """
            constexpr int kOutside = 1;
            class A final : public B<int> {
             public:
              static constexpr int kSize = 3;
              int F() const { constexpr int kInside = 2; return kInside; }
              struct C { static constexpr double kDeep = 0.1; };
            };
            enum class E { kFirst = 1 };
            constexpr int kAfter = 1;
        """
        self.assertEqual(self.constants(text), (["kOutside", "kInside", "kAfter"],
                                                ["kSize", "kDeep"]))

    def test_what_is_no_constant_of_numbers(self):
        text = r"""
            constexpr char kName[] = "constexpr int kInText = 1;";
            const std::string kWord = "1";
            constexpr const char* kWords[] = {"a", "b"};
            constexpr Known kKnown[] = {{"a", 1}};
            constexpr char kLetter = '1';
            constexpr bool kIsOn = kSize > 3;
            constexpr MotionKind kOrder[] = {kTilt, kYaw};
            const auto kFunction = [](int a) { return a + 1; };
            /* constexpr int kOld = 1; */
            const char kRaw[] = R"(constexpr int kRawText = 1;)";
            #define A constexpr int kMacro = 1;
            double kMutable = 1.0;
            double F(const double kArgument, const double& value);
            bool b = kGap == 1;
            extern const int kElsewhere;
        """
        self.assertEqual(self.constants(text), ([], []))

    def test_branches_on_kinds(self):
        text = """
            if (plane.model == PlaneModel::kVertical || PlaneType::kGeneral != type) F();
            if (a->IsCurved() && view.is_curved) F();
            switch (model) {
              case PlaneModel::kVertical: return 1;
              case PlaneModel::kGeneral: return 2;
            }
        """
        self.assertEqual(branches_on(text, KINDS, PREDICATES), [
            "== PlaneModel::kVertical", "PlaneType::kGeneral !=", "IsCurved", "is_curved",
            "case PlaneModel::kVertical"])

    def test_what_is_no_branch(self):
        text = """
            // model == PlaneModel::kVertical
            PlaneModel model = PlaneModel::kVertical;
            bool IsCurved() const;
            static constexpr bool kIsCurved = false;
            A::A(double x) : is_vertical(x > 1.0), is_curved(false) { view.is_curved = true; }
            bool IsCurvedWell(double x) { return x == Other::kVertical; }
            switch (sign) { case Sign::kPlus: return MakeOf(PlaneModel::kVertical); }
        """
        self.assertEqual(branches_on(text, KINDS, PREDICATES), [])

    def test_public_methods(self):
        text = """
            class A : public B {
              int Hidden() const;
             public:
              using Values = std::vector<int>;
              explicit A(int a) : a_{a}, b_(2) {}
              A(const A&) = delete;
              A& operator=(const A&) = delete;
              ~A();
              bool operator==(const A& other) const;
              int First() const { if (a_ > 1) { return 1; } return 2; }
              template <typename T>
              void Second(T (*f)(int), const std::vector<T>& x = {}) const;
              void Second(int x);
              [[noreturn]] static auto Fail() -> void;
              virtual std::function<void(int)> Pure() = 0;
              std::function<void(int)> field;
              double value = F(3);
              alignas(16) double aligned[4] = {};
              struct Inner { int Own() const; int x = 0; };
             protected:
              void NotThis();
             private:
              void NorThis();
            };
            struct C { int Get() const; enum class D { kX }; };
            enum class E { kA };
        """
        self.assertEqual(public_methods(text), {"A": 6, "Inner": 1, "C": 1})


class Ratchet(unittest.TestCase):
    """The table against a small source of its own."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        self.write("core/map/wall.cc", "constexpr int kOne = 1;\nconstexpr int kTwo = 2;\n")
        self.write("core/recording/bag.cc", "constexpr int kHeadBytes = 1;\n")
        self.write("test/core/recording/bag_test.cc", "")
        self.write("apps/main.cc", "bool b = type == PlaneType::kGeneral;\n")
        self.write(TABLE, write_table(figures_of(count(self.root))))

    def write(self, name, text):
        path = self.root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")

    def read(self):
        return read_table((self.root / TABLE).read_text(encoding="utf-8"))

    def complaint(self):
        return complaint(self.root, count(self.root))

    def git(self, *arguments):
        subprocess.run(["git", "-C", self.root, "-c", "user.name=a", "-c", "user.email=a@b",
                        *arguments], check=True, capture_output=True)

    def test_the_table_is_what_was_counted(self):
        self.assertEqual(self.complaint(), "")
        table = self.read()
        self.assertEqual(list(table["core/map"].values()), [2, 0, 0, 0, 1])
        self.assertEqual(list(table["core/recording"].values()), [0, 0, 1, 0, 0])
        self.assertEqual(list(table["sum of core and factors"].values()), [2, 0, 1, 0, 1])
        self.assertEqual(list(table["sum"].values()), [2, 0, 1, 1, 2])

    def test_what_rises_is_told_and_not_taken_up(self):
        self.write("core/map/wall.h", "constexpr int kThree = 3;\n")
        before = self.read()
        self.assertIn("core/map: 3 constants, where test/ratchet.txt allows 2", self.complaint())
        self.assertNotIn("sum", self.complaint())
        self.assertIn("core/map: 3 constants", update(self.root))
        self.assertEqual(self.read(), before)

    def test_one_rise_holds_back_what_fell_elsewhere(self):
        self.write("core/recording/bag.cc", "")
        self.write("core/map/wall.h", "constexpr int kThree = 3;\n")
        before = self.read()
        self.assertIn("core/map: 3 constants", update(self.root))
        self.assertEqual(self.read(), before)

    def test_what_falls_has_to_be_entered(self):
        self.write("core/map/wall.cc", "constexpr int kOne = 1;\n")
        self.assertIn("core/map: 1 constants, fewer than the 2", self.complaint())
        self.assertIn("ratchet_test.py --update", self.complaint())
        self.assertEqual(update(self.root), "")
        self.assertEqual(self.complaint(), "")
        self.assertEqual(self.read()["sum"]["constants"], 1)
        self.write("core/map/wall.cc", "constexpr int kOne = 1;\nconstexpr int kTwo = 2;\n")
        self.assertIn("core/map: 2 constants, where test/ratchet.txt allows 1", self.complaint())

    def test_a_room_that_goes_leaves_the_table(self):
        (self.root / "core/recording/bag.cc").unlink()
        self.assertIn("core/recording: 0 formats, fewer than the 1", self.complaint())
        self.assertEqual(update(self.root), "")
        self.assertNotIn("core/recording", self.read())
        self.assertEqual(self.complaint(), "")

    def test_a_source_file_needs_a_test(self):
        (self.root / "test/core/recording/bag_test.cc").unlink()
        self.assertIn("core/recording: 1 untested, where", self.complaint())

    def test_a_class_of_many_methods(self):
        self.write("core/map/a.h", "struct A {\n" + "".join(
            f"  int F{i}() const;\n" for i in range(MAX_METHODS)) + "};\n")
        self.assertEqual(self.complaint(), "")
        self.write("core/map/a.h", "struct A {\n" + "".join(
            f"  int F{i}() const;\n" for i in range(MAX_METHODS + 1)) + "};\n")
        self.assertIn("class core/map A: 26 methods, where test/ratchet.txt allows 25",
                      self.complaint())
        self.write(TABLE, write_table(figures_of(count(self.root))))
        self.assertEqual(self.complaint(), "")
        self.write("core/map/a.h", "struct A {};\n")
        self.assertIn("class core/map A: 25 methods, fewer than the 26", self.complaint())
        self.assertEqual(update(self.root), "")
        self.assertNotIn("class core/map A", self.read())

    def test_a_raised_room_does_not_raise_the_sum(self):
        self.write("core/map/wall.h", "constexpr int kThree = 3;\n")
        table = self.read()
        table["core/map"]["constants"] = 3
        self.write(TABLE, write_table(table))
        self.assertIn("sum: 3 constants, where test/ratchet.txt allows 2", update(self.root))

    def test_the_history_names_what_was_added(self):
        try:
            self.git("init", "-q")
        except OSError:
            self.skipTest("no git")
        self.git("add", ".")
        self.git("commit", "-qm", "a")
        self.write("core/map/wall.cc", "constexpr int kOne = 1;\nconstexpr int kNew = 2;\n")
        self.write("core/map/wall.h", "constexpr int kTwo = 3;\n")
        self.assertIn("3 constants, where test/ratchet.txt allows 2; new: kNew (wall.cc)\n",
                      self.complaint())

    def test_a_table_that_can_not_be_read(self):
        for line in ("core/map 1 2 3", "core/map 1 2 3 4 x", "a 1 2 3 4 5\na 1 2 3 4 5"):
            self.write(TABLE, line + "\n")
            with self.assertRaisesRegex(ValueError, r"test/ratchet\.txt:[12]: "):
                self.complaint()

    def test_patterns_of_formats_name_files(self):
        files = [path.relative_to(ROOT).as_posix() for layer in LAYERS
                 for path in (ROOT / layer).rglob("*") if path.suffix in (".h", ".cc")]
        self.assertEqual([pattern for pattern in FORMATS + NO_FORMATS
                          if not fnmatch.filter(files, pattern)], [])

    def test_the_source_is_as_the_table_says(self):
        if message := complaint(ROOT, count(ROOT)):
            self.fail("\n" + message)


def main():
    if "--update" not in sys.argv[1:]:
        unittest.main()
    try:
        refused = update(ROOT)
    except (OSError, ValueError) as error:
        sys.exit(str(error))
    if refused:
        sys.exit(f"{refused}\nNothing was changed.")


if __name__ == "__main__":
    main()
