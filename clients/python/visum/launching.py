"""Starts a daemon with a scene and connects to it, in one call."""

from __future__ import annotations

import contextlib
import json
import os
import select
import shutil
import subprocess
import tempfile
import threading
import time
import weakref
from collections.abc import Iterator, Sequence
from pathlib import Path

from visum.client import Client
from visum.errors import Error, ErrorCode
from visum.scene import Scene

_STOP_S = 10.0  # that a daemon may take to end; then it is killed
_READY_BYTES = 1 << 16
_LOG_CHARACTERS = 4000  # of the log's end, in an error


class LaunchedClient(Client):
    """A Client of a daemon of its own. close(), the end of a `with` block and the end of the program end the daemon, too."""

    def __init__(self, daemon: _Daemon, name: str, role: str, connect_timeout_s: float) -> None:
        self._daemon = daemon
        super().__init__(daemon.address, name=name, role=role, connect_timeout_s=connect_timeout_s)

    @property
    def address(self) -> str:
        """Where the daemon listens, for further clients: "127.0.0.1:PORT"."""
        return self._daemon.address

    @property
    def page(self) -> str:
        """The URL of the daemon's page, for a browser on this machine."""
        return self._daemon.page

    @property
    def log(self) -> str:
        """All that the daemon has logged."""
        return self._daemon.log()

    def close(self) -> None:
        super().close()
        self._daemon.end()


def launch(scene: str | Path | Scene, *options: str, clock: str | None = None, name: str = "python", role: str = "controller",
           start_timeout_s: float = 60.0, program: str | Path | None = None) -> LaunchedClient:
    """Starts visumd with a scene on a free port of this machine, and returns a client that is connected to it.

    `scene` is a scene's file, or a Scene, whose relative paths begin at the working directory. `options` are further words of visumd's command line, as in
    launch("arm.yaml", "--record", "run.mcap"). `clock` is realtime, lockstep or free instead of the scene's own. `program` is
    the visumd to start: by default the one of the build that this package belongs to, else the one on the PATH.

    Raises Error: MISUSE if there is no visumd, or if it refuses the scene or an option (the text is its log), TIMEOUT if it is
    not ready in time.
    """
    words = [*options, *(["--clock", clock] if clock else [])]
    with _file_of(scene) as file:
        daemon = _Daemon([str(program or _visumd()), file, "--port", "0", "--json", *words], start_timeout_s)
    try:
        return LaunchedClient(daemon, name, role, start_timeout_s)
    except BaseException:
        daemon.end()
        raise


@contextlib.contextmanager
def _file_of(scene: str | Path | Scene) -> Iterator[str]:
    """The scene's file until the daemon has read it. A Scene is written into the working directory, where its paths begin."""
    if not isinstance(scene, Scene):
        yield os.fspath(scene)
        return
    try:
        file = tempfile.NamedTemporaryFile(prefix=".visum-", suffix=".yaml", dir=".")
        scene.write(file.name)
    except OSError as error:
        raise Error(ErrorCode.MISUSE, f"the scene cannot be written into the working directory: {error}") from error
    with file:
        yield file.name


def _visumd() -> str:
    built = Path(__file__).resolve().parents[2] / "bin" / "visumd"
    if found := str(built) if built.is_file() else shutil.which("visumd"):
        return found
    raise Error(ErrorCode.MISUSE, f"there is no visumd, neither on the PATH nor as {built}: install Visum, or name it with program=")


def _end(process: subprocess.Popen[bytes]) -> None:
    process.terminate()
    try:
        process.wait(_STOP_S)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


class _Daemon:
    """The process, its first line of output and its log."""

    def __init__(self, command: Sequence[str], patience_s: float) -> None:
        # The daemon and all clients in programs that we start meet on a Unix socket (protocol/local_socket.h)
        os.environ.setdefault("VISUM_LOCAL", os.urandom(16).hex())
        self._log = tempfile.TemporaryFile(prefix="visum-")
        weakref.finalize(self, self._log.close)
        try:
            self._process = subprocess.Popen([*_dying_with_us(), *command], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                             stderr=self._log)
        except OSError as error:
            raise Error(ErrorCode.MISUSE, f"{command[0]} cannot be started: {error}") from error
        self.end = weakref.finalize(self, _end, self._process)  # also when the program ends, once
        try:
            ready = self._await_ready(time.monotonic() + patience_s, patience_s)
        except BaseException:
            self.end()
            raise
        self.address = f"127.0.0.1:{ready['port']}"
        self.page: str = ready.get("page", "")

    def log(self) -> str:
        size = os.fstat(self._log.fileno()).st_size
        return os.pread(self._log.fileno(), size, 0).decode(errors="replace")

    def _await_ready(self, end: float, patience_s: float) -> dict[str, object]:
        assert self._process.stdout
        line = b""
        with self._process.stdout as out:
            while not line.endswith(b"\n"):
                if not select.select([out], [], [], max(0.0, end - time.monotonic()))[0]:
                    raise Error(ErrorCode.TIMEOUT, f"visumd was not ready within {patience_s:g} s{self._last_words()}")
                more = os.read(out.fileno(), _READY_BYTES)
                if not more:
                    code = self._process.wait(_STOP_S)
                    raise Error(ErrorCode.MISUSE, f"visumd ended with code {code} before it was ready{self._last_words()}")
                line += more
        try:
            return json.loads(line)
        except ValueError:
            words = line[:80].decode(errors="replace").strip()
            raise Error(ErrorCode.MISUSE, f"this is no visumd: it says '{words}' instead of where it listens") from None

    def _last_words(self) -> str:
        log = self.log().strip()[-_LOG_CHARACTERS:]
        return f":\n{log}" if log else ""


def _dying_with_us() -> list[str]:
    """The words before a command that let it end even if this program is killed. Linux ties that to the thread that starts it."""
    tool = shutil.which("setpriv")
    return [tool, "--pdeathsig", "TERM"] if tool and threading.current_thread() is threading.main_thread() else []
