#!/usr/bin/python3
"""Keeps what README quotes the same as what the tree holds and what the programs print.

    samples.py VISUM            compares; exits with 1 and says which block is stale
    samples.py VISUM --write    rewrites the stale blocks

VISUM is the program, e.g. build/dev/bin/visum. A block stands between two comments:

    <!-- sample: visum run FILE -->   an excerpt of what that command prints
    <!-- file: PATH -->               a file of the tree, without the comment that it begins with

Figures of the wall clock are masked before the comparison: they differ from run to run. README also
has to stay short: it is the first page that a newcomer reads.
"""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]
PAGE = SOURCE / "README.md"
BLOCK = re.compile(r"(<!-- (sample|file): (?!end)(.+?) -->\n```(\w*)\n)(.*?)(```\n<!-- \2: end -->)", re.S)
WALL_CLOCK = re.compile(r" in \d+\.\d+ s \(\d+(\.\d+)? x real time\)")
TIMEOUT_S = 240
MOST_LINES = 120
FIRST_STEPS = 2  # lines of the controller that the excerpt shows
CHECKS = 1  # and of the checks


def without_wall_clock(text: str) -> str:
    return WALL_CLOCK.sub(" in ... s", text)


def excerpt(output: str) -> str:
    """The controller's first lines, the first checks, and the verdict; "..." where lines are left out."""
    lines = [line.rstrip() for line in output.splitlines()]
    steps = [line for line in lines if re.match(r"\w+ +\| +\d", line)]
    checks: list[list[str]] = []  # each with the lines that it goes on in
    for line in lines:
        if re.match(r"  (passed|failed) ", line):
            checks.append([line])
        elif checks and line.startswith("        "):
            checks[-1].append(line)
    verdict = next((i for i, line in enumerate(lines) if "simulated in" in line), len(lines))
    shown = [line for check in checks[:CHECKS] for line in check]
    return "\n".join([*steps[:FIRST_STEPS], "...", *shown, "...", *lines[verdict:]]) + "\n"


def sample(command: str, visum: Path) -> str:
    program, *arguments = shlex.split(command)
    if program != "visum":
        sys.exit(f"{PAGE.name}: a sample can only be of 'visum', not of '{program}'")
    run = subprocess.run([visum, *arguments], cwd=SOURCE, capture_output=True, text=True, timeout=TIMEOUT_S)
    if run.returncode != 0:
        sys.exit(f"'{command}' ended with {run.returncode}:\n{run.stdout}{run.stderr}")
    return excerpt(run.stderr + run.stdout)  # what the controller says is on stderr


def file(path: str) -> str:
    return re.sub(r"\A(//.*\n)+", "", (SOURCE / path).read_text())


def renewed(page: str, visum: Path) -> tuple[str, list[str]]:
    """The page with its blocks as they have to be, and the names of those that are not."""
    stale: list[str] = []

    def renew(block: re.Match[str]) -> str:
        start, kind, name, _, old, end = block.groups()
        new = sample(name, visum) if kind == "sample" else file(name)
        if without_wall_clock(new) == without_wall_clock(old):
            return block.group(0)
        stale.append(f"{kind}: {name}")
        return start + new + end

    return BLOCK.sub(renew, page), stale


def main() -> None:
    if len(sys.argv) not in (2, 3) or sys.argv[2:] not in ([], ["--write"]):
        sys.exit(str(__doc__))
    visum = Path(sys.argv[1]).resolve()
    page, stale = renewed(PAGE.read_text(), visum)
    blocks = len(BLOCK.findall(page))
    if blocks < 2:
        sys.exit(f"{PAGE.name}: {blocks} blocks found; has a comment around one been changed?")
    if (count := page.count("\n")) > MOST_LINES:
        sys.exit(f"{PAGE.name} has {count} lines, more than {MOST_LINES}: move some to the page of their folder")
    if sys.argv[2:]:
        PAGE.write_text(page)
        print(f"{PAGE.name}: {len(stale)} of {blocks} blocks rewritten")
    elif stale:
        sys.exit(f"{PAGE.name} is stale: {', '.join(stale)}. To rewrite it: {shlex.join(sys.argv)} --write")


if __name__ == "__main__":
    main()
