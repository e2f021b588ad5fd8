"""The one exception of this package, with a code for each kind of failure."""

from __future__ import annotations

from enum import IntEnum


class ErrorCode(IntEnum):
    """The server's refusals, with the protocol's numbers (SPEC.md, section 10), and two kinds of failure on our side."""

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
    """A failed call. `owner` names the holder of the lease if the lease is in the way, else it is empty."""

    def __init__(self, code: ErrorCode, text: str, owner: str = "") -> None:
        super().__init__(text)
        self.code = code
        self.owner = owner


def unknown_name(what: str, name: str, known: list[str]) -> Error:
    """Makes the error for a name that does not exist, as in "there is no part 'amr'; did you mean 'arm'?"."""
    return Error(ErrorCode.UNKNOWN_NAME, f"there is no {what} '{name}'{nearest_hint(name, known)}")


def nearest_hint(name: str, known: list[str]) -> str:
    """Returns "; did you mean 'arm'?" if one of the known names is near, else nothing."""
    from difflib import get_close_matches

    near = get_close_matches(name, known, n=1)
    return f"; did you mean '{near[0]}'?" if near else ""
