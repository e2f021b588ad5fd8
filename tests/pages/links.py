#!/usr/bin/python3
"""Fails where a link of a Markdown page leads nowhere.

    links.py FOLDER    checks all .md files below FOLDER, except in build, node_modules and hidden folders

A relative link must lead to a file or folder below FOLDER, and its anchor to a heading or to an id
of that page. Addresses with a scheme (https:, mailto:) are not looked up: tests need no network.
"""

from __future__ import annotations

import os
import re
import sys
from pathlib import Path
from urllib.parse import unquote

SKIPPED = {"build", "node_modules", "__pycache__"}
LINK = re.compile(r"!?\[[^\]]*\]\(<?([^)>\s]+)>?(?:\s+\"[^\"]*\")?\)|<(?:a|img)[^>]*?(?:href|src)=\"([^\"]+)\"")
FENCE = re.compile(r"^\s*```.*?^\s*```", re.S | re.M)
CODE = re.compile(r"`[^`\n]*`")


def anchors(page: Path) -> set[str]:
    """The anchors of a page's headings, as GitHub makes them, and its explicit ids."""
    text = FENCE.sub("", page.read_text())
    found: dict[str, int] = {}
    names = set(re.findall(r"\bid=\"([^\"]+)\"", text))
    for heading in re.findall(r"^#{1,6} +(.+?)#*$", text, re.M):
        heading = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading)
        slug = re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-")
        count = found.get(slug, 0)
        names.add(slug if count == 0 else f"{slug}-{count}")
        found[slug] = count + 1
    return names


def fault_of(link: str, page: Path, root: Path) -> str | None:
    """Why the link leads nowhere, if it does."""
    if re.match(r"[a-z][a-z0-9+.-]*:", link):
        return None
    path, _, anchor = link.partition("#")
    target = (page.parent / unquote(path)).resolve() if path else page
    if target != root and root not in target.parents:
        return "leads out of the folder"
    if not target.exists():
        return "leads to no file"
    if anchor and target.suffix == ".md" and unquote(anchor) not in anchors(target):
        return "leads to no heading"
    return None


def pages_of(root: Path) -> list[Path]:
    found = []
    for folder, names, files in os.walk(root):
        names[:] = sorted(name for name in names if name not in SKIPPED and not name.startswith("."))
        found += [Path(folder, file) for file in sorted(files) if file.endswith(".md")]
    return found


def faults_of(root: Path) -> list[str]:
    """The links of all pages below root that lead nowhere, each with its page and the reason."""
    faults = []
    for page in pages_of(root):
        text = CODE.sub("", FENCE.sub("", page.read_text()))
        for first, second in LINK.findall(text):
            if fault := fault_of(first or second, page, root):
                faults.append(f"{page.relative_to(root)}: '{first or second}' {fault}")
    return faults


def main() -> None:
    if len(sys.argv) != 2:
        sys.exit(str(__doc__))
    root = Path(sys.argv[1]).resolve()
    count = len(pages_of(root))
    if count == 0:
        sys.exit(f"{root}: no page found")
    if faults := faults_of(root):
        sys.exit("\n".join(faults))
    print(f"{count} pages, every link leads somewhere")


if __name__ == "__main__":
    main()
