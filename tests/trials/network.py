#!/usr/bin/python3
"""A daemon and a controller in two network namespaces with a wire between them, which is cut or loses packets.

    network.py [--bin FOLDER] [--ticks T] [--loss PERCENT] [TRIAL...]

  cut     the wire is cut while the controller holds a lease and the arm moves: the daemon finds out by itself, the arm stops
          with a fault, and the next controller gets the lease
  loss    the wire loses packets in both directions: a run in lockstep has the bits of one without losses

Needs root for the namespaces, and nft for the loss: else it is skipped, and said. How long it took is printed and not judged.
Exit code 0: all held; 1: one did not; 77: all were skipped.
"""

from __future__ import annotations

import argparse
import ctypes
import math
import multiprocessing
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import programs
from one_hash import Answers, answer_of, control
from programs import SOURCE, Daemon, NotHere, await_that, expect, processes

HERE, THERE = "10.91.0.1", "10.91.0.2"
TOKEN = "0123456789abcdef0123456789abcdef"
CLONE_NEWNET = 0x40000000  # sched.h
CONTROLLER_LOST = 6  # the sensor output Part State, hwparts/servo_group/part_state.h


def ip(*words: object) -> None:
    done = subprocess.run(["ip", *map(str, words)], capture_output=True, text=True)
    if done.returncode != 0:
        raise NotHere(f"ip {' '.join(map(str, words))}: {done.stderr.strip()}")


class Wire:
    """Two namespaces, `far` with the daemon and `near` with the controller, and a pair of interfaces between them."""

    def __init__(self) -> None:
        self.near, self.far = (f"visum-{side}-{os.getpid()}" for side in ("near", "far"))

    def __enter__(self) -> Wire:
        try:
            for name in (self.near, self.far):
                ip("netns", "add", name)
            ip("link", "add", "wire", "netns", self.near, "type", "veth", "peer", "name", "wire", "netns", self.far)
            for name, address in ((self.near, THERE), (self.far, HERE)):
                ip("-n", name, "address", "add", f"{address}/24", "dev", "wire")
                for device in ("lo", "wire"):
                    ip("-n", name, "link", "set", device, "up")
        except NotHere:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_: object) -> None:
        for name in (self.near, self.far):
            subprocess.run(["ip", "netns", "delete", name], capture_output=True)

    def cut(self) -> None:
        """The daemon's end hears nothing more."""
        ip("-n", self.near, "link", "set", "wire", "down")

    def lose(self, percent: float) -> None:
        rules = (f"table ip losses {{\n chain input {{\n  type filter hook input priority 0;\n"
                 f"  iifname wire numgen random mod 1000 < {round(10 * percent)} counter drop\n }}\n}}\n")
        for name in (self.near, self.far):
            self.nft(name, "-f", "-", rules=rules)

    def lost(self) -> int:
        """The packets that were dropped."""
        rules = [self.nft(name, "list", "ruleset").split() for name in (self.near, self.far)]
        return sum(int(words[words.index("packets") + 1]) for words in rules)

    def nft(self, name: str, *words: str, rules: str = "") -> str:
        if not shutil.which("nft"):
            raise NotHere("no nft: apt-get install nftables")
        done = subprocess.run(["ip", "netns", "exec", name, "nft", *words], input=rules, capture_output=True, text=True)
        if done.returncode != 0:
            raise NotHere(f"nft: {done.stderr.strip()}")
        return done.stdout


@contextmanager
def inside(namespace: str) -> Iterator[None]:
    """Sockets that are opened in this block belong to the namespace."""
    libc = ctypes.CDLL(None, use_errno=True)
    with open("/proc/self/ns/net") as home, open(f"/run/netns/{namespace}") as there:
        if libc.setns(there.fileno(), CLONE_NEWNET) != 0:
            raise NotHere(f"no setns: {os.strerror(ctypes.get_errno())}")
        try:
            yield
        finally:
            libc.setns(home.fileno(), CLONE_NEWNET)


