#!/usr/bin/python3
"""Shows that the checks of the pages find their faults, and that install-pages leaves no dead link."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import links
import promises
import samples

INSTALL_PAGES = samples.SOURCE / "docker" / "install-pages"


class Folder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name).resolve()

    def write(self, path: str, text: str) -> None:
        (self.root / path).parent.mkdir(parents=True, exist_ok=True)
        (self.root / path).write_text(text)


class Links(Folder):
    def test_finds_each_kind_of_dead_link(self):
        self.write("b/page.md", "# Two words, here\n")
        for text, fault in {"[x](c.md)": "no file", "![x](c.png)": "no file", "[x](b/page.md#three)": "no heading",
                            "[x](#here)": "no heading", "[x](../a.md)": "out of the folder",
                            '<img src="c.png">': "no file"}.items():
            self.write("a.md", text)
            (found,) = links.faults_of(self.root)
            self.assertIn(fault, found)

    def test_leaves_right_links_and_code_alone(self):
        self.write("b/page.md", "# Two words, here\n## `visum run`\n## Same\n## Same\n[up](../a.md) [b](.)\n")
        self.write("a.md", "[x](b/page.md#two-words-here) [x](b/page.md#visum-run) [x](b/page.md#same-1) [x](b)\n"
                           "[x](https://nowhere.example/x.md) `[x](c.md)`\n```\n[x](c.md)\n```\n# A\n[x](#a)\n")
        self.write("build/c.md", "[x](nowhere.md)")
        self.assertEqual(links.faults_of(self.root), [])


class Promises(Folder):
    def test_finds_a_name_that_stands_for_no_test(self):
        self.write("a_test.cc", "TEST(Suite, One) {}\nTEST_P(Other, Two) {}\nINSTANTIATE_TEST_SUITE_P(All, Other, x);\n")
        names = promises.google_tests_in(self.root) | {"Trial.Wall.disk", "fuzz_web_replay"}
        page = "`Suite.One`, `Suite.*`, `All/Other.*`, `Trial.Wall.*`, `fuzz_web`; `Suite.Two`, `Trial.Wand`, `fuzz_wab` and `page.md`"
        self.assertEqual(promises.missing_in(page, names), ["Suite.Two", "Trial.Wand", "fuzz_wab"])


class Samples(Folder):
    def test_a_block_that_differs_is_stale_and_is_renewed(self):
        path = "clients/examples/first_controller/first_controller.cc"
        for old in ("int main() {}\n", ""):
            page = f"<!-- file: {path} -->\n```cpp\n{old}```\n<!-- file: end -->\n"
            renewed, stale = samples.renewed(page, Path("visum"))
            self.assertEqual(stale, [f"file: {path}"])
            self.assertIn("visum::Client client", renewed)
            self.assertEqual(samples.renewed(renewed, Path("visum")), (renewed, []))

    def test_wall_clock_counts_for_nothing_and_all_else_counts(self):
        line = "  23.000 s simulated in {} s ({} x real time), 23000 ticks, state hash {}\n"
        self.assertEqual(samples.without_wall_clock(line.format(1.335, 17.2, "ab")),
                         samples.without_wall_clock(line.format(0.9, 25, "ab")))
        self.assertNotEqual(samples.without_wall_clock(line.format(1.335, 17.2, "ab")),
                            samples.without_wall_clock(line.format(1.335, 17.2, "cd")))


class InstallPages(Folder):
    def test_links_lead_to_installed_files_or_become_text(self):
        self.write("source/README.md", "[s](server/README.md#one) [c](server/a.cc) ![p](p.png) [m](models/arm.yaml)\n"
                                       "```\n[c](server/a.cc)\n```\n")
        self.write("source/LICENSE", "")
        self.write("source/p.png", "")
        self.write("source/models/README.md", "[up](../README.md) [arm](arm.yaml)\n")
        self.write("source/server/README.md", "# One\n[a](a.cc) [web](https://x.example)\n")
        self.write("source/server/a.cc", "")
        self.write("share/visum/models/README.md", "")
        self.write("share/visum/models/arm.yaml", "")
        umask = os.umask(0o077)
        self.addCleanup(os.umask, umask)
        share = self.root / "share"
        subprocess.run([sys.executable, INSTALL_PAGES, self.root / "source", share / "doc/visum", share / "visum"],
                       check=True)
        self.assertEqual(links.faults_of(share), [])
        readme = (share / "doc/visum/README.md").read_text()
        self.assertEqual(readme, "[s](server/README.md#one) c ![p](p.png) [m](../../visum/models/arm.yaml)\n"
                                 "```\n[c](server/a.cc)\n```\n")
        self.assertIn("[up](../../doc/visum/README.md)", (share / "visum/models/README.md").read_text())
        for path in (share / "doc").rglob("*"):
            self.assertEqual(path.stat().st_mode & 0o777, 0o755 if path.is_dir() else 0o644, path)


if __name__ == "__main__":
    unittest.main()
