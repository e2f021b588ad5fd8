#!/usr/bin/python3
"""Runs the daemon against the limits of a container: memory, processes, descriptors, disk. It must refuse with a reason and go
on, or end with a reason. What was recorded until then must be readable.

    walls.py [--bin FOLDER] [WALL...]

Needs a cgroup (version 1 or 2) for memory and processes, and a mount namespace for the disk: what this machine does not allow is
skipped with a message. Exit code 0: all held; 1: one did not; 77: all were skipped.
"""

from __future__ import annotations

import argparse
import os
import resource
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import programs
from programs import ARM, PATIENCE_S, SOURCE, Daemon, NotHere, await_that, expect, processes, replay, watch

MEMORY_MIB = 128
SPARE_BYTES = 4 << 20  # that a daemon may take yet, once it runs
MOST_BODIES = 5000
PROCESSES = 32
DESCRIPTORS = 64
DISK_MIB = 4


@contextmanager
def cgroup(controller: str, **limits: int) -> Iterator[Path]:
    """A group of that controller, with limits named as in version 2. A process is in it if its id is in cgroup.procs."""
    root = Path("/sys/fs/cgroup")
    first = root / controller if (root / controller).is_dir() else root
    group = first / f"visum-walls-{os.getpid()}"
    try:
        group.mkdir()
    except OSError as error:
        raise NotHere(f"no cgroup: {error}") from error
    try:
        for name, limit in limits.items():
            in_group(group, name.replace("_", ".")).write_text(str(limit))
        yield group
    finally:
        await_that(lambda: not (group / "cgroup.procs").read_text(), "the group is empty")
        group.rmdir()


def in_group(group: Path, name: str) -> Path:
    """A file of the group, by its name in version 2."""
    old = {"memory.max": "memory.limit_in_bytes", "memory.events": "memory.oom_control"}
    for file in (group / name, group / old.get(name, name)):
        if file.exists():
            return file
    raise NotHere(f"the cgroup has no {name}")


def inside(group: Path) -> tuple[str, ...]:
    """The command that starts a program in the group."""
    return ("sh", "-c", 'echo $$ > "$0/cgroup.procs" && exec "$@"', str(group))


def goes_on(daemon: Daemon) -> None:
    """Checks that new clients are served and that the world runs."""
    import visum

    with visum.Client(daemon.address, name="checker", role="observer", connect_timeout_s=60) as client:
        tick = client.status().tick
        await_that(lambda: client.status().tick > tick, "the world runs")


def memory(options: argparse.Namespace, folder: Path) -> str:
    import visum

    file = folder / "run.mcap"
    with cgroup("memory", memory_max=MEMORY_MIB << 20) as group:
        with Daemon(options.bin, "--run", "--record", file, before=inside(group)) as daemon:
            with processes(*((watch, (daemon.address, seed, 8)) for seed in range(4))):
                admin = visum.Client(daemon.address, name="hoarder", role="admin")
                for _ in range(100):
                    admin.take_snapshot()
                refused = 0
                for number in range(300):
                    shape = "{mesh: nothing.stl}" if number % 3 == 0 else "{sphere: 0.01}"
                    try:
                        admin.add_body(f"{{name: body_{number}, shape: {shape}, mass: 0.1, pose: {{xyz: [{number}, 5, 1]}}}}")
                    except visum.Error:
                        refused += 1
                expect(refused > 0, "bodies of a file that is not there are refused")
                goes_on(daemon)
            peak = daemon.resident_kib()
    again = replay(options.bin, file)
    return f"{MEMORY_MIB} MiB: 32 observers, 300 bodies, 100 snapshots, {peak // 1024} MiB resident; {again['ticks']} ticks replayed"


def body(number: int) -> str:
    return f"{{name: body_{number}, shapes: [{{sphere: 0.01}}], mass: 0.1, pose: {{xyz: [{number}, 5, 1]}}}}"


def hoard(daemon: Daemon) -> tuple[int, int]:
    """Adds bodies until the daemon is gone. Returns how many, and a tick of the last second."""
    import visum

    admin = visum.Client(daemon.address, name="hoarder", role="admin")
    bodies = tick = 0
    try:
        while bodies < MOST_BODIES:
            admin.add_body(body(bodies))
            bodies += 1
            tick = admin.status().tick
    except visum.Error:
        daemon.process.wait(PATIENCE_S)
    expect(daemon.process.returncode is not None, f"{bodies} bodies are too much")
    return bodies, tick


