#!/usr/bin/python3
"""Measures how long an emergency stop takes while a server in real time is attacked and its arm moves.

    stops.py [--bin FOLDER] [--stops N] [--within-ms MS] [ATTACK...]

Each stop is ordered twice: by `visum stop arm`, and in the session of an observer that was there before the attack. Every stop
must act, and within MS, which is long by default: how long a stop takes on a busy machine says little. Printed are the median
and the longest, of `visum stop` with the start of that program and as it measures itself.
Exit code 0: all acted in time; 1: one did not; 77: all were skipped.
"""

from __future__ import annotations

import argparse
import contextlib
import ctypes
import fcntl
import json
import math
import os
import random
import resource
import socket
import statistics
import struct
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import NamedTuple

import programs
from programs import PATIENCE_S, SOURCE, Daemon, connect, counter, expect, processes, run_all

WARM_S = 1.0  # of the attack before the first stop
LOW_MEMORY = 150 << 20  # bytes of addresses, as ulimit -v counts them
# 7.5 MB, which are refused unread; and one that is read before it is refused.
LARGE_TEXT = "{name: big, mass: 1, color: [" + "1, " * 2_500_000
MANY_SHAPES = "{name: big, mass: 1, shapes: [" + "{sphere: 0.1},\n" * 19_000 + "]}"


# Attacks: each goes on until it is killed ---------------------------------------------------------------


def again_and_again(act: Callable[[], None]) -> None:
    import visum

    while True:
        with contextlib.suppress(OSError, visum.Error):
            act()


def frames(role: int, *requests: dict[str, object]) -> bytes:
    """A hello and these requests, which nobody waits for."""
    from visum import visum_pb2 as pb

    hello = pb.Hello(min_version=1, max_version=1, client_name="x", role=role)
    messages = [pb.ClientMessage(id=0, **words) for words in ({"hello": hello}, *requests)]
    return b"".join(struct.pack("<I", message.ByteSize()) + message.SerializeToString() for message in messages)


def send_frames(port: int, text: bytes) -> None:
    def act() -> None:
        with connect(port) as stranger:
            stranger.settimeout(0.3)
            stranger.sendall(text)
            stranger.recv(1 << 16)

    again_and_again(act)


def send_resets(port: int) -> None:
    from visum import visum_pb2 as pb

    send_frames(port, frames(pb.ROLE_OBSERVER, *[{"reset": pb.Reset()}] * 200))


def take_snapshots(port: int) -> None:
    from visum import visum_pb2 as pb

    send_frames(port, frames(pb.ROLE_ADMIN, *[{"take_snapshot": pb.TakeSnapshot()}] * 60))


def open_and_stay(port: int) -> None:
    held: list[socket.socket] = []

    def act() -> None:
        held.append(connect(port))
        if len(held) > 200:
            held.pop(0).close()

    again_and_again(act)


def keep_http_alive(port: int) -> None:
    held: list[socket.socket] = []

    def act() -> None:
        held.append(connect(port))
        held[-1].sendall(b"GET /healthz HTTP/1.1\r\nHost: 127.0.0.1:%d\r\n\r\n" % port)
        if len(held) > 128:
            held.pop(0).close()

    again_and_again(act)


def send_datagrams(port: int) -> None:
    with socket.socket(type=socket.SOCK_DGRAM) as flood:
        again_and_again(lambda: flood.sendto(os.urandom(96), ("127.0.0.1", port)))


def add_bodies(port: int, text: str) -> None:
    import visum

    def act() -> None:
        with visum.Client(f"127.0.0.1:{port}", name="adds", role="admin") as admin:
            admin.add_body(text)

    again_and_again(act)


def read_nothing(port: int) -> None:
    """Observers that ask for everything and never read."""
    from visum import visum_pb2 as pb

    everything = frames(pb.ROLE_OBSERVER, {"subscribe": pb.Subscribe(part="arm", every_n_ticks=1)},
                        {"subscribe_world": pb.SubscribeWorld(every_n_ticks=1)}, *[{"describe_world": pb.DescribeWorld()}] * 20)
    held: list[socket.socket] = []

    def act() -> None:
        held.append(connect(port))
        held[-1].sendall(everything)
        if len(held) > 64:
            held.pop(0).close()

    again_and_again(act)


class Attack(NamedTuple):
    """A load on the daemon, and how the daemon is started for it."""

    burden: Callable[..., None]
    more: tuple[object, ...] = ()  # arguments after the port
    at_page: bool = False  # the page's port is attacked
    unread_log: bool = False
    low_memory: bool = False


ATTACKS = {
    "none": None,
    "unread-log": Attack(send_resets, unread_log=True),
    "refusals": Attack(send_resets),
    "snapshots": Attack(take_snapshots),
    "connections": Attack(open_and_stay),
    "page": Attack(keep_http_alive, at_page=True),
    "datagrams": Attack(send_datagrams),
    "large-bodies": Attack(add_bodies, (LARGE_TEXT,)),
    "many-shapes": Attack(add_bodies, (MANY_SHAPES,)),
    "low-memory": Attack(add_bodies, (LARGE_TEXT,), low_memory=True),
    "slow-readers": Attack(read_nothing),
}
ATTACKERS = 2


# The victim ---------------------------------------------------------------------------------------------


