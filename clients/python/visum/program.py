"""How a controller that is a program ends."""

from __future__ import annotations

import sys
from typing import Callable

from visum.errors import Error, ErrorCode


def exit_code_of(name: str, run: Callable[[], object]) -> int:
    """Runs it. 0: well; 4: the server was lost or did not answer in time; 1: it refused; 130: Ctrl-C. Says why on stderr.

    A lease that run() holds in a `with` is dropped in each case, so that the part stops on its ramps.
    """
    try:
        run()
    except Error as error:
        print(f"{name}: {error}", file=sys.stderr)
        return 4 if error.code in (ErrorCode.CONNECTION, ErrorCode.TIMEOUT) else 1
    except KeyboardInterrupt:
        return 130
    return 0
