"""The exit code of a controller program."""

from __future__ import annotations

import sys
from typing import Callable

from visum.errors import Error, ErrorCode


def exit_code_of(name: str, run: Callable[[], object]) -> int:
    """Calls `run`, prints an error to stderr, and returns the exit code of the program `name`.

    0: success. 1: the server refused. 4: the server was lost, or did not answer in time. 130: Ctrl-C. In each failure a
    lease that run() holds in a `with` block is dropped, so that the part stops on its ramps.
    """
    try:
        run()
    except Error as error:
        print(f"{name}: {error}", file=sys.stderr)
        return 4 if error.code in (ErrorCode.CONNECTION, ErrorCode.TIMEOUT) else 1
    except KeyboardInterrupt:
        return 130
    return 0
