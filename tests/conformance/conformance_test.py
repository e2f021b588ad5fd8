"""Plays recorded sessions of each released version of the protocol to this build's daemon: its clients must still work."""

import json
import os
import subprocess
import unittest
from pathlib import Path

from sessions import Wire, differences, parsed, read_session
from visum import visum_pb2 as pb

HERE = Path(__file__).resolve().parent
SOURCE = HERE.parents[1]
BIN = Path(os.environ.get("VISUM_BIN", SOURCE / "build/dev/bin"))


class Daemon:
    def __init__(self, scene: str):
        # The sessions were recorded when ODE was the scenes' engine.
        words = [BIN / "visumd", SOURCE / "models/scenes" / scene, "--engine", "ode", "--clock", "lockstep", "--port", "0", "--http", "off", "--json", "-v", "0"]
        self.process = subprocess.Popen(words, stdout=subprocess.PIPE, text=True)
        self.port = json.loads(self.process.stdout.readline())["port"]

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.terminate()
        self.process.wait(60)
        self.process.stdout.close()


class Conformance(unittest.TestCase):
    def client_of(self, daemon: Daemon) -> Wire:
        wire = Wire(daemon.port)
        self.addCleanup(wire.close)
        return wire

    def play(self, file: Path) -> None:
        scene, frames = read_session(file)
        self.assertGreater(len(frames), 5, "a session")
        wires: dict[int, Wire] = {}
        with Daemon(scene) as daemon:
            for number, (client, direction, payload) in enumerate(frames, 1):
                wire = wires.get(client) or wires.setdefault(client, self.client_of(daemon))
                if direction == ">":
                    wire.send(payload)
                    continue
                told = wire.receive()
                found = list(differences(parsed(payload), parsed(told)))
                self.assertEqual(found, [], f"{file.name}, frame {number}")

    def test_every_recorded_session_of_every_version(self):
        files = sorted(HERE.glob("v*/*.session"))
        self.assertGreaterEqual(len(files), 5)
        for file in files:
            with self.subTest(f"{file.parent.name} {file.stem}"):
                self.play(file)

    def test_a_client_of_a_later_version_is_answered_in_ours(self):
        with Daemon("two_link.yaml") as daemon:
            wire = self.client_of(daemon)
            hello = pb.Hello(min_version=1, max_version=99, client_name="from tomorrow", role=pb.ROLE_OBSERVER)
            # An unknown field: number 900, a text.
            wire.send(pb.ClientMessage(id=1, hello=hello).SerializeToString() + b"\xa2\x38\x03new")
            self.assertEqual(parsed(wire.receive()).welcome.version, 1)

    def test_without_a_version_in_common_the_reason_is_told(self):
        with Daemon("two_link.yaml") as daemon:
            wire = self.client_of(daemon)
            hello = pb.Hello(min_version=98, max_version=99, client_name="from tomorrow", role=pb.ROLE_OBSERVER)
            wire.send(pb.ClientMessage(id=1, hello=hello).SerializeToString())
            error = parsed(wire.receive()).error
            self.assertEqual(error.code, pb.ERROR_VERSION)
            self.assertIn("98", error.text)
            self.assertTrue(wire.at_end())

    def test_a_difference_is_seen(self):
        then = pb.ServerMessage(reply_to=3, lease=pb.LeaseGrant(part="robot", epoch=1))
        self.assertEqual(list(differences(then, then)), [])
        self.assertTrue(list(differences(then, pb.ServerMessage(reply_to=3, lease=pb.LeaseGrant(part="robot", epoch=2)))))
        self.assertTrue(list(differences(then, pb.ServerMessage(reply_to=4, lease=pb.LeaseGrant(part="robot", epoch=1)))))
        self.assertTrue(list(differences(then, pb.ServerMessage(reply_to=3, ok=pb.Ok()))))
        placed = pb.ServerMessage(world_description=pb.WorldDescription(joints=[pb.JointDescription(pose=[0.3])]))
        rounded = pb.ServerMessage(world_description=pb.WorldDescription(joints=[pb.JointDescription(pose=[0.1 + 0.2])]))
        moved = pb.ServerMessage(world_description=pb.WorldDescription(joints=[pb.JointDescription(pose=[0.3001])]))
        self.assertEqual(list(differences(placed, rounded)), [])
        self.assertTrue(list(differences(placed, moved)))


if __name__ == "__main__":
    unittest.main()
