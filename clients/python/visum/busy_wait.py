"""A wait for an answer that looks again and again for a moment before it sleeps, as protocol/busy_wait.h.

Where a processor has gone idle, waking it takes tens of microseconds, and in lockstep a controller waits for each cycle.
Looking helps only while the server runs on another processor. So a wait sleeps at once for a while after it has looked in
vain, and for longer where others want the processor; never does it look with one processor, or under the time shim, whose
clock stands while one looks.
"""

from __future__ import annotations

import os
import socket
import time

_LONGEST_S = 400e-6  # ten ticks of an arm that carries something
_MOST_LOOKS = 1000  # where the clock stands
_PUSHED_OUT_S = 100e-6  # between two looks: another program ran on this processor
_MISSED_DOUBT, _PUSHED_DOUBT, _MOST_DOUBT = 1, 2, 4


class BusyWait:
    """For one socket without a time limit, and one thread at a time."""

    def __init__(self) -> None:
        has_processors = hasattr(os, "sched_getaffinity") and len(os.sched_getaffinity(0)) > 1
        self._helps = has_processors and hasattr(socket, "MSG_DONTWAIT") and "VISUM_LOCKSTEP" not in os.environ
        self._doubt = 0  # waits of late in which looking did not help, less those in which it did
        self._skip = 0  # so many waits sleep at once

    def receive(self, source: socket.socket, most_bytes: int) -> bytes | None:
        """Returns what arrives within a moment, b"" where the connection has ended. None: sleep now."""
        if not self._helps:
            return None
        if self._skip > 0:
            self._skip -= 1
            return None
        found, pushed_out = None, False
        now = begin = time.perf_counter()
        for _ in range(_MOST_LOOKS):
            last = now
            try:
                found = source.recv(most_bytes, socket.MSG_DONTWAIT)
            except BlockingIOError:
                os.sched_yield()
            now = time.perf_counter()
            pushed_out = now - last > _PUSHED_OUT_S
            if found is not None or pushed_out or now - begin > _LONGEST_S:
                break
        if pushed_out or found is None:
            self._distrust(_PUSHED_DOUBT if pushed_out else _MISSED_DOUBT)
        elif self._doubt > 0:
            self._doubt -= 1
        return found

    def _distrust(self, more: int) -> None:
        self._doubt = min(self._doubt + more, _MOST_DOUBT)
        self._skip = 1 << self._doubt
