"""The daemon, the clients and the loads of the trials, each in a process of its own."""

from __future__ import annotations

import argparse
import ctypes
import json
import multiprocessing
import os
import random
import signal
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]
SCENES = SOURCE / "models/scenes"
ARM = SCENES / "amtec_arm.yaml"
PATIENCE_S = 240.0  # a guard against waiting for ever, not a measure
SKIPPED = 77  # the exit code of a trial that this machine does not allow


class Failed(Exception):
    """A promise that did not hold."""


class NotHere(Exception):
    """This machine does not allow it."""


def expect(holds: bool, claim: str) -> None:
    if not holds:
        raise Failed(claim)


def use_client_of(programs: Path) -> None:
    """Makes `import visum` find the Python client of that build."""
    sys.path.insert(0, str(programs.parent / "python"))


class Daemon:
    """A visumd for the length of a `with`. `before`: a command that starts it (chrt, ip netns exec, ...). `patient`: a busy
    machine is no reason to stop a part."""

    def __init__(self, programs: Path, *options: object, scene: Path = ARM, before: tuple[object, ...] = (), log: Path | None = None,
                 verbosity: int = 0, patient: bool = True):
        patience = ("--session-silence-ms", 0, "--command-age-ms", 0) if patient else ()
        self.words = [*before, programs / "visumd", scene, "--port", 0, "--json", "-v", verbosity, *patience, *options]
        self.log = log

    def __enter__(self) -> Daemon:
        errors = self.log.open("w") if self.log else None
        self.process = subprocess.Popen(list(map(str, self.words)), stdout=subprocess.PIPE, stderr=errors, text=True)
        assert self.process.stdout
        line = self.process.stdout.readline()
        expect(line.startswith("{"), f"visumd did not start: {self.words}")
        self.ready = json.loads(line)
        self.port: int = self.ready["port"]
        self.address = f"127.0.0.1:{self.port}"
        return self

    def __exit__(self, *_: object) -> None:
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGCONT)
            self.process.terminate()
        self.process.wait(PATIENCE_S)
        if self.process.stdout:
            self.process.stdout.close()

    @property
    def pid(self) -> int:
        return self.process.pid

    def descriptors(self) -> int:
        return len(os.listdir(f"/proc/{self.pid}/fd"))

    def resident_kib(self) -> int:
        return int(Path(f"/proc/{self.pid}/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") // 1024


class FinrocBridge:
    """A `visum bridge finroc` in front of a daemon, for the length of a `with`."""

    def __init__(self, programs: Path, daemon: Daemon):
        self.words = [programs / "visum", "bridge", "finroc", "--connect", daemon.address, "--port", 0, "--json"]

    def __enter__(self) -> FinrocBridge:
        self.process = subprocess.Popen(list(map(str, self.words)), stdout=subprocess.PIPE, text=True)
        assert self.process.stdout
        self.port: int = json.loads(self.process.stdout.readline())["port"]
        return self

    def __exit__(self, *_: object) -> None:
        self.process.terminate()
        self.process.wait(PATIENCE_S)
        if self.process.stdout:
            self.process.stdout.close()


def connect(port: int) -> socket.socket:
    """A connection that says nothing."""
    return socket.create_connection(("127.0.0.1", port), timeout=30)


def replay(programs: Path, file: Path, patience_s: float = PATIENCE_S) -> dict[str, object]:
    """Runs `visum replay` on a recording and returns its output. All that can be read must have the same bits."""
    done = subprocess.run([programs / "visum", "replay", file, "--json"], capture_output=True, text=True, timeout=patience_s)
    expect(done.returncode in (0, 1), f"the recording cannot be read: {done.stdout}{done.stderr}")
    again = json.loads(done.stdout.splitlines()[-1])
    expect(again["equal"], f"the recording has other bits: {again}")
    expect(again["ticks"] - again["ticks_to_hash"] < 50, f"the recording has too few hashes: {again}")
    return again


def await_that(holds: Callable[[], bool], claim: str, patience_s: float = PATIENCE_S) -> float:
    """Waits until the claim holds; returns the seconds."""
    began = time.monotonic()
    while not holds():
        expect(time.monotonic() - began < patience_s, f"not within {patience_s:.0f} s: {claim}")
        time.sleep(0.02)
    return time.monotonic() - began


def counter() -> ctypes.c_longlong:
    """A number that one process writes and others read. It has no lock: a process that is killed while it holds
    one would leave it locked for ever."""
    return multiprocessing.Value("q", lock=False)


@contextmanager
def processes(*burdens: tuple[Callable[..., None], tuple[object, ...]]) -> Iterator[list[multiprocessing.Process]]:
    """Runs these processes for the length of a `with`."""
    running = [multiprocessing.Process(target=target, args=words, daemon=True) for target, words in burdens]
    for process in running:
        process.start()
    try:
        yield running
    finally:
        for process in running:
            process.kill()
            process.join()


def run_all(trials: dict[str, Callable[..., str]], wanted: list[str], options: argparse.Namespace) -> int:
    """Runs the named trials, or all, each with a folder of its own. Prints their results and returns the exit code."""
    if unknown := set(wanted) - set(trials):
        print(f"there is no {', '.join(unknown)}; there are {', '.join(trials)}", file=sys.stderr)
        return 2
    codes = set()
    for name in wanted or list(trials):
        with tempfile.TemporaryDirectory() as folder:
            try:
                said, code = trials[name](options, Path(folder)), 0
            except NotHere as reason:
                said, code = f"SKIPPED: {reason}", SKIPPED
            except Failed as broken:
                said, code = f"FAILED: {broken}", 1
            print(f"{name:18} {said}", flush=True)
            codes.add(code)
    return 1 if 1 in codes else min(codes)


# Loads: each goes on until it is killed -------------------------------------------------------------------


def burn() -> None:
    """Uses a processor's whole time."""
    while True:
        pass


def flood(port: int, seed: int) -> None:
    """As many connections as possible, which say nothing, nonsense or half a message, and break off."""
    dice = random.Random(seed)
    while True:
        try:
            with connect(port) as stranger:
                if dice.random() < 0.5:
                    stranger.sendall(dice.randbytes(dice.randrange(1, 200)))
                if dice.random() < 0.5:
                    stranger.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, b"\1\0\0\0\0\0\0\0")
        except OSError:
            pass  # turned away: as it should be


def watch(address: str, seed: int, count: int) -> None:
    """Observers that ask for everything, each at its own pace."""
    import visum

    dice = random.Random(seed)
    crowd = [visum.Client(address, name=f"observer {i}", role="observer", connect_timeout_s=60) for i in range(count)]
    while True:
        one = dice.choice(crowd)
        one.read_world()
        one.status()


def stop_and_go(pids: list[int], seed: int, most_s: float) -> None:
    """Stops one of the processes for a while, as a debugger would, again and again."""
    dice = random.Random(seed)
    while True:
        time.sleep(dice.uniform(0.0, most_s))
        pid = dice.choice(pids)
        try:
            os.kill(pid, signal.SIGSTOP)
            time.sleep(dice.uniform(0.0, most_s))
            os.kill(pid, signal.SIGCONT)
        except ProcessLookupError:
            return
