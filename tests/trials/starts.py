#!/usr/bin/python3
"""Starts and stops the daemon again and again, and looks for what it leaves behind.

    starts.py [--bin FOLDER] [--starts N] [--seed S] [TRIAL...]

  clean     with each clock, with and without a recording, a bus and the page. A client commands, reads and goes, or is still
            there at the end. The daemon is stopped by SIGTERM, SIGINT or a client. Each time the exit code must be right, with
            no more descriptors than before the clients, and afterwards no process, no file, no shared memory is left
  valgrind  the same under valgrind, a twentieth as often: no error, nothing definitely lost (skipped if it is not installed)

Exit code 0: all held; 1: one did not; 77: all were skipped.
"""

from __future__ import annotations

import argparse
import ctypes
import os
import random
import shutil
import signal
import sys
from pathlib import Path

import programs
from programs import SOURCE, Daemon, NotHere, await_that, expect

PR_SET_CHILD_SUBREAPER = 36  # linux/prctl.h
INTERRUPTED = 130  # the exit code after SIGINT
VALGRIND = ("valgrind", "--quiet", "--fair-sched=yes", "--error-exitcode=99", "--leak-check=full", "--errors-for-leak-kinds=definite")
VALGRINDS_SHARE = 20
SLOWLY = ("--speedup", "0.05")  # under valgrind, ticks take longer than they last


def shared_memory() -> set[str]:
    return set(os.listdir("/dev/shm")) | set(Path("/proc/sysvipc/shm").read_text().splitlines())


def words_of(dice: random.Random, folder: Path) -> list[object]:
    words: list[object] = ["--clock", dice.choice(("realtime", "lockstep", "free")), "--dump", dice.choice(("off", folder))]
    words += dice.choice(([], ["--run"]))
    words += dice.choice(([], ["--record", folder / "run.mcap"]))
    words += dice.choice(([], ["--bus", f"arm=pty:{folder}/arm.tty"], ["--bus", "arm=tcp:0"]))
    words += dice.choice((["--http", "off"], ["--http", 0]))
    return words


def visit(daemon: Daemon) -> "visum.Client":
    """A client that commands and reads, and stays connected."""
    import visum

    client = visum.Client(daemon.address, name="visitor", role="admin", connect_timeout_s=60)
    arm = client.part("arm")
    arm.acquire()
    client.join()
    arm.inputs("Desired Angle")[0] = 0.1
    arm.write()
    client.advance_ticks(5)
    client.take_snapshot()
    client.read_world()
    return client


def stop(dice: random.Random, daemon: Daemon, client: "visum.Client") -> None:
    if dice.random() < 0.3:
        client.shutdown()
        wanted = 0
    else:
        number = dice.choice((signal.SIGTERM, signal.SIGINT))
        daemon.process.send_signal(number)
        wanted = INTERRUPTED if number == signal.SIGINT else 0
    code = daemon.process.wait(programs.PATIENCE_S)
    expect(code == wanted, f"it ended with {code}, not {wanted}: {daemon.words}")


def start_once(options: argparse.Namespace, dice: random.Random, folder: Path, before: tuple[str, ...], more: tuple[str, ...]) -> None:
    home, temporary = folder / "home", folder / "temporary"
    home.mkdir()
    temporary.mkdir()
    shared = shared_memory()
    words = [*words_of(dice, home), *more]
    with Daemon(options.bin, *words, before=("env", f"TMPDIR={temporary}", *before)) as daemon:
        base = daemon.descriptors()
        visit(daemon).close()
        await_that(lambda: daemon.descriptors() == base, f"{base} descriptors as before: {daemon.words}")
        client = visit(daemon)
        stop(dice, daemon, client)
        client.close()
    left = {file.name for file in home.iterdir()} - ({"run.mcap"} if "--record" in words else set())
    expect(not left and not any(temporary.iterdir()), f"it left {left or list(temporary.iterdir())} behind: {daemon.words}")
    expect(shared_memory() <= shared, f"it left shared memory behind: {daemon.words}")
    expect(not Path(f"/proc/self/task/{os.getpid()}/children").read_text(), f"it left processes behind: {daemon.words}")
    shutil.rmtree(home)
    temporary.rmdir()


def starts(options: argparse.Namespace, folder: Path, count: int, before: tuple[str, ...] = (), more: tuple[str, ...] = ()) -> str:
    ctypes.CDLL(None).prctl(PR_SET_CHILD_SUBREAPER, 1)  # what a daemon leaves is ours
    dice = random.Random(options.seed)
    for _ in range(count):
        start_once(options, dice, folder, before, more)
    return f"{count} starts and stops, nothing left behind"


def clean(options: argparse.Namespace, folder: Path) -> str:
    return starts(options, folder, options.starts)


def valgrind(options: argparse.Namespace, folder: Path) -> str:
    if not shutil.which("valgrind"):
        raise NotHere("no valgrind")
    return starts(options, folder, max(1, options.starts // VALGRINDS_SHARE), VALGRIND, SLOWLY)


TRIALS = {"clean": clean, "valgrind": valgrind}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", type=Path, default=SOURCE / "build/release/bin")
    parser.add_argument("--starts", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("trial", nargs="*", help=", ".join(TRIALS))
    options = parser.parse_args()
    programs.use_client_of(options.bin)
    return programs.run_all(TRIALS, options.trial, options)


if __name__ == "__main__":
    sys.exit(main())