def move(address: str, steps: ctypes.c_longlong) -> None:
    """Moves the arm to and fro. A stop does not end it: it goes on once the arm may move again."""
    import visum

    with visum.Client(address, name="mover", connect_timeout_s=60) as client:
        arm = client.part("arm")
        arm.acquire()
        while True:
            arm.inputs("Desired Angle")[0] = 0.3 * math.sin(0.03 * steps.value)
            with contextlib.suppress(visum.Error):
                arm.write()
                steps.value += 1
            time.sleep(0.01)


@contextmanager
def unread_pipe(folder: Path) -> Iterator[Path]:
    """A pipe that nobody reads, and that is full after 4 KiB."""
    path = folder / "log"
    os.mkfifo(path)
    end = os.open(path, os.O_RDWR)
    try:
        fcntl.fcntl(end, fcntl.F_SETPIPE_SZ, 4096)
        yield path
    finally:
        os.close(end)


def measured(act: Callable[[], bool], claim: str) -> float:
    """Milliseconds. It must hold."""
    begun = time.monotonic()
    expect(act(), claim)
    return 1e3 * (time.monotonic() - begun)


def summed_up(how: str, took_ms: list[float]) -> str:
    return f"{how}: {statistics.median(took_ms):.0f} ms, at most {max(took_ms):.0f} ms"


def stops_under(name: str) -> Callable[[argparse.Namespace, Path], str]:
    attack = ATTACKS[name]

    def trial(options: argparse.Namespace, folder: Path) -> str:
        with ExitStack() as stack:
            log = stack.enter_context(unread_pipe(folder)) if attack and attack.unread_log else folder / "log"
            before = ("prlimit", f"--as={LOW_MEMORY}") if attack and attack.low_memory else ()
            daemon = stack.enter_context(Daemon(options.bin, "--clock", "realtime", "--run", before=before, log=log, verbosity=3, patient=False))
            return stop_again_and_again(options, daemon, attack)

    return trial


def stop_again_and_again(options: argparse.Namespace, daemon: Daemon, attack: Attack | None) -> str:
    import visum
    from visum import visum_pb2 as pb

    steps = counter()
    observer = visum.Client(daemon.address, name="observer", role="observer")
    admin = visum.Client(daemon.address, name="admin", role="admin")

    def insist(**request: object) -> pb.ServerMessage:
        """An ordinary request. Under an attack it may have to be repeated."""
        while True:
            try:
                return admin.connection.request(**request)
            except visum.Error as error:
                expect(error.code == visum.ErrorCode.BUSY, str(error))

    def is_pressed() -> bool:
        parameters = insist(get_parameters=pb.GetParameters(part="arm")).parameters.parameters
        return next(each.value.flag for each in parameters if each.name == "Emergency Stop")

    def pressing(pressed: bool) -> pb.SetParameter:
        return pb.SetParameter(part="arm", name="Emergency Stop", value=pb.ParameterValue(flag=pressed))

    took: dict[str, list[float]] = {"visum stop": [], "by itself": [], "in a session": []}

    def by_program() -> bool:
        done = subprocess.run([options.bin / "visum", "stop", "arm", "--connect", daemon.address, "--json"], capture_output=True, text=True,
                              timeout=PATIENCE_S)
        expect(done.returncode == 0, f"visum stop: {done.stderr}")
        took["by itself"].append(json.loads(done.stdout)["took_ms"])
        return json.loads(done.stdout)["acted"]

    def by_session() -> bool:
        observer.connection.request(set_parameter=pressing(True))
        return True

    with processes((move, (daemon.address, steps))) as movers, ExitStack() as attackers:
        programs.await_that(lambda: steps.value > 20, "the arm moves")
        if attack:
            port = daemon.ready["http"] if attack.at_page else daemon.port
            attackers.enter_context(processes(*[(attack.burden, (port, *attack.more))] * ATTACKERS))
            time.sleep(WARM_S)
        for _ in range(options.stops):
            for way, act in (("visum stop", by_program), ("in a session", by_session)):
                took[way].append(measured(act, f"{way}: the stop acts"))
                expect(is_pressed(), f"{way}: the arm is stopped")
                insist(set_parameter=pressing(False))
                time.sleep(random.uniform(0.0, 0.05))
        expect(movers[0].is_alive(), "the controller is still there")
    expect(daemon.process.poll() is None, "the server is still there")
    for way, times in took.items():
        expect(max(times) <= options.within_ms, f"{way}: {max(times):.0f} ms, of {options.within_ms:.0f} ms at most")
    return "; ".join(summed_up(way, times) for way, times in took.items())


TRIALS = {name: stops_under(name) for name in ATTACKS}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", type=Path, default=SOURCE / "build/release/bin")
    parser.add_argument("--stops", type=int, default=100, help="of each kind, under each attack")
    parser.add_argument("--within-ms", type=float, default=5000.0)
    parser.add_argument("attack", nargs="*", help=", ".join(ATTACKS))
    options = parser.parse_args()
    programs.use_client_of(options.bin)
    most = resource.getrlimit(resource.RLIMIT_NOFILE)[1]
    resource.setrlimit(resource.RLIMIT_NOFILE, (min(most, 4096), most))
    return run_all(TRIALS, options.attack, options)


if __name__ == "__main__":
    sys.exit(main())
