#!/usr/bin/python3
"""Soaks the daemon: for the given time, clients come, work, go and break off, while its memory, descriptors, threads and log
are watched. Short soaks are recorded, and replayed at the end.

    soak.py [--minutes M] [--clients N] [--bin FOLDER] [--json]

Exit code 0: all is well; 1: something grew, was left behind, or was logged without a cause.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import os
import random
import re
import signal
import socket
import statistics
import subprocess
import sys
import tempfile
import time
import urllib.request
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]
MOST_SLOPE_KIB_PER_H = 100.0  # of memory, where the soak is long enough to tell
LONG_ENOUGH_S = 1800.0
MOST_GROWTH_KIB = 1024.0  # of shorter ones, between their second and their last quarter
RECORDED_S = 300.0  # longer recordings would fill the disk
QUEUE_KIB = 32 * 1024.0  # the recorder's, whose pages come into memory as they are used for the first time
# Some of the crowd may only look, and try to command all the same.
# An observer that is refused, and a machine that is too busy for the world.
EXPLAINED = re.compile("this needs the role controller, the session has observer$|the world (falls behind|keeps up with) the wall clock")
PROCESSES = 4
MOST_THOUGHT_S = 0.03  # between two deeds of a process' clients


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--minutes", type=float, default=60.0)
    parser.add_argument("--clients", type=int, default=32)
    parser.add_argument("--bin", type=Path, default=SOURCE / "build/dev/bin")
    parser.add_argument("--json", action="store_true", help="the figures as one line of JSON")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        soak = Soak(options.bin, Path(folder), 60.0 * options.minutes, options.clients)
        figures, faults = soak.run()
    print(json.dumps(figures) if options.json else "\n".join(f"{name:28} {value}" for name, value in figures.items()))
    for fault in faults:
        print(f"FAILED: {fault}")
    return 1 if faults else 0


class Soak:
    def __init__(self, programs: Path, folder: Path, seconds: float, clients: int):
        self.programs, self.folder, self.seconds, self.clients = programs, folder, seconds, clients
        self.recording = folder / "soak.mcap" if seconds <= RECORDED_S else None

    def run(self) -> tuple[dict[str, object], list[str]]:
        log = self.folder / "log"
        words = [self.programs / "visumd", SOURCE / "models/scenes/amtec_arm.yaml", "--run", "--port", "0", "--json", "-v", "1"]
        if self.recording:
            words += ["--record", self.recording]
        with log.open("w") as errors, subprocess.Popen(words, stdout=subprocess.PIPE, stderr=errors, text=True) as daemon:
            try:
                return self.watch(daemon, json.loads(daemon.stdout.readline()), log)
            finally:
                if daemon.poll() is None:
                    daemon.kill()

    def watch(self, daemon: subprocess.Popen[str], ready: dict[str, int], log: Path) -> tuple[dict[str, object], list[str]]:
        ask_page(ready["http"])  # what is made once, for the first who asks, is no growth
        before = at_rest(daemon.pid)
        until = time.monotonic() + self.seconds
        counts = multiprocessing.Array("q", PROCESSES)
        crowd = [multiprocessing.Process(target=churn, args=(self.programs.parent / "python", ready["port"], self.clients // PROCESSES, until, seed, counts))
                 for seed in range(PROCESSES)]
        for process in crowd:
            process.start()
        memory: list[tuple[float, float]] = []
        while (now := time.monotonic()) < until and daemon.poll() is None:
            memory.append((now, resident_kib(daemon.pid)))
            ask_page(ready["http"])
            time.sleep(min(5.0, self.seconds / 60))
        for process in crowd:
            process.join(60)
        figures: dict[str, object] = {"seconds": self.seconds, "clients": self.clients, "sessions": sum(counts)}
        faults = [f"a client of the crowd ended with {process.exitcode}" for process in crowd if process.exitcode != 0]
        if daemon.poll() is not None:
            return figures, [*faults, f"visumd ended with {daemon.returncode}: {log.read_text()}"]
        faults += judge_memory(memory, self.seconds, QUEUE_KIB if self.recording else 0.0, figures)
        after = settled(daemon.pid, before)
        figures |= {"descriptors": f"{before.descriptors} before, {after.descriptors} after", "threads": f"{before.threads} before, {after.threads} after"}
        if after != before:
            faults.append(f"left behind: {after} after, {before} before")
        daemon.send_signal(signal.SIGTERM)
        if daemon.wait(30) != 0:
            faults.append(f"visumd ended with {daemon.returncode}")
        lines = log.read_text().splitlines()
        unexplained = [line for line in lines if not EXPLAINED.search(line)]
        figures["lines of the log"] = f"{len(lines)}, {len(unexplained)} of them without a cause"
        faults += [f"the log says: {line}" for line in unexplained]
        return figures, faults + self.replay(figures)

    def replay(self, figures: dict[str, object]) -> list[str]:
        if not self.recording:
            return []
        done = subprocess.run([self.programs / "visum", "replay", self.recording, "--json"], capture_output=True, text=True, timeout=1800)
        figures["replay"] = (done.stdout.strip().splitlines() or [""])[-1]
        return [] if done.returncode == 0 else [f"the recording does not replay: {done.stdout}{done.stderr}"]


class Held:
    """The resources that a process holds and must give back."""

    def __init__(self, descriptors: int, threads: int):
        self.descriptors, self.threads = descriptors, threads

    @classmethod
    def of(cls, pid: int) -> Held:
        return cls(len(os.listdir(f"/proc/{pid}/fd")), len(os.listdir(f"/proc/{pid}/task")))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Held) and vars(self) == vars(other)

    def __repr__(self) -> str:
        return f"{self.descriptors} descriptors and {self.threads} threads"


def at_rest(pid: int) -> Held:
    """The least within two seconds, because sessions that have just ended are still being closed."""
    seen = []
    for _ in range(10):
        time.sleep(0.2)
        seen.append(Held.of(pid))
    return min(seen, key=lambda held: held.descriptors)


def settled(pid: int, expected: Held) -> Held:
    """Waits until the last sessions are closed. What is there after half a minute was left behind."""
    until = time.monotonic() + 30.0
    while (held := Held.of(pid)) != expected and time.monotonic() < until:
        time.sleep(0.2)
    return held


def resident_kib(pid: int) -> float:
    return int(Path(f"/proc/{pid}/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1024


def judge_memory(memory: list[tuple[float, float]], seconds: float, foreseen_kib: float, figures: dict[str, object]) -> list[str]:
    quarter = max(1, len(memory) // 4)
    second, last = ([kib for _, kib in part] for part in (memory[quarter:2 * quarter], memory[-quarter:]))
    growth = statistics.median(last) - statistics.median(second)
    figures |= {"memory": f"{statistics.median(last):.0f} KiB", "growth": f"{growth:.0f} KiB"}
    if seconds < LONG_ENOUGH_S:
        return [f"memory grew by {growth:.0f} KiB"] if growth > MOST_GROWTH_KIB + foreseen_kib else []
    warm = memory[quarter:]
    slope = 3600.0 * statistics.linear_regression([t for t, _ in warm], [kib for _, kib in warm]).slope
    figures["slope"] = f"{slope:.1f} KiB/h"
    return [f"memory grows by {slope:.1f} KiB/h"] if slope > MOST_SLOPE_KIB_PER_H else []


def ask_page(port: int) -> None:
    for path in ("", "metrics", "healthz"):
        with urllib.request.urlopen(f"http://127.0.0.1:{port}/{path}", timeout=30) as answer:
            answer.read()


def churn(python: Path, port: int, clients: int, until: float, seed: int, counts: "multiprocessing.Array[int]") -> None:
    """A group of clients, one of which does something, comes or goes at a time."""
    sys.path.insert(0, str(python))
    import visum  # of this build

    dice = random.Random(seed)
    there: list[visum.Client | socket.socket] = []
    while time.monotonic() < until:
        if len(there) < clients:
            there.append(arrive(visum, port, dice, seed, counts))
        one = dice.choice(there)
        time.sleep(dice.uniform(0.0, MOST_THOUGHT_S))
        try:
            stays = isinstance(one, visum.Client) and work(one, dice)
        except visum.Error:
            stays = True  # somebody else has the lease
        if not stays:
            there.remove(one)
            leave(one, dice)
    for one in there:
        one.close()


def arrive(visum, port: int, dice: random.Random, seed: int, counts):
    counts[seed] += 1
    if dice.random() < 0.1:  # not one of ours: says something, or nothing
        stranger = socket.create_connection(("127.0.0.1", port), timeout=30)
        stranger.sendall(dice.randbytes(dice.randrange(64)))
        return stranger
    return visum.Client(f"127.0.0.1:{port}", name=f"soak {seed}", role=dice.choice(["controller", "observer"]))


def work(client, dice: random.Random) -> bool:
    """Returns False if the client has had enough."""
    arm = client.part("arm")
    if dice.random() < 0.3:
        client.status()
        client.read_world()
    if dice.random() < 0.5:
        with arm.lease():
            desired = arm.inputs("Desired Angle")
            for i in range(len(desired)):
                desired[i] = dice.uniform(-0.2, 0.2)
            arm.write()
    return dice.random() > 0.2


def leave(one, dice: random.Random) -> None:
    if isinstance(one, socket.socket) and dice.random() < 0.5:  # a reset instead of an end
        one.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, b"\1\0\0\0\0\0\0\0")
    one.close()


if __name__ == "__main__":
    sys.exit(main())
