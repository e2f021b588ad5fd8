"""The Python package: what it sends and shows, how it waits, what it imports, and that a wrong name is answered with a near one."""
import ast
import contextlib
import importlib.util
import itertools
import os
import socket
import struct
import subprocess
import sys
import unittest
from unittest import mock

from programs import BIN, SOURCE, Daemon

sys.path.insert(0, str(BIN.parent / "python"))
import visum  # noqa: E402
from visum import visum_pb2  # noqa: E402
from visum.busy_wait import BusyWait  # noqa: E402
from visum.request_bytes import frame, request_bytes  # noqa: E402

PACKAGE = SOURCE / "clients" / "python" / "visum"


def imports_of(file):
    """The modules of the package that a file imports. Imports for type checking count as well."""
    for node in ast.walk(ast.parse(file.read_text())):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("visum."):
            yield node.module.removeprefix("visum.")
        elif isinstance(node, ast.Import):
            yield from (name.name.removeprefix("visum.") for name in node.names if name.name.startswith("visum."))


def circle_in(graph):
    """The first circle found, as its members in the order of the imports; empty if there is none."""
    done = set()

    def visit(name, path):
        if name in path:
            return [*path[path.index(name):], name]
        if name in done:
            return []
        for target in graph.get(name, ()):
            if circle := visit(target, [*path, name]):
                return circle
        done.add(name)
        return []

    return next((circle for name in graph if (circle := visit(name, []))), [])


class CountingSocket:
    """A connection's socket, with the number of times that something was sent on it."""

    def __init__(self, socket):
        self._socket = socket
        self.sent = 0

    def sendall(self, data):
        self.sent += 1
        return self._socket.sendall(data)

    def __getattr__(self, name):
        return getattr(self._socket, name)


