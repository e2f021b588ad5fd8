"""The emergency stop that depends on nobody, and answers while a tick takes long, against a real daemon.

The times until a stop acted are printed. They are compared with a bound that a loaded machine keeps, too."""
import contextlib
import json
import os
import pathlib
import random
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time
import unittest

from programs import ARM, BIN, DEADLINE_S, Daemon, visum

sys.path.insert(0, str(BIN.parent / "python"))
from visum import Client, Error, visum_pb2 as pb  # noqa: E402

TEST_PLUGINS = BIN.parent / "test_plugins"
BOUND_S = 5.0  # for what takes a few milliseconds on an idle machine
TOKENS = "admin does-anything-0001\nobserver looking-only-0001\n"
CULPRIT = f"""\
visum: 1
include: ["{ARM}"]
plugins: [kinds]
agents: [{{name: hand, kind: culprit, parts: {{arm: arm}}, does: DOES}}]
"""


def is_stopped(daemon):
    return next(each["value"] for each in daemon.json("params", "arm")["parameters"] if each["name"] == "Emergency Stop")


def measured_stop(test, daemon, attack):
    """Stops the arm, prints how long that took, and compares it with the bound."""
    begun = time.monotonic()
    said = daemon.json("stop", "arm")
    took_s = time.monotonic() - begun
    print(f"stop under {attack}: {took_s * 1e3:.0f} ms", file=sys.stderr)
    test.assertTrue(said["acted"], said)
    test.assertEqual(said["way"], "datagram")
    test.assertLess(took_s, BOUND_S)


def first_input(client):
    return client.connection.request(read=pb.Read(part="arm")).part_sample.controller_inputs[0]


def frame(**request):
    payload = pb.ClientMessage(id=request.pop("id", 0), **request).SerializeToString()
    return struct.pack("<I", len(payload)) + payload


def send(daemon, role, frames):
    """Says hello and sends all that at once, in a session of its own."""
    host, port = daemon.connect.split(":")
    with socket.create_connection((host, int(port)), timeout=0.3) as client:
        hello = pb.Hello(min_version=1, max_version=1, client_name="x", role=role)
        client.sendall(frame(hello=hello) + frames)
        client.recv(1 << 16)


@contextlib.contextmanager
def attack(daemon, act):
    """Calls act() again and again on a thread while the block runs."""
    ends = threading.Event()

    def run():
        while not ends.is_set():
            with contextlib.suppress(OSError):
                act()

    thread = threading.Thread(target=run)
    thread.start()
    try:
        time.sleep(1)
        yield
    finally:
        ends.set()
        thread.join()


def udp_socket_where_tcp_is_free():
    """A bound socket. Its port is below those that the system gives to connections, so that no program
    beside takes the same one for TCP."""
    for port in random.sample(range(20_000, 32_000), 100):
        udp = socket.socket(type=socket.SOCK_DGRAM)
        try:
            udp.bind(("127.0.0.1", port))
            with socket.socket() as tcp:
                tcp.bind(("127.0.0.1", port))
            return udp
        except OSError:
            udp.close()
    raise AssertionError("none of 100 ports is free")


class Stop(unittest.TestCase):
    def test_it_acts_with_every_clock_and_says_so(self):
        for clock in ("realtime", "lockstep", "free"):
            with Daemon("--clock", clock, "-r") as daemon:
                self.assertRegex(daemon.visum("stop", "arm").stdout,
                                 r"^latched: the emergency stop of 'arm'\nacted at tick \d+\n$")
                self.assertTrue(is_stopped(daemon))
                daemon.visum("param-set", "arm", "Emergency Stop", "false")
                self.assertFalse(is_stopped(daemon))
                daemon.visum("stop")
                self.assertTrue(is_stopped(daemon))

    def test_it_acts_while_time_is_paused(self):
        with Daemon("-r") as daemon:
            daemon.visum("pause")
            self.assertTrue(daemon.json("stop", "arm")["acted"])
            self.assertTrue(is_stopped(daemon))

    def test_what_is_wrong_is_said(self):
        with Daemon() as daemon:
            self.assertIn("no part 'amr'", daemon.visum("stop", "amr", expect=2).stderr)
            connect = daemon.connect
        self.assertIn("no server at", visum("stop", "--connect", connect, expect=4).stderr)

    def test_any_token_may_stop_and_no_other(self):
        with tempfile.TemporaryDirectory() as folder:
            tokens, observer, wrong = (pathlib.Path(folder) / name for name in ("tokens", "observer", "wrong"))
            for file, text in ((tokens, TOKENS), (observer, "looking-only-0001\n"), (wrong, "looking-only-0002\n")):
                file.touch(0o600)
                file.write_text(text)
            with Daemon("--token-file", tokens) as daemon:
                for words in ((), ("--token-file", wrong)):
                    self.assertIn("the token is missing or wrong", daemon.visum("stop", *words, expect=1).stderr)
                self.assertIn("acted at tick", daemon.visum("stop", "--token-file", observer).stdout)

    def test_a_taken_port_leaves_the_way_through_a_session(self):
        with udp_socket_where_tcp_is_free() as udp:
            port = udp.getsockname()[1]
            daemon = Daemon()
            daemon.command[daemon.command.index("--port") + 1] = str(port)
            with daemon:
                said = daemon.json("stop", "arm")
                self.assertEqual((said["way"], said["acted"]), ("session", True))
                self.assertTrue(is_stopped(daemon))

    def test_a_stop_is_recorded_and_replayed(self):
        with tempfile.TemporaryDirectory() as folder:
            recording = pathlib.Path(folder) / "run.mcap"
            with Daemon("-r", "--record", recording) as daemon:
                daemon.visum("stop", "arm")
                tick = daemon.json("status")["tick"]
                while daemon.json("status")["tick"] < tick + 50:
                    pass
            visum("replay", recording)


