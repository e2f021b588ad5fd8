#!/usr/bin/python3
"""Checks that each test that tests/RELIABILITY.md names is there.

    promises.py PAGE FOLDER_OF_TESTS BUILD

A name is that of a GoogleTest or of ctest, with * for anything. Prints those that are not there; exit code 1 if there are some.
"""

from __future__ import annotations

import fnmatch
import re
import sys
from pathlib import Path

NAMED = re.compile(r"`((?:All/)?[A-Z]\w*\.[\w.*-]+|fuzz_\w+)`")
GOOGLE_TEST = re.compile(r"^TEST(?:_F|_P)?\((\w+),\s*(\w+)\)", re.M)
TYPED_TEST = re.compile(r"^TYPED_TEST(?:_P)?\((\w+),\s*(\w+)\)", re.M)
ADD_TEST = re.compile(r"^add_test\(\[=\[(.*?)\]=\]", re.M)
INSTANCE = re.compile(r"^INSTANTIATE_TEST_SUITE_P\((\w+),\s*(\w+),", re.M)


def google_tests_in(folder: Path) -> set[str]:
    """Suite.Name of each test in the sources, also with the suite's instances in front."""
    names: set[str] = set()
    for file in folder.rglob("*.cc"):
        text = file.read_text(errors="replace")
        instances: dict[str, list[str]] = {}
        for instance, suite in INSTANCE.findall(text):
            instances.setdefault(suite, []).append(instance)
        for suite, name in GOOGLE_TEST.findall(text) + TYPED_TEST.findall(text):
            names.add(f"{suite}.{name}")
            names.update(f"{instance}/{suite}.{name}/0" for instance in instances.get(suite, []))
    return names


def tests_of_ctest(build: Path) -> set[str]:
    """Names in the files that ctest reads. To ask ctest itself would overwrite the log of the ctest that runs us."""
    return {name for file in build.rglob("CTestTestfile.cmake") for name in ADD_TEST.findall(file.read_text())}


def missing_in(page: str, names: set[str]) -> list[str]:
    """The names on the page that stand for no test. A fuzz target stands for all tests whose names begin with it."""
    return [name for name in NAMED.findall(page)
            if not fnmatch.filter(names, name + "*" if name.startswith("fuzz_") else name)]


def main() -> int:
    page, folder, build = map(Path, sys.argv[1:])
    missing = missing_in(page.read_text(), google_tests_in(folder) | tests_of_ctest(build))
    for name in missing:
        print(f"{page}: there is no test {name}")
    return 1 if missing else 0


if __name__ == "__main__":
    sys.exit(main())
