#!/usr/bin/python3
"""Builds the report's page anew from its source: the shipped bundle must be the same.

    viewer_bundle_test.py BUILD_DIRECTORY
"""

import json
import re
import subprocess
import sys
import tempfile
import unittest

from viewer_install import VIEWER, find_program, install

BUILD_DIRECTORY = sys.argv.pop(1)


class ViewerBundle(unittest.TestCase):
    def test_shipped_bundle_is_built_from_the_source(self):
        directory = install(BUILD_DIRECTORY)
        with tempfile.NamedTemporaryFile(suffix=".js") as output:
            subprocess.run([find_program("node"), "build.mjs", output.name], cwd=directory,
                           check=True, capture_output=True)
            with open(output.name, "rb") as built:
                self.assertTrue(
                    built.read() == (VIEWER / "dist/viewer.js").read_bytes(),
                    "core/outputs/viewer/dist/viewer.js is stale: run npm ci --ignore-scripts and "
                    "npm run build in core/outputs/viewer")

    def test_bundle_keeps_licence_and_ends_no_element(self):
        bundle = (VIEWER / "dist/viewer.js").read_text(encoding="utf-8")
        self.assertIn("three.js authors", bundle)
        self.assertIn("Permission is hereby granted, free of charge", bundle)
        self.assertIsNone(re.search(r"</script|<!--", bundle, re.IGNORECASE))

    def test_lockfile_names_no_host(self):
        lock = (VIEWER / "package-lock.json").read_text(encoding="utf-8")
        self.assertNotIn("://", re.sub(r'"url": "[^"]*"', "", lock))
        packages = json.loads(lock)["packages"]
        self.assertTrue(all("integrity" in entry for name, entry in packages.items() if name))


if __name__ == "__main__":
    unittest.main()
