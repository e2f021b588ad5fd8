#!/usr/bin/python3
"""Loads the daemon in real time: many clients, a real-time priority, readers that stand still, floods of connections.

    load.py [--bin FOLDER] [--seconds S] [--observers N] TRIAL...

  clients    N observers and a controller at 100 Hz (visum-load, of the preset bench): none is cut off, no command is lost
  priority   the same at 250 Hz, the daemon with SCHED_FIFO 50 on a processor of its own
  stopped    a quarter of the observers is stopped (SIGSTOP): they are closed, the others are served, and they may come back
  flood      connections as fast as possible, and thousands that stay and say nothing: other clients lose nothing, and
             nothing is left behind

Lateness is printed and not judged, because it depends on the machine. Judged are losses, memory, the ticks of `priority`, and that
a reader that stands still is closed within a minute. Exit code 0: all held; 1: one did not; 77: this machine
does not allow it.
"""

from __future__ import annotations

import argparse
import ctypes
import multiprocessing
import os
import resource
import selectors
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path

import programs
from programs import SOURCE, Daemon, NotHere, await_that, counter, expect, processes

STOPPED_KIB = 256  # of memory for each reader that stands still
FLOOD_MIB = 64  # of memory for all of a flood
GROWTH_KIB = 4096  # of memory from the first tenth of `clients` and `priority` to their end
CLOSED_S = 60.0  # for a reader that stands still to be closed; the kernel's buffers have to fill first
LEAST_TICKS = 0.99  # of those that are due, with a real-time priority
MOST_IDLE = 8000
SPARE_DESCRIPTORS = 100
MOST_SESSIONS = 512  # of the protocol (protocol/limits.h)
GROUPS = 4


def visum_load(options: argparse.Namespace, hz: int, before: tuple[str, ...], load_before: tuple[str, ...] = (), least_ticks: float = 0.0) -> str:
    program = options.bin / "visum-load"
    expect(program.exists(), f"there is no {program}: it is built with -D VISUM_BENCHMARKS=ON")
    with Daemon(options.bin, "--clock", "realtime", before=before) as daemon:
        words = [*load_before, program, "--connect", daemon.address, "--observers", options.observers, "--hz", hz, "--seconds", options.seconds]
        done = subprocess.Popen(list(map(str, words)), stdout=subprocess.PIPE, text=True)
        resident = []
        while done.poll() is None:
            time.sleep(1.0)
            resident.append(daemon.resident_kib())
        assert done.stdout
        figures = dict(line.split() for line in done.stdout.read().splitlines() if len(line.split()) == 2)
    expect(done.returncode == 0, f"visum-load ended with {done.returncode}: {figures}")
    warm = resident[len(resident) // 10]
    expect(resident[-1] - warm <= GROWTH_KIB, f"memory grew by {resident[-1] - warm} KiB")
    ticks = float(figures["ticks"])
    expect(ticks >= least_ticks * 1000 * options.seconds, f"{ticks:.0f} ticks in {options.seconds} s")
    names = ("disconnects", "commands", "commands_late", "commands_lost", "samples", "ticks", "overruns", "lateness_p50_us", "lateness_p99.9_us", "lateness_max_us")
    return f"{options.observers} observers at {hz} Hz for {options.seconds} s: " + ", ".join(
        f"{name} {figures[name]}" for name in names) + f"; memory {warm} KiB, at the end {resident[-1]} KiB"


def clients(options: argparse.Namespace, _: Path) -> str:
    return visum_load(options, 100, ())


def priority(options: argparse.Namespace, _: Path) -> str:
    if subprocess.run(["chrt", "-f", "50", "true"], capture_output=True).returncode != 0:
        raise NotHere("no SCHED_FIFO for this user")
    others = f"1-{(os.cpu_count() or 2) - 1}"
    return visum_load(options, 250, ("taskset", "-c", "0", "chrt", "-f", "50"), ("taskset", "-c", others), LEAST_TICKS)


# Readers that stand still ---------------------------------------------------------------------------------


def observe(address: str, count: int, every_n_ticks: int, received: "ctypes.Array[ctypes.c_longlong]", lost: ctypes.c_longlong, back: ctypes.c_longlong) -> None:
    """Runs `count` subscribers. One that is cut off comes back. Counts the bytes that each got."""
    import visum
    from visum.connection import pb

    selector = selectors.DefaultSelector()

    def subscribe(number: int) -> None:
        client = visum.Client(address, name=f"observer {number}", role="observer", connect_timeout_s=60)
        client.connection.request(subscribe=pb.Subscribe(part="arm", every_n_ticks=every_n_ticks))
        wire = client.connection._socket
        wire.setblocking(False)
        selector.register(wire, selectors.EVENT_READ, (number, client))

    for number in range(count):
        subscribe(number)
    while True:
        for key, _ in selector.select(1.0):
            number, client = key.data
            try:
                data = key.fileobj.recv(1 << 16)
            except BlockingIOError:
                continue
            except OSError:
                data = b""
            received[number] += len(data)
            if data:
                continue
            lost.value += 1
            selector.unregister(key.fileobj)
            client.close()
            subscribe(number)
            back.value += 1


def stopped(options: argparse.Namespace, _: Path) -> str:
    import visum

    each = options.observers // GROUPS
    with Daemon(options.bin, "--clock", "realtime", "--run") as daemon:
        counts = [(multiprocessing.Array("q", each, lock=False), counter(), counter()) for _ in range(GROUPS)]
        # The last group wants every tick, so that its buffers are full soon.
        burdens = [(observe, (daemon.address, each, 1 if group == GROUPS - 1 else 10, *counts[group])) for group in range(GROUPS)]
        with visum.Client(daemon.address, name="checker", role="observer") as checker, processes(*burdens) as groups:
            await_that(lambda: all(all(received) for received, _, _ in counts), "everybody is served")
            sessions, before = checker.status().sessions, daemon.resident_kib()
            pid = groups[-1].pid
            assert pid
            os.kill(pid, signal.SIGSTOP)
            closed_s = await_that(lambda: checker.status().sessions == sessions - each, "those that stand still are closed")
            expect(closed_s <= CLOSED_S, f"closed after {closed_s:.0f} s")
            marks = [list(received) for received, _, _ in counts[:-1]]
            await_that(lambda: all(now > then for mark, (received, _, _) in zip(marks, counts) for now, then in zip(received, mark)), "everybody else is served")
            time.sleep(max(0.0, options.seconds - closed_s))
            growth = daemon.resident_kib() - before
            expect(growth <= STOPPED_KIB * each, f"memory grew by {growth} KiB for {each} that stand still")
            os.kill(pid, signal.SIGCONT)
            await_that(lambda: counts[-1][2].value == each, "they come back")
            cut_off = sum(lost.value for _, lost, _ in counts[:-1])
            expect(cut_off == 0, f"{cut_off} of the others were cut off")
            status = checker.status()
    return (f"{each} of {GROUPS * each} observers stopped: the last was closed {closed_s:.1f} s later, memory {growth:+d} KiB, all came back, "
            f"of the others none was cut off; lateness p99.9 {status.lateness_p999_ns / 1e3:.0f} us")


# Floods ---------------------------------------------------------------------------------------------------


def connect_and_close(port: int, count: ctypes.c_longlong) -> None:
    while True:
        with socket.socket() as stranger:
            stranger.setblocking(False)
            stranger.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, b"\1\0\0\0\0\0\0\0")
            stranger.connect_ex(("127.0.0.1", port))
        count.value += 1