def daemon_at(options: argparse.Namespace, wire: Wire, folder: Path, clock: str) -> Daemon:
    (folder / "tokens").write_text(f"admin {TOKEN}\n")
    (folder / "tokens").chmod(0o600)
    (folder / "token").write_text(TOKEN)
    return Daemon(options.bin, "--clock", clock, "--listen", "0.0.0.0", "--token-file", folder / "tokens", "--http", "off",
                  before=("ip", "netns", "exec", wire.far))


# The wire is cut ---------------------------------------------------------------------------------------------------


def wave(wire: Wire, port: int, token: Path, steps: "multiprocessing.Value[int]") -> None:
    """Moves the arm to and fro for as long as the daemon is there."""
    import visum

    with inside(wire.near):
        client = visum.Client(f"{HERE}:{port}", name="waver", token_file=token, connect_timeout_s=60)
    arm = client.part("arm")
    arm.acquire()
    client.join()
    while True:
        arm.inputs("Desired Angle")[0] = 0.5 * math.sin(0.02 * steps.value)
        arm.write()
        client.advance_ms(10)
        steps.value += 1


def cut(options: argparse.Namespace, folder: Path) -> str:
    import visum

    with Wire() as wire, daemon_at(options, wire, folder, "realtime") as daemon:
        steps = multiprocessing.Value("q")
        with inside(wire.far):
            other = visum.Client(daemon.address, name="other", token_file=folder / "token")
        arm = other.part("arm")

        def state() -> int:
            arm.read()
            return int(arm.outputs("Part State")[0])

        with processes((wave, (wire, daemon.port, folder / "token", steps))):
            await_that(lambda: steps.value > 50, "the arm moves")
            refusal = ""
            try:
                arm.acquire()
            except visum.Error as error:
                refusal = str(error)
            expect("waver" in refusal, "the lease is the first controller's")
            wire.cut()
            found_s = await_that(lambda: state() == CONTROLLER_LOST, "the arm has stopped, as of a lost controller")
            arm.acquire()
            stood = arm.outputs("Actual Angle")[0]
            arm.inputs("Desired Angle")[0] = -0.5
            arm.write()
            other.join()
            other.advance_ms(500)
            expect(abs(arm.outputs("Actual Angle")[0] - stood) < 1e-3, "it stands until it is reset")
        other.close()
    return f"found and stopped {found_s:.1f} s after the cut; the next controller got the lease, and the arm stands until it is reset"


# The wire loses packets --------------------------------------------------------------------------------------------


def control_from(wire: Wire, address: str, ticks: int, answers: Answers, token: Path) -> None:
    with inside(wire.near):
        control(address, ticks, answers, token)


def loss(options: argparse.Namespace, folder: Path) -> str:
    answers = []
    dropped = 0
    for percent in (0.0, options.loss):
        with Wire() as wire, daemon_at(options, wire, folder, "lockstep") as daemon:
            if percent > 0.0:
                wire.lose(percent)
            answers.append(answer_of(control_from, wire, f"{HERE}:{daemon.port}", options.ticks, token=folder / "token"))
            dropped = wire.lost() if percent > 0.0 else 0
    expect(dropped > 0, "the wire lost something")
    expect(answers[0] == answers[1], f"without losses the state's hash is {answers[0][1]:#x}, with them {answers[1][1]:#x}")
    return f"{dropped} packets lost ({options.loss} %) in {options.ticks} ticks: the same bits as without, {answers[0][1]:#018x}"


TRIALS = {"cut": cut, "loss": loss}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", type=Path, default=SOURCE / "build/release/bin")
    parser.add_argument("--ticks", type=int, default=10_000)
    parser.add_argument("--loss", type=float, default=2.0, help="percent of the packets, in each direction")
    parser.add_argument("trial", nargs="*", help=", ".join(TRIALS))
    options = parser.parse_args()
    programs.use_client_of(options.bin)
    return programs.run_all(TRIALS, options.trial, options)


if __name__ == "__main__":
    sys.exit(main())
