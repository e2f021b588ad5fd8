#!/usr/bin/python3
"""Runs programs that were written for real modules, longer than the tests do, and prints how fast they are.

    can.py [--bin FOLDER] [--tests FOLDER] [--frames N] [--runs N] [TRIAL...]

Trials: `realtime` and `lockstep`: a program with three CAN handles, of which it reads one, sends requests until N frames were on
the bus, and a twentieth of them, with each vendor's library. A frame shall take no longer in the long run; on a busy machine only
the processor's time says so, which in `realtime` leaves the server's out. `resend`, `scan` and `serve`: the habits
of tests/clients/lockstep_exec_test.py, with their hashes. Exit code 0: all did as they should; 1: one did not.
"""

from __future__ import annotations

import argparse
import json
import resource
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path


from programs import ARM, SOURCE, Daemon, expect, run_all

LIBRARIES = (("esd", "visum-test-ntcan"), ("peak", "visum-test-pcan"))
SHORT = 20  # times fewer frames in a short run
PATIENCE_S = 3600.0
TOO_SLOW = 6  # the exit code
Said = tuple[str, dict[str, object]]


def execute(options: argparse.Namespace, *words: object, may_be_slow: bool = False) -> Said:
    """Runs a program. Returns what it printed, and the figures of `visum exec`. `may_be_slow`: as a host for real time."""
    done = subprocess.run([str(word) for word in (options.bin / "visum", "exec", "--json", "--timeout", PATIENCE_S, *words)], capture_output=True, text=True, timeout=PATIENCE_S)
    expect(done.returncode == 0 or may_be_slow and done.returncode == TOO_SLOW, f"visum exec ends with {done.returncode}: {done.stderr[-500:]}")
    *printed, figures = done.stdout.splitlines()
    return "\n".join(printed), json.loads(figures)


def processor_s() -> float:
    """Seconds of the processor that all programs took that were started here and have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def frames_with(options: argparse.Namespace, run: Callable[[str, Path, int], Said]) -> str:
    said = []
    for vendor, name in LIBRARIES:
        took: list[tuple[float, float]] = []
        for frames in (options.frames // SHORT, options.frames):
            before = processor_s()
            text, figures = run(vendor, options.tests / name, frames // 2)
            expect(text == "all answered", f"{vendor}: {text}")
            took.append((1e6 * float(figures["wall_seconds"]) / frames, 1e6 * (processor_s() - before) / frames))
        said.append(f"{vendor}: {took[0][0]:.0f} us a frame in {options.frames // SHORT} frames ({took[0][1]:.0f} us of the processor), "
                    f"{took[1][0]:.0f} us in {options.frames} ({took[1][1]:.0f} us)")
    return "; ".join(said)


def in_real_time(options: argparse.Namespace, _: Path) -> str:
    with Daemon(options.bin, "--clock", "realtime", "--run", "--bus", "arm=tcp:0") as daemon:
        return frames_with(options, lambda vendor, program, requests: execute(
            options, "--connect", daemon.address, "--can", vendor, "--", program, requests, may_be_slow=True))


def in_lockstep(options: argparse.Namespace, _: Path) -> str:
    return frames_with(options, lambda vendor, program, requests: execute(
        options, "--scene", ARM, "--lockstep", "--can", vendor, "--", program, requests))


def habit(*words: object) -> Callable[[argparse.Namespace, Path], str]:
    def trial(options: argparse.Namespace, _: Path) -> str:
        habits = options.tests / "visum-test-habits"
        runs = [execute(options, "--scene", ARM, "--lockstep", "--bus", "arm=pty", "--", habits, words[0], "{bus.arm}", *words[1:])
                for _ in range(options.runs)]
        expect(len({(text, figures["state_hash"]) for text, figures in runs}) == 1, f"more than one result in {options.runs} runs")
        text, figures = runs[0]
        walls = sorted(float(one["wall_seconds"]) for _, one in runs)
        median = walls[len(walls) // 2]
        return f"{text}; {options.runs} runs, one hash {figures['state_hash']}; {median:.2f} s, {float(figures['sim_seconds']) / median:.1f} times real time"

    return trial


TRIALS = {
    "realtime": in_real_time,
    "lockstep": in_lockstep,
    "resend": habit("resend", 60),
    "scan": habit("scan"),
    "serve": habit("serve", 700),
}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", type=Path, default=SOURCE / "build/release/bin")
    parser.add_argument("--tests", type=Path, help="the folder of the tests' programs; as --bin")
    parser.add_argument("--frames", type=int, default=1_000_000)
    parser.add_argument("--runs", type=int, default=20)
    parser.add_argument("trial", nargs="*", help=", ".join(TRIALS))
    options = parser.parse_args()
    options.tests = options.tests or options.bin
    return run_all(TRIALS, options.trial, options)


if __name__ == "__main__":
    sys.exit(main())
