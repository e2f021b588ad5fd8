"""The real programs, for the tests of this folder: visumd on a free port, and visum as a user calls it."""
import json
import os
import pathlib
import subprocess
import sys
import tempfile

SOURCE = pathlib.Path(__file__).resolve().parents[2]
BIN = pathlib.Path(os.environ.get("VISUM_BIN", SOURCE / "build" / "dev" / "bin")).resolve()
ARM = SOURCE / "models" / "scenes" / "amtec_arm.yaml"
DEADLINE_S = 240  # a guard against hanging for ever, not a measure

# Runs that fail leave a recording where they work: in a folder that goes with the test.
sys.path.insert(0, str(SOURCE / "tests" / "clients"))
PLACE = tempfile.TemporaryDirectory(prefix="visum_clients_test_")
os.chdir(PLACE.name)


def visum(*words, expect=0, env=None, **more):
    """Runs visum and returns what it did; its exit code must be `expect`."""
    done = subprocess.run([BIN / "visum", *map(str, words)], capture_output=True, text=True, timeout=DEADLINE_S,
                          env={**os.environ, **(env or {})}, **more)
    if done.returncode != expect:
        raise AssertionError(f"visum {words}: exit code {done.returncode}, not {expect}\n{done.stdout}\n{done.stderr}")
    return done


class Daemon:
    """A visumd for the length of a `with`; `visum(...)` is connected to it."""

    def __init__(self, *options, scene=ARM):
        self.command = [str(BIN / "visumd"), str(scene), "--port", "0", "--json", "-v", "0", *map(str, options)]

    def __enter__(self):
        self.process = subprocess.Popen(self.command, stdout=subprocess.PIPE, text=True)
        return self.wait_until_ready()

    def wait_until_ready(self):
        self.ready = json.loads(self.process.stdout.readline())
        self.connect = f"127.0.0.1:{self.ready['port']}"
        return self

    def __exit__(self, *_):
        self.process.terminate()
        self.process.wait(timeout=DEADLINE_S)
        self.process.stdout.close()

    def visum(self, verb, *words, expect=0, **more):
        return visum(verb, *words, "--connect", self.connect, expect=expect, **more)

    def json(self, verb, *words):
        return json.loads(self.visum(verb, *words, "--json").stdout)


def processes_with(text):
    """The ids of the processes whose command line holds `text`."""
    found = []
    for folder in pathlib.Path("/proc").iterdir():
        if not folder.name.isdigit() or int(folder.name) == os.getpid():
            continue
        try:
            if text in (folder / "cmdline").read_bytes().decode(errors="replace"):
                found.append(int(folder.name))
        except OSError:
            pass  # it ended meanwhile
    return found


def children_of(process, name):
    """The ids of the processes called `name` that `process` started."""
    found = []
    for pid in processes_with(name):
        try:
            stat = pathlib.Path(f"/proc/{pid}/stat").read_text()
        except OSError:
            continue
        if int(stat.rsplit(") ", 1)[1].split()[1]) == process.pid:
            found.append(pid)
    return found