class Exchanges(unittest.TestCase):
    """Each message that leaves alone wakes the server once more."""

    def test_a_period_of_a_member_leaves_as_one(self):
        with Daemon("--clock", "lockstep") as daemon, visum.Client(daemon.connect) as client:
            arm = client.part("arm")
            desired, actual = arm.inputs("Desired Angle"), arm.outputs("Actual Angle")
            with arm.lease():
                client.join()
                counted = client.connection._socket = CountingSocket(client.connection._socket)
                for period in range(1, 41):
                    desired[0], desired[2] = 0.002 * period, 0.002 * period
                    arm.write()
                    client.advance_ms(10)
                    self.assertEqual(counted.sent, period)
                self.assertAlmostEqual(actual[0], 0.08, delta=0.03)
                client.leave()

    def test_what_was_kept_leaves_before_anything_is_waited_for(self):
        with Daemon("--clock", "lockstep") as daemon, visum.Client(daemon.connect) as client:
            arm = client.part("arm")
            desired = arm.inputs("Desired Angle")
            with arm.lease():
                client.join()
                counted = client.connection._socket = CountingSocket(client.connection._socket)
                desired[0] = 0.1
                arm.write()
                self.assertEqual(counted.sent, 0)
                client.settle_writes()
                self.assertEqual(counted.sent, 1)
                arm.write()
                client.events()
                self.assertEqual(counted.sent, 2)
                arm.write()
                client.leave()
                self.assertEqual(counted.sent, 4)

    def test_a_read_right_after_an_advance_in_lockstep_is_free(self):
        with Daemon("--clock", "lockstep") as daemon, visum.Client(daemon.connect) as client:
            arm = client.part("arm")
            client.join()
            counted = client.connection._socket = CountingSocket(client.connection._socket)
            arm.read()
            self.assertEqual(counted.sent, 1, "no advance was made yet")
            desired, in_force = arm.inputs("Desired Angle"), arm.inputs("Desired Angle")[0]
            # A call between an advance and a read, and the messages of all three.
            for between, sent in ((lambda: None, 1), (arm.read, 2), (client.part_names, 3), (lambda: desired.set([0.5] * 7), 2)):
                before = counted.sent
                client.advance_ticks(1)
                between()
                arm.read()
                self.assertEqual((counted.sent - before, arm.sample_tick), (sent, client.tick))
            self.assertEqual(desired[0], in_force, "what was set without the lease is forgotten")

    def test_a_blackboard_that_is_read_in_each_period_comes_with_the_advance(self):
        with Daemon("--clock", "lockstep") as daemon, visum.Client(daemon.connect, role="admin") as client:
            arm = client.part("arm")
            arm.acquire()
            client.join()
            counted = client.connection._socket = CountingSocket(client.connection._socket)

            def period(*calls):
                before = counted.sent
                client.advance_ticks(1)
                last = [call() for call in calls][-1:]
                return counted.sent - before, *last

            def read():
                return len(arm.read_blackboard("Trajectory"))

            row = struct.pack("<10d", 9.0, *arm.outputs("Actual Angle").values(), *arm.outputs("Actual Finger Position").values())
            self.assertEqual([period(read) for _ in range(4)], [(2, 0), (2, 0), (1, 0), (1, 0)])
            self.assertEqual(period(read, read), (2, 0), "a second read asks")
            write = (lambda: arm.write_blackboard("Trajectory", row))
            self.assertEqual(period(write, read), (3, len(row)), "what the advance has brought is older than the write")
            self.assertEqual(period(read), (1, len(row)))
            self.assertEqual(period(client.reset, read), (3, 0))
            self.assertEqual(period(read), (1, 0))
            self.assertEqual([period(), period(read), period(read), period(read)], [(1,), (2, 0), (2, 0), (1, 0)])

    def test_a_blackboard_that_is_refused_is_refused_where_it_is_read(self):
        with Daemon("--clock", "lockstep") as daemon, visum.Client(daemon.connect) as client:
            arm = client.part("arm")
            client.join()
            for _ in range(4):
                client.advance_ticks(1)
                with self.assertRaisesRegex(visum.Error, "Trajektory"):
                    arm.read_blackboard("Trajektory")

    def test_without_a_lockstep_a_read_asks(self):
        with Daemon("--clock", "free") as daemon, visum.Client(daemon.connect) as client:
            arm = client.part("arm")
            client.join()
            client.advance_ticks(1)
            counted = client.connection._socket = CountingSocket(client.connection._socket)
            arm.read()
            self.assertEqual(counted.sent, 1)

    def test_without_a_lockstep_a_write_leaves_at_once(self):
        with Daemon("--clock", "free") as daemon, visum.Client(daemon.connect) as client:
            arm = client.part("arm")
            with arm.lease():
                client.join()
                arm.inputs("Desired Angle")[0] = 0.1
                with mock.patch.object(client.connection, "flush", wraps=client.connection.flush) as flush:
                    arm.write()
                flush.assert_called_once()


class RequestBytes(unittest.TestCase):
    def test_a_frame_holds_what_protobuf_would_write(self):
        kinds = visum_pb2.ClientMessage.DESCRIPTOR.oneofs_by_name["request"].fields
        self.assertGreater(len(kinds), 50)
        for field in kinds:
            message = getattr(visum_pb2.ClientMessage(), field.name)
            for number in (0, 1, 127, 128, 1 << 14, (1 << 32) + 5, (1 << 64) - 1):
                sent = frame(number, request_bytes(**{field.name: message}))
                with self.subTest(field.name, number=number):
                    self.assertEqual(len(sent) - 4, int.from_bytes(sent[:4], "little"))
                    expected = visum_pb2.ClientMessage(id=number, **{field.name: message})
                    self.assertEqual(visum_pb2.ClientMessage.FromString(sent[4:]), expected)

    def test_a_request_of_another_kind_is_refused(self):
        for wrong in ({"read": visum_pb2.AcquireLease(part="arm")}, {"raed": visum_pb2.Read()}, {"id": visum_pb2.Read()},
                      {}, {"read": visum_pb2.Read(), "join": visum_pb2.Join()}, {"read": b"arm"}):
            with self.subTest(wrong), self.assertRaises(TypeError):
                request_bytes(**wrong)

    def test_long_contents_are_whole(self):
        for size in (127, 128, 20_000, 3_000_000):
            write = visum_pb2.WriteBlackboard(part="arm", name="Notes", offset=size, data=b"\xff" * size)
            sent = visum_pb2.ClientMessage.FromString(frame(9, request_bytes(write_blackboard=write))[4:])
            self.assertEqual((9, write), (sent.id, sent.write_blackboard))


