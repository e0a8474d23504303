#!/usr/bin/python3
"""Tests scripts/packaging/flag_pages.py on a program made here."""

import gzip
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[3] / "scripts/packaging/flag_pages.py"
HELP = """<?xml version="1.0"?>
<AllFlags>
<program>some_app</program><version>1.2.3</version><usage>does - or not - something</usage>
<flag><name>input</name><meaning>'bag' &lt; 2 GB</meaning><default></default><type>string</type>\
<required/></flag>
<flag><name>output</name><meaning>directory for it</meaning><default></default><type>string</type></flag>
<flag><name>title</name><meaning>.dots and \\ matter</meaning><default>a-b</default><type>string</type></flag>
<flag><name>fast</name><meaning>hurry</meaning><default>false</default><type>bool</type></flag>
<flag><name>count</name><meaning>a number</meaning><default>3</default><type>int32</type></flag>
</AllFlags>
"""


class FlagPagesTest(unittest.TestCase):
    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.directory = pathlib.Path(directory.name)
        self.man = self.directory / "man/some_app.1.gz"
        self.completion = self.directory / "completion/some_app"

    def make(self, program="cat << 'END'\n" + HELP + "END\n"):
        path = self.directory / "some_app"
        path.write_text(f"#!/bin/bash\n[[ $1 == --helpxml ]] || exit 9\n{program}")
        path.chmod(0o755)
        return subprocess.run([SCRIPT, path, f"--man={self.man}", f"--completion={self.completion}"],
                              capture_output=True, text=True, check=False,
                              env={**os.environ, "SOURCE_DATE_EPOCH": "86400"})

    def test_the_page_shows_what_the_program_says(self):
        self.assertEqual(self.make().returncode, 0)
        text = gzip.decompress(self.man.read_bytes()).decode()
        self.assertIn('.TH SOME_APP 1 "1970-01-02" "plumbline 1.2.3"', text)
        if not shutil.which("man"):
            self.skipTest("no man")
        page = subprocess.run(["man", "--warnings", "-E", "UTF-8", "-l", self.man], capture_output=True,
                              text=True, check=True,
                              env={**os.environ, "MANWIDTH": "100", "LC_ALL": "C.UTF-8"})
        self.assertEqual(page.stderr, "")
        shown = " ".join(page.stdout.split())
        self.assertIn("some_app - does - or not - something SYNOPSIS some_app --input=FILE [other flags]",
                      shown)
        for words in ("--input=FILE 'bag' < 2 GB. Has to be given.",
                      "--output=DIRECTORY Directory for it.",
                      "--title=TEXT .dots and \\ matter. Default: a-b.",
                      "--fast Hurry. Default: false.", "--count=NUMBER A number. Default: 3."):
            self.assertIn(words, shown)

    def test_the_completion_is_sound_for_bash(self):
        self.assertEqual(self.make().returncode, 0)
        subprocess.run(["bash", "-n", self.completion], check=True)
        self.assertIn("--input= --output= --title= --fast --count= --help --version",
                      self.completion.read_text())

    def test_what_may_stand_without_its_flag_is_completed(self):
        self.make()
        without = self.completion.read_text()
        self.make("cat << 'END'\n" + HELP.replace("directory for it", "directory, also without the flag") +
                  "END\n")
        subprocess.run(["bash", "-n", self.completion], check=True)
        self.assertNotIn('if [[ $current != -* ]]', without)
        self.assertIn('if [[ $current != -* ]]; then\n    compopt -o filenames\n    '
                      'mapfile -t COMPREPLY < <(compgen -d', self.completion.read_text())

    def test_the_same_flags_give_the_same_bytes(self):
        self.make()
        first = self.man.read_bytes()
        self.make()
        self.assertEqual(self.man.read_bytes(), first)

    def test_a_program_that_fails_leaves_nothing(self):
        result = self.make("echo broken >&2; exit 1\n")
        self.assertEqual(result.returncode, 1)
        self.assertIn("--helpxml failed: broken", result.stderr)
        self.assertFalse(self.man.exists() or self.completion.exists())


if __name__ == "__main__":
    unittest.main()
