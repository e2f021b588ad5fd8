"""A run is valid only if each of its controllers has exchanged something with a part; with real programs of all kinds."""
import json
import subprocess
import sys
import textwrap
import unittest

from programs import BIN, DEADLINE_S, visum
from run_test import Scenario


class Exchanges(Scenario):
    # A client without our library: it says hello by its own bytes, then does what `do` says with `ask`.
    RAW = textwrap.dedent("""
        import socket, struct, sys
        sys.path.insert(0, sys.argv[2])
        from visum import visum_pb2 as pb
        host, port = sys.argv[1].split(":")
        wire = socket.create_connection((host, int(port)))
        def ask(message):
            payload = message.SerializeToString()
            wire.sendall(struct.pack("<I", len(payload)) + payload)
            (length,) = struct.unpack("<I", wire.recv(4, socket.MSG_WAITALL))
            return pb.ServerMessage.FromString(wire.recv(length, socket.MSG_WAITALL))
        def hello(name):
            ask(pb.ClientMessage(id=1, hello=pb.Hello(min_version=1, max_version=1, client_name=name, role=pb.ROLE_CONTROLLER)))
    """)

    def raw(self, name, do):
        program = self.folder / f"{name}.py"
        program.write_text(self.RAW + textwrap.dedent(do))
        return f"{{name: {name}, joins: false, command: [{sys.executable}, {program}, '{{connect}}', {BIN.parent / 'python'}]}}"

    TALKS = "hello('{0}')\nassert ask(pb.ClientMessage(id=2, read=pb.Read(part='arm'))).HasField('part_sample')\n"

    def judged(self, *controllers):
        """Returns why the run is invalid; None: it is valid, and has passed."""
        text = "controllers:\n" + "".join(f"  - {controller}\n" for controller in controllers)
        done = subprocess.run([BIN / "visum", "run", self.write(text), "--json"], capture_output=True, text=True, timeout=DEADLINE_S)
        result = json.loads(done.stdout.splitlines()[-1])
        self.assertEqual((done.returncode, result["passed"]), (0, True) if result["valid"] else (6, False), done.stderr)
        return result.get("invalid_reason")

    def test_one_that_exchanged_nothing_makes_the_run_invalid(self):
        nothing = "controller '{}' exchanged nothing with a part"
        talks, silent = self.raw("talks", self.TALKS.format("talks")), self.raw("silent", "hello('silent')")
        self.assertIsNone(self.judged(talks))
        self.assertIn(nothing.format("silent"), self.judged(talks, silent))
        self.assertIn(nothing.format("c"), self.judged("{name: c, joins: false, command: ['true']}"))
        refused = "hello('refused')\nassert ask(pb.ClientMessage(id=2, read=pb.Read(part='amr'))).HasField('error')\n"
        self.assertIn(nothing.format("refused"), self.judged(self.raw("refused", refused)))

    def test_a_value_a_blackboard_and_a_subscription_are_exchanges(self):
        for do in ("ask(pb.ClientMessage(id=2, subscribe=pb.Subscribe(part='arm', every_n_ticks=1)))",
                   "assert ask(pb.ClientMessage(id=2, acquire_lease=pb.AcquireLease(part='arm'))).HasField('lease')\n"
                   "assert ask(pb.ClientMessage(id=3, write=pb.Write(part='arm', first_port=0, values=[0.0]))).HasField('ok')"):
            self.assertIsNone(self.judged(self.raw("talks", "hello('talks')\n" + do)), do)

    def test_what_belongs_to_whom(self):
        talks = self.raw("talks", self.TALKS.format("talks"))
        # An exchange under another name is the only controller's. Among several it may be anyone's.
        other = self.raw("other", self.TALKS.format("a-name-of-its-own"))
        self.assertIsNone(self.judged(other))
        self.assertIn("client 'a-name-of-its-own' did, and no controller has that name", self.judged(talks, other))
        behind = "{name: behind, joins: false, through: talks, command: ['true']}"
        self.assertIsNone(self.judged(talks, behind))
        self.assertIsNone(self.judged(talks, "{name: log, joins: false, exchanges: false, command: ['true']}"))
        self.assertIn("'talks'", self.judged(self.raw("talks", "hello('talks')"), behind), "the bridge itself has to exchange something")

    def test_a_telegram_on_a_bus_is_an_exchange(self):
        bus = "buses: {arm: pty}\ncontrollers:\n  - "
        self.run_it(bus + '{name: c, shim: true, command: ["{bin}/visum-serial-arm", "{bus.arm}"]}\n')
        look = "import os, sys; os.open(sys.argv[1], os.O_RDWR | os.O_NOCTTY)"
        done = visum("run", self.write(bus + f"{{name: c, joins: false, command: [{sys.executable}, -c, '{look}', '{{bus.arm}}']}}\n"), "--json", expect=6)
        self.assertIn("'c' exchanged nothing with a part", json.loads(done.stdout.splitlines()[-1])["invalid_reason"])


if __name__ == "__main__":
    unittest.main()
