#!/usr/bin/env python3
"""The figures of the time shim, by the real programs: how many different results many runs have, what a virtual sleep costs,
what a tick costs in grade L2 against L4, and how fast the serial C program runs at 500 ticks per second.

    lockstep_figures.py [--runs N] [--kinds usleep,poll,...]      VISUM_BIN=build/release/bin

Exit code 1 where a kind has more than one result."""
import argparse
import collections
import json
import os
import pathlib
import platform
import statistics
import subprocess
import sys
import tempfile
import time

from lockstep_exec_test import KINDS, SERIAL_ARM, SHIM, STEPS, WAITS, run
from programs import ARM, Daemon

PYSERIAL = "pyserial"
GATE = "gate"  # grade L1, in real time


def command_of(kind):
    if kind == PYSERIAL:
        return [sys.executable, SHIM / "serial_steps.py", "{bus.arm}", STEPS]
    return [WAITS, "usleep" if kind == GATE else kind, "{bus.arm}", STEPS]


def grade_of(kind):
    return ["--gate", "bus:arm", "--period", 20] if kind == GATE else ["--lockstep"]


def distinct(kind, runs):
    hashes = collections.Counter()
    for _ in range(runs):
        text, figures, _ = run(*command_of(kind), grade=grade_of(kind))
        hashes[text, figures["state_hash"]] += 1
    return len(hashes)


def empty_scene(folder):
    """A world in which nothing is, for what the stepping costs by itself."""
    path = pathlib.Path(folder) / "empty.yaml"
    path.write_text("visum: 1\nname: empty\n")
    return path


def per_sleep(scene, sleeps):
    """Microseconds of wall time for each of many sleeps of one tick."""
    walls = {}
    for count in (0, sleeps):
        body = f"import time\nfor _ in range({count}): time.sleep(0.001)\n"
        walls[count] = min(run(sys.executable, "-c", body, scene=scene, buses=())[1]["wall_seconds"] for _ in range(3))
    return (walls[sleeps] - walls[0]) / sleeps * 1e6


def per_step(scene, steps):
    """The same for explicit steps of the protocol, by a client in Python."""
    body = ("import sys, time, visum\n"
            "with visum.Client(sys.argv[1], name='stepper') as client:\n"
            "    client.join()\n"
            "    begin = time.perf_counter()\n"
            f"    for _ in range({steps}): client.advance_ticks(1)\n"
            f"    print((time.perf_counter() - begin) / {steps} * 1e6)\n")
    with Daemon("--clock", "lockstep", scene=scene) as daemon:
        done = subprocess.run([sys.executable, "-c", body, daemon.connect], capture_output=True, text=True, check=True)
    return float(done.stdout)


def serial_program():
    """The serial C program with a tick of 2 ms: times real time."""
    text = ARM.read_text().replace("visum: 1\n", "visum: 1\ntick_ms: 2\n", 1).replace("../", f"{ARM.parent.parent}/")
    with tempfile.TemporaryDirectory() as folder:
        scene = pathlib.Path(folder) / "arm.yaml"
        scene.write_text(text)
        runs = [run(SERIAL_ARM, "{bus.arm}", scene=scene)[1] for _ in range(3)]
    return statistics.median(one["sim_seconds"] / one["wall_seconds"] for one in runs), runs[0]["sim_seconds"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=100)
    parser.add_argument("--kinds", default=",".join([*KINDS, PYSERIAL, GATE]))
    parser.add_argument("--only-hashes", action="store_true")
    options = parser.parse_args()
    print(f"{platform.processor() or platform.machine()}, {os.cpu_count()} processors, {platform.platform()}")
    worst = 1
    for kind in options.kinds.split(","):
        begin = time.monotonic()
        count = distinct(kind, options.runs)
        worst = max(worst, count)
        print(f"{kind:12} {options.runs} runs, {count} distinct, {(time.monotonic() - begin) / options.runs:.2f} s each", flush=True)
    if not options.only_hashes:
        with tempfile.TemporaryDirectory() as folder:
            scene = empty_scene(folder)
            print(f"an empty world: {per_sleep(scene, 5000):.1f} us for a sleep of one tick (L2, Python)")
            print(f"                {per_step(scene, 5000):.1f} us for a step of one tick (L4, Python)")
        print(f"the arm:        {per_sleep(ARM, 2000):.1f} us for a sleep of one tick (L2, Python)")
        print(f"                {per_step(ARM, 2000):.1f} us for a step of one tick (L4, Python)")
        factor, seconds = serial_program()
        print(f"the serial C program at 500 ticks per second: {seconds:.3f} s, {factor:.1f} x real time")
    return 1 if worst > 1 else 0


if __name__ == "__main__":
    sys.exit(main())