class Attacks(unittest.TestCase):
    """None of them holds up a stop in real time."""

    def test_none(self):
        with Daemon("-r") as daemon:
            measured_stop(self, daemon, "no attack")

    def test_a_log_that_nobody_reads(self):
        process = subprocess.Popen([BIN / "visumd", ARM, "--port", "0", "--json", "-r", "-v", "3"], stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, text=True)
        try:
            daemon = Daemon()
            daemon.connect = f"127.0.0.1:{json.loads(process.stdout.readline())['port']}"
            with attack(daemon, lambda: send(daemon, pb.ROLE_OBSERVER, frame(reset=pb.Reset()) * 200)):
                begun = time.monotonic()
                done = subprocess.run([BIN / "visum", "stop", "arm", "--connect", daemon.connect, "--json"],
                                      capture_output=True, text=True, timeout=DEADLINE_S)
                took_s = time.monotonic() - begun
            print(f"stop under a log that nobody reads: {took_s * 1e3:.0f} ms, {done.stdout}", end="", file=sys.stderr)
            self.assertTrue(json.loads(done.stdout)["acted"], done.stderr)
            self.assertLess(took_s, BOUND_S)
        finally:
            process.kill()
            process.communicate()

    def test_connections_from_the_same_address(self):
        with Daemon("-r") as daemon:
            host, port = daemon.connect.split(":")
            held = []

            def connect():
                held.append(socket.create_connection((host, int(port)), timeout=1))
                if len(held) > 200:
                    held.pop(0).close()

            with attack(daemon, connect):
                measured_stop(self, daemon, "connections from the same address")
            for client in held:
                client.close()

    def test_datagrams_at_its_own_door(self):
        with Daemon("-r") as daemon, socket.socket(type=socket.SOCK_DGRAM) as flood:
            host, port = daemon.connect.split(":")
            with attack(daemon, lambda: flood.sendto(os.urandom(96), (host, int(port)))):
                measured_stop(self, daemon, "datagrams at its own door")

    def test_requests_that_are_commands(self):
        with Daemon("-r") as daemon:
            with attack(daemon, lambda: send(daemon, pb.ROLE_ADMIN, frame(take_snapshot=pb.TakeSnapshot()) * 60)):
                measured_stop(self, daemon, "a flood of snapshots")
            self.assertTrue(is_stopped(daemon))


    def test_bodies_that_are_refused(self):
        too_long = "{name: big, mass: 1, color: [" + "1, " * 3_000_000  # 9 MB: refused unread
        # The daemon reads this one before it refuses it.
        too_many_shapes = "{name: big, mass: 1, shapes: [" + "{sphere: 0.1},\n" * 19_000 + "]}"
        with Daemon("-r") as daemon:

            def flood():
                for body in (too_long, too_many_shapes):
                    with contextlib.suppress(Error), Client(daemon.connect, name="x", role="admin") as admin:
                        admin.add_body(body)

            with attack(daemon, flood):
                measured_stop(self, daemon, "bodies that are refused")
            self.assertTrue(is_stopped(daemon))


