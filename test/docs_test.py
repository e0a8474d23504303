#!/usr/bin/python3
"""Holds the links of the pages: files and headings are there, and the index has each decision."""

import pathlib
import re
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[1]
DECISIONS = ROOT / "docs" / "decisions"
LINK = re.compile(r"\[[^\]]*\]\(([^)\s]+)\)")
CODE = re.compile(r"^(```.*?^```|    [^\n]*)|`[^`\n]*`", re.DOTALL | re.MULTILINE)


def pages():
    return [ROOT / "README.md", ROOT / "CHANGELOG.md", *sorted((ROOT / "docs").rglob("*.md"))]


def links(text):
    """The targets of a page's links, those in code aside."""
    return LINK.findall(CODE.sub("", text))


def anchors(text):
    """What follows the # in links to the page's headings."""
    headings = re.findall(r"^#+ +(.*)$", text, re.MULTILINE)
    plain = [re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).lower() for heading in headings]
    return {re.sub(r"[^\w\- ]", "", heading).strip().replace(" ", "-") for heading in plain}


def broken(page, text):
    """["page: link", ...] of those that lead nowhere in the repository."""
    wrong = []
    for link in links(text):
        if re.match(r"[a-z]+:", link):
            continue
        file, _, anchor = link.partition("#")
        target = (page.parent / file).resolve() if file else page
        if not target.exists() or anchor and anchor not in anchors(
                target.read_text(encoding="utf-8")):
            wrong.append(f"{page.relative_to(ROOT)}: {link}")
    return wrong


class Docs(unittest.TestCase):
    def test_links_lead_somewhere(self):
        self.assertEqual([link for page in pages()
                          for link in broken(page, page.read_text(encoding="utf-8"))], [])

    def test_the_index_has_each_decision_once(self):
        rows = re.findall(r"^\| \[(\d+)\]\(([^)]+)\) \| ",
                          (DECISIONS / "index.md").read_text(encoding="utf-8"), re.MULTILINE)
        files = sorted(path.name for path in DECISIONS.glob("*.md") if path.name != "index.md")
        self.assertEqual(sorted(file for _, file in rows), files)
        self.assertEqual([file for number, file in rows
                          if not file.startswith(number + "-")], [])

    def test_the_index_has_each_page(self):
        text = (ROOT / "docs" / "index.md").read_text(encoding="utf-8")
        self.assertEqual([page.name for page in sorted((ROOT / "docs").glob("*.md"))
                          if page.name != "index.md" and f"]({page.name})" not in text], [])

    def test_what_is_broken_is_found(self):
        page = ROOT / "docs" / "index.md"
        text = "[a](nowhere.md) [b](terms.md#no-such-heading) [c](terms.md) `[d](code.md)`"
        self.assertEqual(broken(page, text), ["docs/index.md: nowhere.md",
                                              "docs/index.md: terms.md#no-such-heading"])

    def test_anchors_of_headings(self):
        self.assertEqual(anchors("# A `word`, and [more](x.md)\n## Mapper settings (`--config`)\n"),
                         {"a-word-and-more", "mapper-settings---config"})


if __name__ == "__main__":
    unittest.main()