class Values(unittest.TestCase):
    """A part shows its controller the inputs that it has set, and the outputs of the newest sample."""

    def setUp(self):
        self.daemon = self.enterContext(Daemon("--clock", "lockstep"))
        self.client = self.enterContext(visum.Client(self.daemon.connect))
        self.part = self.client.part("arm")
        self.desired = self.part.inputs("Desired Angle")

    def write_past_the_check(self, value):
        """Inputs would not let an impossible value through."""
        self.part.stage(self.desired.ports[0].index, value)
        self.part.write()

    def refused(self, call):
        with self.assertRaises(visum.Error) as refusal:
            call()
        self.assertEqual(visum.ErrorCode.BAD_VALUE, refusal.exception.code)

    def in_force(self):
        self.client.join()
        self.client.advance_ticks(1)
        with visum.Client(self.daemon.connect, role="observer") as other:
            return other.part("arm").inputs("Desired Angle")[0]

    def test_a_staged_value_shows_at_once_and_stays_under_the_lease(self):
        self.client.join()
        with self.part.lease():
            before = self.desired[1]
            self.desired[0] = before + 0.25
            self.assertEqual(before + 0.25, self.desired[0])
            self.assertEqual([before + 0.25, before], list(self.desired)[:2])
            self.part.write()
            self.client.advance_ticks(1)
            self.assertEqual(before + 0.25, self.part.input_values[self.desired.ports[0].index])
        self.assertEqual(before + 0.25, self.desired[0])
        self.part.read()
        self.assertEqual(before + 0.25, self.desired[0])

    def test_a_refused_value_gives_way_to_the_one_in_force(self):
        self.part.acquire()
        in_force = self.desired[0]
        self.write_past_the_check(1e6)
        self.refused(self.part.read)
        self.part.read()
        self.assertEqual(in_force, self.desired[0])

    def test_after_a_refusal_a_sign_of_life_commands_nothing_older(self):
        self.part.acquire()
        self.desired[0] = 0.3
        self.part.write()
        self.part.read()
        self.write_past_the_check(1e6)
        self.refused(self.client.settle_writes)
        with contextlib.suppress(visum.Error):
            self.part.write()  # repeats the last write
            self.client.settle_writes()
        self.assertEqual(0.3, self.in_force())

    def test_a_write_behind_a_refused_one_counts(self):
        self.part.acquire()
        self.write_past_the_check(1e6)
        self.desired[0] = 0.9
        self.part.write()
        self.refused(self.client.settle_writes)
        self.assertEqual(0.9, self.desired[0])
        self.part.write()
        self.client.settle_writes()
        self.assertEqual(0.9, self.in_force())

    def test_without_the_lease_a_sample_brings_back_what_is_in_force(self):
        in_force = self.desired[0]
        self.desired[0] = in_force + 0.5
        self.part.read()
        self.assertEqual(in_force, self.desired[0])

    def test_outputs_are_those_of_the_sample(self):
        outputs = self.part.outputs("Actual Angle")
        self.assertIs(list, type(self.part.output_values))
        self.assertEqual([self.part.output_values[port.index] for port in outputs.ports], outputs.values())
        kept = self.part.output_values
        before, tick = list(kept), self.part.sample_tick
        self.client.join()
        with self.part.lease():
            for joint in range(len(self.desired)):
                self.desired[joint] = self.desired[joint] + 0.2
            self.part.write()
            self.client.advance_ticks(200)
        self.assertEqual(tick + 200, self.part.sample_tick)
        self.assertEqual(before, list(kept))
        self.assertNotEqual(before, list(self.part.output_values))