class LongTick(unittest.TestCase):
    """A tick of three seconds: everybody is answered, and nothing depends on that."""

    def setUp(self):
        self.folder = self.enterContext(tempfile.TemporaryDirectory())

    def culprit(self, does):
        scene = pathlib.Path(self.folder) / "culprit.yaml"
        scene.write_text(CULPRIT.replace("DOES", does))
        return scene

    def daemon(self, does, *options):
        return Daemon("--plugins", TEST_PLUGINS, "--node-timeout", 0, *options, scene=self.culprit(does))

    def test_status_says_what_it_does_and_pause_and_stop_are_latched(self):
        for clock in ("realtime", "lockstep", "free"):
            with self.daemon("hangs", "--clock", clock, "-r") as daemon:
                client = self.enterContext(Client(daemon.connect, role="admin"))
                if clock == "lockstep":
                    stepper = self.enterContext(Client(daemon.connect, name="stepper"))
                    stepper.connection.send(join=pb.Join())
                    stepper.connection.send(advance=pb.Advance(ticks=1000))
                status = client.status()
                while not status.working:
                    status = client.status()
                longest_s = 0.0
                for _ in range(20):
                    begun = time.monotonic()
                    status = client.status()
                    longest_s = max(longest_s, time.monotonic() - begun)
                print(f"status within a tick, {clock}: {longest_s * 1e3:.0f} ms at most", file=sys.stderr)
                self.assertLess(longest_s, BOUND_S)
                self.assertEqual(status.working, "agent 'hand'")
                self.assertGreater(status.working_ns, 100_000_000)
                begun = time.monotonic()
                answer = client.connection.request(pause=pb.Pause()).ok
                self.assertGreaterEqual(answer.acts_at_tick, status.tick + 1)
                self.assertLess(time.monotonic() - begun, BOUND_S)
                said = daemon.json("stop", "arm")
                self.assertEqual((said["latched"], said["acted"]), (True, False))
                self.assertIn("tick in progress", daemon.visum("status").stdout)
                daemon.process.terminate()
                begun = time.monotonic()
                self.assertEqual(daemon.process.wait(timeout=DEADLINE_S), 124)
                print(f"SIGTERM within a tick, {clock}: {time.monotonic() - begun:.2f} s", file=sys.stderr)

    def test_what_was_latched_acts_at_its_end(self):
        with self.daemon("sleeps", "--clock", "free", "-r") as daemon:
            client = self.enterContext(Client(daemon.connect, role="admin"))
            while not client.status().working:
                pass
            answer = client.connection.request(pause=pb.Pause()).ok
            self.assertGreater(answer.acts_at_tick, 0)
            while not client.status().paused:
                pass
            self.assertEqual(client.status().tick, answer.acts_at_tick)

    def test_the_hash_is_the_same_however_much_is_asked_meanwhile(self):
        hashes = []
        for asks in (False, True):
            with self.daemon("sleeps", "--clock", "lockstep") as daemon:
                stepper = self.enterContext(Client(daemon.connect, name="stepper"))
                observer = self.enterContext(Client(daemon.connect, role="observer"))
                stepper.join()
                advance = stepper.connection.send(advance=pb.Advance(ticks=100))
                while asks and not observer.status().working:
                    pass
                for _ in range(200 if asks else 0):
                    observer.status()
                    observer.read_world()
                stepper.connection.wait(advance)
                hashes.append(stepper.status().state_hash)
                self.assertEqual(stepper.status().tick, 100)
        self.assertEqual(hashes[0], hashes[1])

    def test_a_tick_that_is_abandoned_is_not_recorded_and_the_rest_is(self):
        for clock in ("realtime", "free"):
            recording = pathlib.Path(self.folder) / f"{clock}.mcap"
            link = pathlib.Path(self.folder) / "arm.tty"
            command = [BIN / "visumd", self.culprit("hangs"), "--plugins", TEST_PLUGINS, "--node-timeout", "0", "--port", "0",
                       "--json", "--clock", clock, "--record", recording, "--files", self.folder, "--bus", f"arm=pty:{link}"]
            process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            connect = f"127.0.0.1:{json.loads(process.stdout.readline())['port']}"
            with Client(connect, role="admin") as client:
                client.start_recording(f"by_client_{clock}")
                client.resume()
                while not client.status().working:
                    pass
                self.assertTrue(link.is_symlink())
                process.send_signal(signal.SIGTERM)
                _, log = process.communicate(timeout=DEADLINE_S)
            self.assertEqual(process.returncode, 124, log)
            self.assertRegex(log, r"the tick after it was abandoned, as it did not end: agent 'hand'")
            self.assertFalse(link.is_symlink())
            for each in (recording, pathlib.Path(self.folder) / f"by_client_{clock}.mcap"):
                self.assertIn("the same", visum("replay", each, "--plugins", TEST_PLUGINS).stdout)


class OldCommands(unittest.TestCase):
    def test_a_server_that_was_stopped_does_none_of_them(self):
        """A controller writes at 100 Hz. What it wrote while the server was stopped is never in force."""
        with Daemon("-r") as daemon:
            client = self.enterContext(Client(daemon.connect, name="controller"))
            connection = client.connection
            connection.request(acquire_lease=pb.AcquireLease(part="arm"))
            watcher = self.enterContext(Client(daemon.connect, name="watcher", role="observer"))
            connection.request(write=pb.Write(part="arm", first_port=0, values=[0.001]))
            while first_input(watcher) != 0.001:
                pass
            os.kill(daemon.process.pid, signal.SIGSTOP)
            stopped = time.monotonic()
            count = 0
            while time.monotonic() - stopped < 1.25:
                connection.send(write=pb.Write(part="arm", first_port=0, values=[0.5]))
                count += 1
                time.sleep(0.01)
            os.kill(daemon.process.pid, signal.SIGCONT)
            status = watcher.status()
            while status.late_writes < count:
                status = watcher.status()
            self.assertEqual(first_input(watcher), 0.001)
            self.assertEqual(status.late_writes, count)
            self.assertEqual(status.silent_stops, 0, "the whole process was stopped")


if __name__ == "__main__":
    unittest.main()
