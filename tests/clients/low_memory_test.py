"""Requests for which a limit of memory (ulimit -v, or a container's) leaves no room: each is refused by itself. The daemon goes on,
the world is as before, and everyone else is served."""
import json
import resource
import subprocess
import sys
import unittest

from programs import ARM, BIN, DEADLINE_S

sys.path.insert(0, str(BIN.parent / "python"))
import visum  # noqa: E402

VISUMD = (BIN / "visumd").read_bytes()
SANITIZED = b"__asan_init" in VISUMD or b"__tsan_init" in VISUMD  # reserves terabytes of addresses
LIMITS_MIB = (95, 130, 150, 170, 200, 250, 300)
BALL = "{{name: ball_{}, mass: 0.1, pose: {{xyz: [1.5, 1.5, 0.5]}}, shapes: [{{sphere: 0.05}}]}}"
# Too many shapes: it is refused after it was read.
MANY_VALUES = "{name: big, mass: 1, shapes: [" + "{sphere: 0.1},\n" * 19_000 + "]}"
LARGE_TEXT = "{name: big, mass: 1, color: [" + "1, " * 2_500_000  # 7.5 MB


class Limited:
    """A visumd with so much address space. `observer` is None where it does not suffice to serve anybody: it has ended, with a
    reason."""

    def __init__(self, mib, *options):
        self.mib = mib
        self.command = [str(BIN / "visumd"), str(ARM), "--port", "0", "--http", "off", "--json", "--run", *options]

    def __enter__(self):
        limit = self.mib << 20
        self.process = subprocess.Popen(self.command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
                                        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (limit, limit)))
        line = self.process.stdout.readline()
        self.address = f"127.0.0.1:{json.loads(line)['port']}" if line else None
        try:
            self.observer = visum.Client(self.address, name="observer", role="observer") if line else None
        except (visum.Error, OSError):
            self.observer = None
        return self

    def __exit__(self, *_):
        if self.observer:
            self.observer.close()
        self.process.terminate()
        self.process.wait(timeout=DEADLINE_S)
        self.process.stdout.close()

    def add_body(self, yaml):
        """Adds it, in a session of its own. Returns the code of the error; None: it was added."""
        try:
            with visum.Client(self.address, name="admin", role="admin") as admin:
                admin.add_body(yaml)
        except visum.Error as error:
            return error.code
        return None


@unittest.skipIf(SANITIZED, "sanitizers reserve terabytes of addresses")
class LowMemory(unittest.TestCase):
    def each_limit(self, *options):
        served = 0
        for mib in LIMITS_MIB:
            with Limited(mib, *options) as daemon:
                if daemon.observer is None:
                    self.assertGreater(daemon.process.wait(timeout=DEADLINE_S), 0, f"with {mib} MiB it ends by itself")
                    continue
                yield daemon
                self.assertIsNone(daemon.process.poll(), f"with {mib} MiB the daemon lives")
                served += 1
        self.assertGreater(served, 3, "it serves with most of these limits")

    def test_a_body_is_refused_by_itself_and_the_world_is_unchanged(self):
        for daemon in self.each_limit("--clock", "lockstep"):
            observer = daemon.observer
            before = observer.status()
            for yaml in (LARGE_TEXT, MANY_VALUES, LARGE_TEXT, MANY_VALUES):
                self.assertIn(daemon.add_body(yaml), (visum.ErrorCode.BAD_VALUE, visum.ErrorCode.BUSY), daemon.mib)
                after = observer.status()
                self.assertEqual(after.state_hash, before.state_hash, daemon.mib)

    def test_in_real_time_the_ticks_go_on_and_others_are_served(self):
        for daemon in self.each_limit("--clock", "realtime"):
            observer = daemon.observer
            for number in range(4):
                tick = observer.status().tick
                self.assertIsNotNone(daemon.add_body(LARGE_TEXT))
                self.assertIsNotNone(daemon.add_body(MANY_VALUES))
                added = daemon.add_body(BALL.format(number))
                if daemon.mib >= 200:
                    self.assertIsNone(added, "there is room for a small one")
                self.assertGreater(observer.status().tick, tick, daemon.mib)

    def test_a_frame_that_there_is_no_room_for_costs_its_own_session_at_most(self):
        for daemon in self.each_limit("--clock", "realtime"):
            hoarders = []
            for _ in range(12):
                try:
                    hoarders.append(visum.Client(daemon.address, name="hoarder", role="admin"))
                except (visum.Error, OSError):
                    break  # no room for another session
            for admin in hoarders:
                try:
                    admin.add_body("x" * 15_000_000)
                except (visum.Error, OSError):
                    pass
            tick = daemon.observer.status().tick
            for admin in hoarders:
                admin.close()
            self.assertGreaterEqual(daemon.observer.status().tick, tick)