class ScriptedSocket:
    """Has its bytes at one of the looks; counts the looks."""

    def __init__(self, found_at=None):
        self.looks, self._found_at = 0, found_at

    def recv(self, most_bytes, flags):
        assert flags == socket.MSG_DONTWAIT and most_bytes == 100
        self.looks += 1
        if self.looks == self._found_at:
            return b"here"
        raise BlockingIOError


def clock_of(step_s):
    """Stands for the clock, and goes on by so much with each look at it."""
    return mock.patch("time.perf_counter", side_effect=(step_s * i for i in itertools.count()))


@unittest.skipUnless(len(os.sched_getaffinity(0)) > 1, "one processor")
class BusyWaits(unittest.TestCase):
    def looks_in_vain(self, wait):
        source = ScriptedSocket()
        self.assertIsNone(wait.receive(source, 100))
        return source.looks

    def test_it_finds_what_comes_within_a_moment(self):
        for found_at in (1, 2):
            with clock_of(1e-6):
                self.assertEqual(BusyWait().receive(ScriptedSocket(found_at), 100), b"here")

    def test_it_looks_ever_more_seldom_in_vain(self):
        wait = BusyWait()
        with clock_of(5e-6):
            looks = [self.looks_in_vain(wait) for _ in range(10_000)]
        self.assertTrue(50 < max(looks) < 200, max(looks))
        looked = sum(count > 0 for count in looks)
        self.assertTrue(500 < looked < 700, looked)  # it does not give up for good

    def test_a_program_that_is_pushed_out_looks_seldom(self):
        wait = BusyWait()
        with clock_of(1e-3):
            found = sum(wait.receive(ScriptedSocket(1), 100) is not None for _ in range(2000))
        self.assertTrue(50 < found < 150, found)

    def test_it_looks_again_where_looking_helps_again(self):
        wait = BusyWait()
        with clock_of(5e-6):
            self.assertGreater(self.looks_in_vain(wait), 0)
            self.assertEqual(self.looks_in_vain(wait), 0)
            found = [wait.receive(ScriptedSocket(1), 100) is not None for _ in range(1000)]
        self.assertGreater(sum(found), 990)
        self.assertTrue(all(found[10:]))

    def test_it_never_looks_where_the_clock_stands_or_nobody_else_can_run(self):
        with mock.patch.dict(os.environ, VISUM_LOCKSTEP="/somewhere"):
            self.assertEqual(self.looks_in_vain(BusyWait()), 0)
        with mock.patch.object(os, "sched_getaffinity", return_value={0}):
            self.assertEqual(self.looks_in_vain(BusyWait()), 0)

    def test_it_ends_where_a_clock_stands_all_the_same(self):
        with mock.patch("time.perf_counter", return_value=1.0):
            self.assertGreater(self.looks_in_vain(BusyWait()), 1)

    def test_a_member_of_a_lockstep_looks_before_it_sleeps(self):
        with Daemon("--clock", "lockstep") as daemon, visum.Client(daemon.connect) as client:
            client.part("arm")
            client.join()
            waits = client.connection._busy_wait
            with mock.patch.object(waits, "receive", wraps=waits.receive) as looked:
                client.advance_ms(10)
            looked.assert_called()
            client.leave()


class Waits(unittest.TestCase):
    """On the Unix socket of a run, where looking is left out."""

    def setUp(self):
        self.enterContext(mock.patch.dict(os.environ, VISUM_LOCAL=f"waits{os.getpid()}"))
        self.daemon = self.enterContext(Daemon("--clock", "lockstep"))
        self.enterContext(mock.patch.object(BusyWait, "receive", return_value=None))
        self.client = self.enterContext(visum.Client(self.daemon.connect))

    def test_a_wait_after_the_end_is_an_error_even_where_the_descriptor_lives_on(self):
        connection = self.client.connection
        self.assertTrue(connection._is_local)
        number, descriptor = connection.send(status=visum_pb2.Status()), connection._socket.fileno()
        connection.close()
        ours, theirs = socket.socketpair()
        self.addCleanup(ours.close)
        self.addCleanup(theirs.close)
        self.assertIn(descriptor, (ours.fileno(), theirs.fileno()))
        with self.assertRaises(visum.Error) as caught:
            connection.wait(number)
        self.assertEqual(caught.exception.code, visum.ErrorCode.CONNECTION)