def killed_for_memory(options: argparse.Namespace, folder: Path) -> str:
    file = folder / "run.mcap"
    with cgroup("memory", memory_max=MEMORY_MIB << 20) as group:
        with Daemon(options.bin, "--clock", "free", "--run", "--record", file, before=inside(group)) as daemon:
            goes_on(daemon)
            in_group(group, "memory.max").write_text(str((daemon.resident_kib() << 10) + SPARE_BYTES))
            bodies, tick = hoard(daemon)
            expect(daemon.process.returncode == -signal.SIGKILL, f"the kernel killed it, not: {daemon.process.returncode}")
        expect("oom_kill 1" in in_group(group, "memory.events").read_text(), "for want of memory")
    again = replay(options.bin, file)
    expect(again["damage"] != "" and int(str(again["ticks"])) > 0, f"the recording was cut, and a part of the run is in it: {again}")
    return f"killed with {bodies} bodies, tick {tick} the last that was seen: {again['ticks']} ticks replayed, and the rest is told to be missing"


def no_more_memory(options: argparse.Namespace, folder: Path) -> str:
    import visum

    file, log = folder / "run.mcap", folder / "log"
    with Daemon(options.bin, "--clock", "realtime", "--run", "--record", file, log=log) as daemon:
        goes_on(daemon)  # with all threads that it starts
        admin = visum.Client(daemon.address, name="hoarder", role="admin")
        admin.add_body(body(0))  # starts the thread that reads bodies
        limit = int(Path(f"/proc/{daemon.pid}/statm").read_text().split()[0]) * os.sysconf("SC_PAGE_SIZE") + SPARE_BYTES
        all_of_it = resource.prlimit(daemon.pid, resource.RLIMIT_AS)
        resource.prlimit(daemon.pid, resource.RLIMIT_AS, (limit, all_of_it[1]))
        refused, bodies = 0, 1
        while refused < 20 and bodies < MOST_BODIES:
            try:
                admin.add_body(f"{{name: body_{bodies}, fixed: true, shapes: [{'{sphere: 0.01, collides: false}, ' * 1000}]}}")
                bodies += 1
            except visum.Error as error:
                expect("memory" in str(error), f"it is refused for want of memory: {error}")
                refused += 1
        expect(refused == 20, f"{bodies} bodies are too much")
        tick = admin.status().tick
        await_that(lambda: admin.status().tick > tick, "the ticks go on while there is no memory")
        resource.prlimit(daemon.pid, resource.RLIMIT_AS, all_of_it)  # or a new client may be refused, too
        goes_on(daemon)
        admin.add_body(body(bodies))
        admin.close()
    said, code = log.read_text(), daemon.process.returncode
    # A recorder may be the one that wants more while there is none.
    cut_short = "ends early: not enough memory" in said
    expect((code != 0) == cut_short, f"it ended with {code}: {said}")
    again = replay(options.bin, file)
    expect((again["damage"] != "") == cut_short and int(str(again["ticks"])) > 0, f"the recording is whole, or the log tells: {again}; {said}")
    return f"with {bodies} bodies the system gives no more: {refused} are refused, and all of the {again['ticks']} ticks replayed"


def too_little_memory(options: argparse.Namespace, folder: Path) -> str:
    words = [options.bin / "visumd", ARM, "--port", "0", "--http", "off", "--run", "--iterations", "10"]
    codes = set()
    for mib in (40, 60, 80, 100, 120, 140):
        limit = mib << 20
        done = subprocess.run(words, capture_output=True, text=True, timeout=PATIENCE_S,
                              preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (limit, limit)))
        codes.add(done.returncode)
        expect(done.returncode >= 0, f"with {mib} MiB of addresses it died of signal {-done.returncode}: {done.stderr}")
        expect(done.returncode == 0 or len(done.stderr) > 0, f"with {mib} MiB of addresses it said nothing")
    return f"40 to 140 MiB of addresses: it ends with a reason or runs (exit codes {sorted(codes)})"


