#!/usr/bin/python3
"""Runs scenes in lockstep again and again, each time under another load, and compares the bits of the state at the end.

    one_hash.py [--bin FOLDER] [--runs N] [--ticks T] [--seed S] [--scene NAME...] [--engine NAME...]

Loads: none; two processes that burn both processors; floods of connections; observers that ask without end; daemon and
controller stopped (SIGSTOP) at random moments; a recording; another pace. Exit code 0: one hash for each scene and engine.
"""

from __future__ import annotations

import argparse
import math
import multiprocessing
import os
import queue
import random
import sys
import tempfile
import time
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path

import programs
from programs import SCENES, SOURCE, Daemon, Failed, burn, expect, flood, processes, stop_and_go, watch

BURDENS = ("none", "hog", "flood", "observers", "stops", "record", "pace")
PERIOD_TICKS = 10
MOST_STOP_S = 0.3
Answer = tuple[int, int]  # the last tick, and the state's hash
Answers = "multiprocessing.Queue[Answer]"


def control(address: str, ticks: int, answers: Answers, token: Path | None = None) -> None:
    """Sends every part a sine of its own, one period at a time, and reports the result."""
    import visum

    with visum.Client(address, name="controller", token_file=token, connect_timeout_s=60) as client:
        parts = [part for part in map(client.part, client.part_names()) if part.input_ports]
        for part in parts:
            part.acquire()
        client.join(timeout_s=600)
        for step in range(ticks // PERIOD_TICKS):
            for number, part in enumerate(parts):
                for port in part.input_ports[:2]:
                    wanted = port.initial + 0.3 * math.sin(0.04 * step + number + port.index)
                    part.stage(port.index, min(max(wanted, port.minimum), port.maximum))
                part.write()
            client.advance_ticks(PERIOD_TICKS)
        status = client.status()
        answers.put((status.tick, status.state_hash))


def answer_of(controller: Callable[..., None], *words: object, token: Path | None = None, started: Callable[[int], None] = lambda _: None) -> Answer:
    """The result of a controller in a process of its own. `started` is called with the process id."""
    answers: Answers = multiprocessing.Queue()
    process = multiprocessing.Process(target=controller, args=(*words, answers, token), daemon=True)
    process.start()
    assert process.pid
    started(process.pid)
    try:
        while True:
            ended = process.exitcode is not None
            try:
                return answers.get(timeout=1.0)
            except queue.Empty:
                expect(not ended, f"the controller ended with {process.exitcode}")
    finally:
        process.kill()  # it may have been stopped once more
        process.join()


def run(options: argparse.Namespace, scene: str, engine: str, burden: str, seed: int) -> Answer:
    words: list[object] = ["--clock", "lockstep", "--engine", engine, "--http", "off"]
    if burden == "pace":
        words += ["--speedup", random.Random(seed).choice([2, 5, 20])]
    with ExitStack() as stack:
        if burden == "record":
            folder = stack.enter_context(tempfile.TemporaryDirectory())
            words += ["--record", f"{folder}/run.mcap"]
        daemon = stack.enter_context(Daemon(options.bin, *words, scene=SCENES / f"{scene}.yaml"))
        burdens = {"hog": [(burn, ())] * (os.cpu_count() or 2),
                   "flood": [(flood, (daemon.port, seed + i)) for i in range(2)],
                   "observers": [(watch, (daemon.address, seed, 8))]}.get(burden, [])
        stack.enter_context(processes(*burdens))

        def started(controller: int) -> None:
            if burden == "stops":
                stack.enter_context(processes((stop_and_go, ([daemon.pid, controller], seed, MOST_STOP_S))))

        return answer_of(control, daemon.address, options.ticks, started=started)


def compare(options: argparse.Namespace, scene: str, engine: str) -> str:
    """Uses all loads in turn. If there are fewer runs than loads, the seed chooses."""
    dice = random.Random(f"{options.seed} {scene} {engine}")
    first: Answer | None = None
    order = list(BURDENS[1:])
    for number in range(options.runs):
        if number % len(order) == 0:
            dice.shuffle(order)
        burden = "none" if number == 0 else order[number % len(order)]
        seed = dice.randrange(1 << 30)
        answer = run(options, scene, engine, burden, seed)
        first = first or answer
        expect(answer[0] == options.ticks, f"{scene} with {engine}, {burden}: ended at tick {answer[0]}")
        expect(answer == first, f"{scene} with {engine}: run {number} ({burden}, seed {options.seed}) has the hash {answer[1]:#x}, the first {first[1]:#x}")
    assert first
    return f"{scene:14} {engine:8} {options.runs} runs of {options.ticks} ticks: {first[1]:#018x}"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", type=Path, default=SOURCE / "build/dev/bin")
    parser.add_argument("--runs", type=int, default=100, help="of each scene with each engine")
    parser.add_argument("--ticks", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=int(time.time()))
    parser.add_argument("--scene", nargs="+", default=["amtec_arm", "cart", "crawler", "sensors", "two_link"])
    parser.add_argument("--engine", nargs="+", default=["ode", "impulse"])
    options = parser.parse_args()
    options.ticks -= options.ticks % PERIOD_TICKS
    programs.use_client_of(options.bin)
    print(f"seed {options.seed}")
    try:
        for scene in options.scene:
            for engine in options.engine:
                print(compare(options, scene, engine), flush=True)
    except Failed as broken:
        print(f"FAILED: {broken}")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