class PythonLibrary(unittest.TestCase):
    def run_python(self, script):
        done = subprocess.run([sys.executable, "-c", script], cwd=BIN.parent / "python", capture_output=True, text=True,
                              timeout=60, check=True)
        return done.stdout

    def test_a_controller_loads_what_it_needs_only(self):
        rare = {"ssl", "subprocess", "json", "pathlib", "visum.kinematics", "visum.launching", "visum.model_gathering"}
        self.assertEqual(self.run_python(f"import sys, visum; print(sorted({rare} & sys.modules.keys()))"), "[]\n")

    def test_every_name_of_the_package_is_there(self):
        said = self.run_python("from visum import *; import visum; print(sorted(set(visum.__all__) - globals().keys()), "
                               "launch.__name__, Chain.__name__, model_files.__name__, visum.kinematics.compose.__name__)")
        self.assertEqual(said, "[] launch Chain model_files compose\n")
        with self.assertRaisesRegex(AttributeError, "module 'visum' has no attribute 'lunch'"):
            visum.lunch

    def test_byte_code_stands_beside_the_modules_and_is_taken(self):
        folder = BIN.parent / "python" / "visum"
        for file in folder.glob("*.py"):
            with self.subTest(file.name):
                self.assertTrue(os.path.exists(importlib.util.cache_from_source(str(file))))
        done = subprocess.run([sys.executable, "-v", "-c", "import visum"], cwd=folder.parent, capture_output=True, text=True,
                              timeout=60, check=True)
        self.assertIn(f"# code object from '{importlib.util.cache_from_source(str(folder / 'client.py'))}'", done.stderr)

    def test_a_circle_of_imports_is_found(self):
        self.assertEqual(circle_in({"a": ["b"], "b": ["c", "d"], "c": [], "d": ["b"]}), ["b", "d", "b"])
        self.assertEqual(circle_in({"a": ["b"], "b": ["c"]}), [])

    def test_no_module_imports_itself_directly_or_through_others(self):
        graph = {file.stem: sorted(imports_of(file)) for file in PACKAGE.glob("*.py") if file.stem != "__init__"}
        self.assertIn("ports", graph["part"], "imports are found")
        self.assertEqual(circle_in(graph), [])

    def test_a_wrong_name_is_answered_with_the_nearest(self):
        with Daemon("--clock", "lockstep") as daemon, visum.Client(daemon.connect) as client:
            arm = client.part("arm")
            for call, text in (
                    (lambda: client.part("amr"), "there is no part 'amr'; did you mean 'arm'?"),
                    (lambda: arm.outputs("Actual Angel 1"),
                     "part 'arm' has no sensor output 'Actual Angel 1'; did you mean 'Actual Angle 1'?"),
                    (lambda: arm.inputs("Desired Angel"),
                     "part 'arm' has no controller input 'Desired Angel'; did you mean 'Desired Angle'?"),
                    (lambda: arm.parameter("Emergency Stp"),
                     "there is no parameter 'Emergency Stp'; did you mean 'Emergency Stop'?"),
                    (lambda: client.read_world().body("bx"), "there is no body 'bx'; did you mean 'box'?")):
                with self.subTest(text), self.assertRaises(visum.Error) as raised:
                    call()
                self.assertEqual((raised.exception.code, str(raised.exception)), (visum.ErrorCode.UNKNOWN_NAME, text))

    def test_a_wrong_role_is_answered_with_the_roles(self):
        with self.assertRaises(visum.Error) as raised:
            visum.Client("127.0.0.1:1", role="king")
        self.assertEqual(str(raised.exception), "there is no role 'king'; there are: observer, controller, admin")


if __name__ == "__main__":
    unittest.main()
