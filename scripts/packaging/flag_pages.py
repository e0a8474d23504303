#!/usr/bin/python3
"""Makes the man page and the completion for bash of a program of plumbline from its own flags.

    flag_pages.py PROGRAM [--man=PAGE.1.gz] [--completion=FILE]

Asks the program for its flags with --helpxml. The man page's date is that of the newest commit, or
of SOURCE_DATE_EPOCH, so that the same source gives the same bytes.
"""

import argparse
import datetime
import gzip
import os
import pathlib
import re
import subprocess
import sys
import xml.etree.ElementTree

ROOT = pathlib.Path(__file__).resolve().parents[2]
# The meaning of a flag whose value is a file has one of these.
FILE_WORDS = re.compile(r"\b(file|bag|recording|YAML|JSON)\b")
EXIT_CODES = (
    ("0", "The work is done."),
    ("1", "The input is bad or the estimation failed. One line on stderr says why; no file is left "
          "half written."),
    ("2", "The flags are wrong."))
# What the exit code 3 of a program says, where it has one.
EXIT_CODE_3 = {
    "plumbline_map": "A map was written that contradicts the scans it was made from. Do not trust "
                     "it.",
    "plumbline_check": "The recording can not be mapped as it is.",
}

COMPLETION = '''# bash completion of {program}, made from its flags.

_{program}() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} flag=
  # bash splits --flag=value at the sign.
  if [[ $current == "=" ]]; then
    current= flag=${{COMP_WORDS[COMP_CWORD-1]}}
  elif [[ ${{COMP_WORDS[COMP_CWORD-1]}} == "=" ]]; then
    flag=${{COMP_WORDS[COMP_CWORD-2]}}
  else
    flag=${{COMP_WORDS[COMP_CWORD-1]}}
  fi
  COMPREPLY=()
  case ${{flag/#--/-}} in
    {directories})
      compopt -o filenames
      mapfile -t COMPREPLY < <(compgen -d -- "$current")
      return ;;
    {files})
      compopt -o filenames
      mapfile -t COMPREPLY < <(compgen -f -- "$current")
      return ;;
    {others})
      return ;;
  esac
{alone}  mapfile -t COMPREPLY < <(compgen -W "{words}" -- "$current")
  [[ ${{#COMPREPLY[@]}} -eq 1 && ${{COMPREPLY[0]}} == *= ]] && compopt -o nospace
}}
complete -F _{program} {program}
'''


# The value of a flag whose meaning says so may stand without it.
ALONE = "without the flag"
COMPLETION_OF_ALONE = '''  if [[ $current != -* ]]; then
    compopt -o filenames
    mapfile -t COMPREPLY < <(compgen {kind} -- "$current")
    return
  fi
'''


class Flag:
    """A flag as --helpxml describes it."""

    def __init__(self, element):
        self.name = element.findtext("name")
        self.meaning = element.findtext("meaning")
        self.default = element.findtext("default")
        self.type = element.findtext("type")
        self.is_required = element.find("required") is not None

    @property
    def kind(self):
        """What its value is: directory, file, bool, text or number."""
        if self.type != "string":
            return "bool" if self.type == "bool" else "number"
        if self.meaning.startswith("directory"):
            return "directory"
        return "file" if FILE_WORDS.search(self.meaning) else "text"

    @property
    def value(self):
        """What stands for its value in the man page."""
        return "" if self.kind == "bool" else self.kind.upper()


class Program:
    """What a program says of itself."""

    def __init__(self, help_xml):
        root = xml.etree.ElementTree.fromstring(help_xml)
        self.name = root.findtext("program")
        self.version = root.findtext("version")
        self.purpose = root.findtext("usage")
        self.flags = [Flag(element) for element in root.iter("flag")]


def roff(text):
    """Text as troff shows it."""
    text = text.replace("\\", "\\e").replace("-", "\\-")
    return "\\&" + text if text.startswith((".", "'")) else text


def option(flag):
    if not flag.value:
        return f"\\fB{roff('--' + flag.name)}\\fR"
    return f"\\fB{roff('--' + flag.name)}\\fR=\\fI{flag.value}\\fR"


