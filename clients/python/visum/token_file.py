"""Reads the token that a server asks for from a file, by the rule of protocol/token_file.h."""

from __future__ import annotations

from typing import TYPE_CHECKING

from visum.errors import Error, ErrorCode

if TYPE_CHECKING:
    from pathlib import Path

_RANKS = {b"observer": 1, b"controller": 2, b"admin": 3}


def read_token_file(file: str | Path | None, role: str) -> bytes:
    """Returns the token for `role`, or nothing without a file.

    It is the first line that holds a token alone. In a file like the server's, with lines of "ROLE TOKEN", it is the token
    of the least role that is enough, else of the greatest role. # begins a comment.
    """
    if not file:
        return b""
    try:
        with open(file, "rb") as opened:
            lines = opened.read().split(b"\n")
    except OSError as error:
        raise Error(ErrorCode.UNAUTHENTICATED, f"{file}: the token file cannot be read: {error.strerror}") from error
    wanted, best_rank, best = _RANKS[role.encode()], 0, b""
    for line in lines:
        words = line.split(b"#")[0].split()
        if len(words) == 1:
            return words[0]
        if not words or words[1].startswith(b"CN="):  # names a certificate, and holds no token
            continue
        rank = _RANKS.get(words[0], 0)
        if _is_better(rank, best_rank, wanted):
            best_rank, best = rank, words[1]
    if not best:
        raise Error(ErrorCode.UNAUTHENTICATED, f"{file}: the token file holds no token")
    return best


def _is_better(offered: int, best: int, wanted: int) -> bool:
    """True if a token of the rank `offered` suits the rank `wanted` better than a token of the rank `best`."""
    if best < wanted:
        return offered > best
    return wanted <= offered < best
