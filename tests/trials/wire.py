"""A wire between two network namespaces: a relay that delays, loses and doubles packets, and that can be cut.

Each namespace has a TUN device. Packets that leave the one come out of the other, as the relay decides. It needs root and
/dev/net/tun, but not the kernel's queueing disciplines (netem), which not every kernel has.
"""

from __future__ import annotations

import ctypes
import fcntl
import heapq
import multiprocessing
import os
import random
import select
import struct
import subprocess
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from typing import NamedTuple

from programs import NotHere, counter, processes

HERE, THERE = "10.91.0.1", "10.91.0.2"  # the daemon's end, and the controller's
CLONE_NEWNET = 0x40000000  # sched.h
TUNSETIFF, IFF_TUN, IFF_NO_PI = 0x400454CA, 0x0001, 0x1000  # linux/if_tun.h
MOST_BYTES = 65536  # of a packet


class Weather(NamedTuple):
    """The faults that packets meet, in both directions. Each has its own delay, so they may overtake each other."""

    delay_ms: float = 0.0
    jitter_ms: float = 0.0  # more or less than the delay, evenly
    lost: float = 0.0  # of 1
    doubled: float = 0.0  # of 1; the second has a delay of its own


class Counts(NamedTuple):
    """Counts of packets."""

    carried: int
    lost: int
    doubled: int
    overtaken: int

    def __str__(self) -> str:
        return f"{self.carried} packets, {self.lost} lost, {self.doubled} doubled, {self.overtaken} overtaken by later ones"


def relay(ends: tuple[int, int], weather: Weather, seed: int, cut: ctypes.c_longlong,
          counts: "ctypes.Array[ctypes.c_longlong]") -> None:
    """Carries packets between the two devices until it is killed."""
    dice = random.Random(seed)
    under_way: list[tuple[float, int, int, bytes]] = []  # when they are due, their number, where to
    newest = dict.fromkeys(ends, 0)
    number = 0

    def send_off(to: int, packet: bytes) -> None:
        nonlocal number
        number += 1
        late_ms = weather.delay_ms + dice.uniform(-weather.jitter_ms, weather.jitter_ms)
        heapq.heappush(under_way, (time.monotonic() + 1e-3 * late_ms, number, to, packet))

    def deliver(number: int, to: int, packet: bytes) -> None:
        counts[3] += number < newest[to]
        newest[to] = max(newest[to], number)
        os.write(to, packet)
        counts[0] += 1

    while True:
        wait_s = max(0.0, under_way[0][0] - time.monotonic()) if under_way else None
        for end in select.select(ends, (), (), wait_s)[0]:
            packet = os.read(end, MOST_BYTES)
            if cut.value:
                continue
            if dice.random() < weather.lost:
                counts[1] += 1
                continue
            to = ends[1 - ends.index(end)]
            send_off(to, packet)
            if dice.random() < weather.doubled:
                counts[2] += 1
                send_off(to, packet)
        while under_way and under_way[0][0] <= time.monotonic():
            deliver(*heapq.heappop(under_way)[1:])


def ip(*words: object) -> None:
    done = subprocess.run(["ip", *map(str, words)], capture_output=True, text=True)
    if done.returncode != 0:
        raise NotHere(f"ip {' '.join(map(str, words))}: {done.stderr.strip()}")


@contextmanager
def inside(namespace: str) -> Iterator[None]:
    """Within this block, sockets and devices are opened in the namespace."""
    libc = ctypes.CDLL(None, use_errno=True)
    with open("/proc/self/ns/net") as home, open(f"/run/netns/{namespace}") as there:
        if libc.setns(there.fileno(), CLONE_NEWNET) != 0:
            raise NotHere(f"no setns: {os.strerror(ctypes.get_errno())}")
        try:
            yield
        finally:
            libc.setns(home.fileno(), CLONE_NEWNET)


def open_device(namespace: str, address: str) -> int:
    """A device `wire` with that address. It exists as long as its descriptor is open."""
    try:
        with inside(namespace):
            device = os.open("/dev/net/tun", os.O_RDWR)
            fcntl.ioctl(device, TUNSETIFF, struct.pack("16sH22x", b"wire", IFF_TUN | IFF_NO_PI))
    except OSError as error:
        raise NotHere(f"/dev/net/tun: {error}") from error
    ip("-n", namespace, "address", "add", f"{address}/24", "dev", "wire")
    for name in ("lo", "wire"):
        ip("-n", namespace, "link", "set", name, "up")
    return device


class Wire:
    """Two namespaces, `far` with the daemon and `near` with the controller, and the wire between them."""

    def __init__(self, weather: Weather = Weather(), seed: int = 1) -> None:
        self.weather, self.seed = weather, seed
        self.near, self.far = (f"visum-{side}-{os.getpid()}" for side in ("near", "far"))
        self._cut = counter()
        self._counts = multiprocessing.Array("q", len(Counts._fields), lock=False)

    def __enter__(self) -> Wire:
        with ExitStack() as stack:
            for name in (self.near, self.far):
                ip("netns", "add", name)
                stack.callback(subprocess.run, ["ip", "netns", "delete", name], capture_output=True)
            ends = []
            for name, address in ((self.near, THERE), (self.far, HERE)):
                ends.append(open_device(name, address))
                stack.callback(os.close, ends[-1])
            stack.enter_context(processes((relay, (tuple(ends), self.weather, self.seed, self._cut, self._counts))))
            self._undo = stack.pop_all()
        return self

    def __exit__(self, *_: object) -> None:
        self._undo.close()

    def cut(self) -> None:
        """Cuts the wire: neither end hears from the other any more, and no device reports it."""
        self._cut.value = 1

    def mend(self) -> None:
        self._cut.value = 0

    def counts(self) -> Counts:
        return Counts(*self._counts)
