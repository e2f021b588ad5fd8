"""What can go wrong, as one exception with a code."""

from __future__ import annotations

from enum import IntEnum


class ErrorCode(IntEnum):
    """The server's refusals with the protocol's numbers (SPEC.md, section 10), and two of our own."""

    UNSPECIFIED = 0
    MALFORMED = 1
    TOO_LARGE = 2
    VERSION = 3
    UNAUTHENTICATED = 4
    FORBIDDEN = 5
    BUSY = 6
    UNKNOWN_NAME = 7
    NO_LEASE = 8
    LEASED = 9
    BAD_VALUE = 10
    STALE = 11
    WRONG_STATE = 12
    TIMEOUT = 13
    FROZEN = 14
    INTERNAL = 15
    CONNECTION = 100  # the connection could not be made, or is gone
    MISUSE = 101  # the program's own mistake, e.g. a vector of the wrong length


class Error(Exception):
    """Why a call failed. `owner` is who holds the lease, where one is in the way."""

    def __init__(self, code: ErrorCode, text: str, owner: str = "") -> None:
        super().__init__(text)
        self.code = code
        self.owner = owner


def nearest_hint(name: str, known: list[str]) -> str:
    """'; did you mean ...?' if one of the known names is near, else nothing."""
    from difflib import get_close_matches

    near = get_close_matches(name, known, n=1)
    return f"; did you mean '{near[0]}'?" if near else ""