def open_and_stay(port: int, most: int, count: ctypes.c_longlong) -> None:
    there = []
    for _ in range(most):
        stranger = socket.socket()
        stranger.setblocking(False)
        stranger.connect_ex(("127.0.0.1", port))
        there.append(stranger)
        count.value += 1
    signal.pause()


def flood(options: argparse.Namespace, _: Path) -> str:
    import visum

    silent = min(MOST_IDLE, resource.getrlimit(resource.RLIMIT_NOFILE)[0] - SPARE_DESCRIPTORS)
    with Daemon(options.bin, "--clock", "realtime", "--run") as daemon:
        counts = [counter() for _ in range(3)]
        with visum.Client(daemon.address, name="good") as good:
            base, before, peak = daemon.descriptors(), daemon.resident_kib(), 0
            arm = good.part("arm")
            arm.acquire()
            good.join()
            steps, most = 0, 0
            with ExitStack() as floods:
                floods.enter_context(processes((open_and_stay, (daemon.port, silent, counts[2]))))
                await_that(lambda: counts[2].value == silent, "all are open")
                began = time.monotonic()
                while time.monotonic() < began + options.seconds:
                    # Half of the time there are silent clients only: a flood would push them out of the
                    # kernel's queue.
                    if not any(count.value for count in counts[:2]) and time.monotonic() > began + options.seconds / 2:
                        floods.enter_context(processes(*((connect_and_close, (daemon.port, count)) for count in counts[:2])))
                    wanted = 1e-3 * (steps % 100)
                    arm.inputs("Desired Angle")[0] = wanted
                    arm.write()
                    good.advance_ms(10)
                    if arm.inputs("Desired Angle")[0] != wanted:
                        good.advance_ms(10)  # sent late in its period, it is in force in the next
                    expect(arm.inputs("Desired Angle")[0] == wanted, f"command {steps} of the good client was lost")
                    steps += 1
                    if steps % 10 == 0:
                        most = max(most, daemon.descriptors() - base)
                        peak = max(peak, daemon.resident_kib() - before)
            expect(steps > 0 and most <= MOST_SESSIONS, f"{most} connections at once")
            expect(peak < FLOOD_MIB << 10, f"memory grew by {peak} KiB")
            left_s = await_that(lambda: daemon.descriptors() <= base, f"{base} descriptors as before")
            arm.release()
    rate = (counts[0].value + counts[1].value) / (options.seconds / 2)
    return (f"{rate:.0f} connections a second for {options.seconds / 2} s and {counts[2].value} that stayed: {steps} commands of the good client, none lost; "
            f"at most {most} connections held at once, memory {peak:+d} KiB, all descriptors back after {left_s:.1f} s")


TRIALS: dict[str, Callable[[argparse.Namespace, Path], str]] = {"clients": clients, "priority": priority, "stopped": stopped, "flood": flood}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", type=Path, default=SOURCE / "build/release/bin")
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--observers", type=int, default=255)
    parser.add_argument("trial", nargs="+", help=", ".join(TRIALS))
    options = parser.parse_args()
    programs.use_client_of(options.bin)
    most = resource.getrlimit(resource.RLIMIT_NOFILE)[1]
    resource.setrlimit(resource.RLIMIT_NOFILE, (min(most, MOST_IDLE + SPARE_DESCRIPTORS), most))
    return programs.run_all(TRIALS, options.trial, options)


if __name__ == "__main__":
    sys.exit(main())