def threads(options: argparse.Namespace, folder: Path) -> str:
    words = [options.bin / "visumd", ARM, "--port", "0", "--http", "off", "--clock", "realtime", "--run", "--iterations", "50"]
    needed = 0
    with cgroup("pids", pids_max=PROCESSES) as group:
        with Daemon(options.bin, "--run", "--record", folder / "run.mcap", before=inside(group)) as daemon:
            goes_on(daemon)
    replay(options.bin, folder / "run.mcap")
    for most in range(1, PROCESSES):
        with cgroup("pids", pids_max=most) as group:
            done = subprocess.run([*inside(group), *words, "--record", folder / "few.mcap"], capture_output=True, text=True, timeout=PATIENCE_S)
        if done.returncode == 0:
            needed = most
            break
        expect("cannot start a thread" in done.stderr, f"with {most} threads it ended with {done.returncode}: {done.stderr}")
    expect(needed > 1, "one thread is not enough, 31 are")
    return f"{PROCESSES} processes are enough; with fewer than {needed} it says why it does not start"


def descriptors(options: argparse.Namespace, folder: Path) -> str:
    import visum

    before = ("sh", "-c", f'ulimit -n {DESCRIPTORS} && exec "$@"', "sh")
    with Daemon(options.bin, "--run", before=before) as daemon:
        base = daemon.descriptors()
        good = visum.Client(daemon.address, name="good")
        crowd = []
        while daemon.descriptors() < DESCRIPTORS:
            crowd.append(programs.connect(daemon.port))
        # The kernel takes these connections; the daemon cannot yet.
        more = [programs.connect(daemon.port) for _ in range(20)]
        with good.part("arm").lease():
            good.join()
            good.advance_ticks(100)
        for stranger in crowd + more:
            stranger.close()
        goes_on(daemon)
        good.close()
        await_that(lambda: daemon.descriptors() <= base, f"{base} descriptors as before")
    return f"{DESCRIPTORS} descriptors, all taken: who is there is served, and afterwards whoever comes"


def disk(options: argparse.Namespace, folder: Path) -> str:
    small = folder / "small"
    small.mkdir()
    done = subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={DISK_MIB}m", "tmpfs", small], capture_output=True, text=True)
    if done.returncode != 0:
        raise NotHere(f"no mount: {done.stderr.strip()}")
    try:
        return fill(options, folder, small / "run.mcap", (), f"{DISK_MIB} MiB of disk")
    finally:
        subprocess.run(["umount", small], check=True)


def file_size(options: argparse.Namespace, folder: Path) -> str:
    before = ("sh", "-c", 'ulimit -f 4000 && exec "$@"', "sh")  # blocks of 512 or 1024 bytes
    return fill(options, folder, folder / "run.mcap", before, "a limited size of files")


def fill(options: argparse.Namespace, folder: Path, file: Path, before: tuple[str, ...], wall: str) -> str:
    log = folder / "log"
    with Daemon(options.bin, "--clock", "free", "--run", "--record", file, before=before, log=log) as daemon:
        await_that(lambda: "recording" in log.read_text(), "it says that the recording has ended")
        goes_on(daemon)
    said = log.read_text().strip().splitlines()[0]
    again = replay(options.bin, file)
    expect(int(str(again["ticks"])) > 0, "a part of the run is in the recording")
    return f"{wall}: \"{said}\"; the world goes on, {again['ticks']} ticks replayed"


WALLS = {"memory": memory, "killed-for-memory": killed_for_memory, "no-more-memory": no_more_memory, "too-little-memory": too_little_memory,
         "threads": threads, "descriptors": descriptors, "disk": disk, "file-size": file_size}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", type=Path, default=SOURCE / "build/dev/bin")
    parser.add_argument("wall", nargs="*", help=", ".join(WALLS))
    options = parser.parse_args()
    # In a mount namespace of its own, so that no mount is left behind.
    if os.environ.get("VISUM_UNSHARED") != "yes":
        able = subprocess.run(["unshare", "--mount", "true"], capture_output=True).returncode == 0
        if able:
            os.execvpe("unshare", ["unshare", "--mount", "--propagation", "private", sys.executable, *sys.argv], {**os.environ, "VISUM_UNSHARED": "yes"})
    programs.use_client_of(options.bin)
    return programs.run_all(WALLS, options.wall, options)


if __name__ == "__main__":
    sys.exit(main())
