"""The arm as it can be served: by visumd, by visum-hwpart in front of modules on a bus, by a mirror of two arms."""

from __future__ import annotations

import json
import signal
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

from programs import BIN, MODELS

import visum

ARM = MODELS / "scenes" / "amtec_arm.yaml"
# A busy machine is no reason to stop the arm here.
BUSY = ("--session-silence-ms", "0", "--command-age-ms", "0")
SPEED = "1"  # of all clocks, in simulated seconds per second
PATIENCE_S = 60  # a guard against hanging for ever, not a measure


class Program:
    """A server program for the length of a `with`, once it is ready."""

    def __init__(self, name: str, *arguments: object) -> None:
        self.command = [str(BIN / name), *map(str, arguments), "--port", "0", "--json", "-v", "0"]

    def __enter__(self) -> Program:
        self.process = subprocess.Popen(self.command, stdout=subprocess.PIPE, text=True)
        assert self.process.stdout is not None
        line = self.process.stdout.readline()
        assert line, f"{self.command[0]} ended with {self.process.wait(PATIENCE_S)}"
        self.ready = json.loads(line)
        self.address = f"127.0.0.1:{self.ready['port']}"
        return self

    def __exit__(self, *_: object) -> None:
        self.end()

    def end(self, how: int = signal.SIGTERM) -> int:
        if self.process.poll() is None:
            self.process.send_signal(how)
        code = self.process.wait(PATIENCE_S)
        assert self.process.stdout is not None
        self.process.stdout.close()
        return code


def virtual_arm(*options: object, scene: Path = ARM) -> Program:
    return Program("visumd", scene, "--run", "--speedup", SPEED, *BUSY, *options)


def real_arm(bus: str, *options: object, scene: Path = ARM) -> Program:
    return Program("visum-hwpart", scene, "--bus", bus, "--speedup", SPEED, "--execution-enable", "--answer-ms", "2000", *options)


class Served:
    """The server that shows the arm to a controller, and the worlds behind it."""

    def __init__(self, address: str, worlds: list[Program]) -> None:
        self.address = address
        self.worlds = worlds


@contextmanager
def serve_virtual() -> Iterator[Served]:
    with virtual_arm() as world:
        yield Served(world.address, [world])


def serve_real(kind: str) -> Callable[[], object]:
    @contextmanager
    def serve() -> Iterator[Served]:
        with ExitStack() as stack:
            path = Path(stack.enter_context(tempfile.TemporaryDirectory())) / "arm"
            where = "0" if kind == "tcp" else str(path)
            world = stack.enter_context(virtual_arm("--bus", f"arm={'pty' if kind == 'serial' else kind}:{where}"))
            name = world.ready["buses"]["arm"][0].split(":", 1)[1]
            bus = f"{kind}:{name}" + (",38400" if kind == "serial" else "")
            yield Served(stack.enter_context(real_arm(bus)).address, [world])

    return serve


class MirrorProgram(Program):
    """visum mirror, as a user starts it."""

    def __init__(self, primary: Program, shadow: Program, *options: object) -> None:
        super().__init__("visum", "mirror", "--primary", primary.address, "--shadow", shadow.address,
                         "--speedup", SPEED, *options)


@contextmanager
def serve_mirror() -> Iterator[Served]:
    with virtual_arm() as one, virtual_arm() as other, MirrorProgram(one, other) as mirror:
        yield Served(mirror.address, [one, other])


def wait_until(client: visum.Client, part: visum.Part, holds: Callable[[], bool], sim_s: float) -> bool:
    """Lets time pass until `holds()`, at most `sim_s` of the served part's time."""
    end = client.time_ns + int(sim_s * 1e9)
    wall = time.monotonic() + PATIENCE_S
    while client.time_ns < end and time.monotonic() < wall:
        client.advance_ms(10)
        if holds():
            return True
    return False
