#!/usr/bin/python3
"""Prints which tests of this run of ctest were skipped, and why. With CI=true a skip that is not expected is a failure.

    skips.py FOLDER_OF_CTESTS_LOG EXPECTED.txt

It reads the log that ctest writes at this moment, so it knows nothing of earlier runs.
"""

from __future__ import annotations

import fnmatch
import os
import re
import sys
from pathlib import Path
from typing import NamedTuple

# A skip has one of these forms in a test's output: GoogleTest's, unittest's, and that of our own programs.
GOOGLE_TEST = re.compile(r": Skipped\n(?P<why>.*)\n(?:.*\n)*?\[  SKIPPED \] (?P<part>\S+) \(")
UNITTEST = re.compile(r"^(?P<part>\w+) \([\w.]+\)(?:\n.*)? \.\.\. skipped ['\"](?P<why>.*)['\"]$", re.M)
PROGRAM = re.compile(r"^(?:(?P<part>\S+) +)?(?:SKIPPED|skipped): (?P<why>.*)$", re.M)
BLOCK = re.compile(r"^\d+/\d+ Test: (?P<test>.*)\n(?P<rest>(?:.*\n)*?)(?=^\d+/\d+ Testing: |\Z)", re.M)
VERDICT = re.compile(r"^<end of output>\n(?:.*\n)*?-+\n(?P<verdict>(?:.*\n)*?)\"", re.M)


class Skip(NamedTuple):
    name: str  # "TEST", or "TEST: PART" if the test has parts
    why: str


def skips_in(log: str) -> list[Skip]:
    """The skips that a log of ctest tells of, also of a part of a test that passed."""
    skips = []
    for block in BLOCK.finditer(log):
        test, rest = block["test"], block["rest"]
        found = [Skip(test if match["part"] in (None, test) else f"{test}: {match['part']}", match["why"])
                 for form in (GOOGLE_TEST, UNITTEST, PROGRAM) for match in form.finditer(rest)]
        verdict = VERDICT.search(rest)
        if not found and verdict and "kip" in verdict["verdict"]:
            found.append(Skip(test, "no reason given"))
        skips += found
    return skips


def expected_in(text: str) -> list[str]:
    """The names of a list of expected skips. Raises ValueError for a line without a reason."""
    names = []
    for line in filter(lambda line: line.strip() and not line.startswith("#"), text.splitlines()):
        name, _, why = line.partition("  ")
        if not why.strip():
            raise ValueError(f"a name, two blanks and a reason are expected, not: {line}")
        names.append(name)
    return names


def unexpected(skips: list[Skip], expected: list[str]) -> list[Skip]:
    return [skip for skip in skips if not any(fnmatch.fnmatchcase(skip.name, name) for name in expected)]


def newest_log(folder: Path) -> Path:
    """While ctest runs, its log ends in .tmp."""
    logs = sorted(folder.glob("LastTest*.log.tmp*"), key=lambda file: file.stat().st_mtime)
    if not logs:
        sys.exit(f"{folder}: ctest writes no log there")
    return logs[-1]


def main() -> int:
    folder, listed = map(Path, sys.argv[1:])
    skips = skips_in(newest_log(folder).read_text(errors="replace"))
    strangers = unexpected(skips, expected_in(listed.read_text()))
    for skip in skips:
        print(f"skipped{'' if skip not in strangers else ', not in the list'}: {skip.name}  {skip.why}")
    print(f"{len(skips)} skipped, {len(strangers)} of them not listed in {listed}")
    return 1 if strangers and os.environ.get("CI", "") not in ("", "0", "false") else 0


if __name__ == "__main__":
    sys.exit(main())
