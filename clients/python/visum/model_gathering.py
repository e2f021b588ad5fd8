"""Gathers the files of a model on this machine, for Client.spawn()."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from pathlib import Path

from visum.errors import Error, ErrorCode

_MOST_FILES = 256
_MOST_BYTES = 8 << 20
_TEXTS = {".urdf", ".sdf", ".xml", ".mjcf", ".xacro", ".world", ".yaml", ".yml", ".dae", ".obj", ".mtl", ".x3d"}
_WORD = re.compile(rb"\"([^\"\n]{1,256})\"|'([^'\n]{1,256})'|([^\s\"'<>{}\[\](),=;]{1,256})")
_COMMENTS = {True: re.compile(rb"(?:^|(?<=\s))#[^\n]*"), False: re.compile(rb"<!--.*?-->", re.DOTALL)}
_NUMBER = re.compile(r"[0-9.+\-eE]*")


def model_files(file: str | Path) -> tuple[str, dict[str, bytes]]:
    """Returns the name of the file for Client.spawn(), and all files by their names: the file itself and, as deep as they go,
    those whose names stand in it, relative to it or as package://NAME/... below a folder NAME above it."""
    first = Path(os.path.abspath(file))
    found: dict[Path, bytes] = {}
    waiting = [first]
    size = 0
    while waiting:
        path = waiting.pop()
        if path in found:
            continue
        try:
            content = path.read_bytes()
        except OSError as error:
            raise Error(ErrorCode.MISUSE, f"{path}: {error.strerror}") from error
        size += len(content) + 256
        if len(found) == _MOST_FILES or size > _MOST_BYTES:
            raise Error(ErrorCode.MISUSE, f"{first} and what it names are more than the {_MOST_FILES} files or "
                                          f"{_MOST_BYTES >> 20} MiB that can be sent")
        found[path] = content
        if path.suffix.lower() in _TEXTS:
            is_yaml = path.suffix.lower() in (".yaml", ".yml")
            waiting.extend(_named(_COMMENTS[is_yaml].sub(b"", content), path.parent))
    common = Path(os.path.commonpath([path.parent for path in found]))
    return first.relative_to(common).as_posix(), {path.relative_to(common).as_posix(): content for path, content in found.items()}


def _named(content: bytes, folder: Path) -> Iterator[Path]:
    for match in _WORD.finditer(content):
        quoted = match[1] or match[2]
        for word in {quoted, *quoted.split()} if quoted else {match[3]}:
            text = word.decode(errors="replace")
            if "." in text and not _NUMBER.fullmatch(text) and "\0" not in text:
                if named := _file_named(text, folder):
                    yield Path(os.path.normpath(named))


def _file_named(word: str, folder: Path) -> Path | None:
    word = word.removeprefix("file://")
    for scheme in ("package://", "model://"):
        if word.startswith(scheme):
            places = [above / word[len(scheme):] for above in (folder, *folder.parents)]
            return next((place for place in places if place.is_file()), None)
    place = folder / word
    return place if not os.path.isabs(word) and place.is_file() else None