def man_page(program, date, others):
    """The page in troff; others: the names of the programs to see as well."""
    lines = [f'.TH {program.name.upper()} 1 "{date}" "plumbline {program.version}" "User Commands"',
             ".SH NAME", f"{program.name} \\- {roff(program.purpose)}", ".SH SYNOPSIS",
             f".B {program.name}"]
    lines += [option(flag) for flag in program.flags if flag.is_required]
    lines += ["[\\fIother flags\\fR]", ".SH DESCRIPTION",
              f"{roff(program.name)} {roff(program.purpose)}.", ".PP",
              "A value follows its flag after the sign \\(lq=\\(rq or a space.", ".SH OPTIONS"]
    for flag in program.flags:
        lines += [".TP", option(flag), roff(flag.meaning[:1].upper() + flag.meaning[1:] + ".")]
        if flag.is_required:
            lines.append("Has to be given.")
        elif flag.default:
            lines.append(f"Default: {roff(flag.default)}.")
    for name, meaning in (("help", "Prints the flags."),
                          ("version", "Prints the version, and the commit that was built.")):
        lines += [".TP", f"\\fB{roff('--' + name)}\\fR", meaning]
    lines.append(".SH EXIT STATUS")
    codes = EXIT_CODES
    if program.name in EXIT_CODE_3:
        codes += (("3", EXIT_CODE_3[program.name]),)
    for code, meaning in codes:
        lines += [".TP", f".B {code}", roff(meaning)]
    lines += [".SH ENVIRONMENT", ".TP", ".B NO_COLOR",
              "If it is set to anything but nothing, there are no colours on a terminal.",
              ".SH FILES", ".TP", ".I share/plumbline/docs",
              "Pages that describe every file that is read and written (inputs.md, outputs.md).",
              ".TP", ".I share/plumbline/configs", "Rigs, buildings, experiments and settings.",
              ".SH SEE ALSO", ",\n".join(f".BR {name} (1)" for name in others)]
    return "\n".join(lines) + "\n"


def completion(program):
    def names(kinds):
        # None may match: a program may have no flag of a kind.
        return "|".join([f"-{flag.name}" for flag in program.flags if flag.kind in kinds]) or "-"

    alone = "".join(COMPLETION_OF_ALONE.format(kind="-d" if flag.kind == "directory" else "-f")
                    for flag in program.flags if ALONE in flag.meaning)
    words = [f"--{flag.name}" + ("" if flag.kind == "bool" else "=") for flag in program.flags]
    return COMPLETION.format(program=program.name, directories=names({"directory"}),
                             files=names({"file"}), others=names({"text", "number"}), alone=alone,
                             words=" ".join(words + ["--help", "--version"]))


def source_date():
    """The date of the source in ISO form; today's where nothing tells."""
    epoch = os.environ.get("SOURCE_DATE_EPOCH")
    if epoch is None and (ROOT / ".git").exists():
        try:
            epoch = subprocess.run(["git", "-C", ROOT, "log", "-1", "--format=%ct"], check=True,
                                   capture_output=True, text=True).stdout.strip()
        except (OSError, subprocess.CalledProcessError):
            pass
    if not epoch:
        return datetime.date.today().isoformat()
    return datetime.datetime.fromtimestamp(int(epoch), datetime.timezone.utc).date().isoformat()


def write(path, data):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(data)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--man", type=pathlib.Path, help="gzipped man page to write")
    parser.add_argument("--completion", type=pathlib.Path, help="completion for bash to write")
    arguments = parser.parse_args()
    result = subprocess.run([arguments.program.resolve(), "--helpxml"], capture_output=True,
                            text=True, check=False)
    if result.returncode != 0:
        sys.exit(f"{arguments.program} --helpxml failed: {result.stderr.strip()}")
    program = Program(result.stdout)
    if arguments.man:
        others = sorted(path.name for path in (ROOT / "apps").glob("plumbline_*.cc"))
        others = [name[:-len(".cc")] for name in others if name[:-len(".cc")] != program.name]
        write(arguments.man, gzip.compress(man_page(program, source_date(), others).encode(), 9,
                                           mtime=0))
    if arguments.completion:
        write(arguments.completion, completion(program).encode())


if __name__ == "__main__":
    main()
