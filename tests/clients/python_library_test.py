"""The Python package: its modules do not import each other in a circle, and a wrong name is answered with a near one."""
import ast
import subprocess
import sys
import unittest
from unittest import mock

from programs import BIN, SOURCE, Daemon

sys.path.insert(0, str(BIN.parent / "python"))
import visum  # noqa: E402

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

    def test_without_a_lockstep_a_write_leaves_at_once(self):
        with Daemon("--clock", "free") as daemon, visum.Client(daemon.connect) as client:
            arm = client.part("arm")
            with arm.lease():
                client.join()
                arm.inputs("Desired Angle")[0] = 0.1
                with mock.patch.object(client.connection, "flush", wraps=client.connection.flush) as flush:
                    arm.write()
                flush.assert_called_once()


class PythonLibrary(unittest.TestCase):
    def test_only_tls_loads_the_library_for_it(self):
        script = "import sys, visum; print(sorted({'ssl', 'subprocess', 'json'} & sys.modules.keys()), visum.launch.__name__)"
        done = subprocess.run([sys.executable, "-c", script], cwd=BIN.parent / "python", capture_output=True, text=True,
                              timeout=60, check=True)
        self.assertEqual(done.stdout, "[] launch\n")

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
