"""Sensors as a user meets them: the example scene in a real daemon, read by the command line."""
import json
import math
import pathlib
import struct
import sys
import tempfile
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(SOURCE / "tests" / "clients"))
from programs import BIN, Daemon  # noqa: E402

sys.path.insert(0, str(BIN.parent / "python"))
import visum  # noqa: E402

SCENE = SOURCE / "models" / "scenes" / "sensors.yaml"


class Sensors(unittest.TestCase):
    def setUp(self):
        self.daemon = self.enterContext(Daemon("--clock", "lockstep", "--http", "off", scene=SCENE))
        self.daemon.visum("pause")

    def get(self, part, port):
        return float(self.daemon.visum("get", part, port).stdout)

    def test_every_kind_is_a_part(self):
        self.assertEqual([part["kind"] for part in self.daemon.json("parts")["parts"]],
                         ["distance", "scanner", "imu", "pose", "contact", "camera", "joint_wrench"])

    def test_they_read_what_the_world_does(self):
        self.daemon.visum("step", 3000)
        self.assertAlmostEqual(self.get("imu", "Angular Rate Z"), 0.8, delta=0.05)
        self.assertAlmostEqual(self.get("bumper", "Normal Force"), 2 * 9.81, delta=1.2)
        self.assertAlmostEqual(self.get("load", "Force Z"), 5 * 9.81, delta=0.6)
        self.assertAlmostEqual(self.get("tracker", "Position Z"), 0.25, delta=0.01)
        self.assertEqual(self.get("eye", "Changed"), 149)

    def test_a_failure_acts(self):
        self.daemon.visum("param-set", "eye", "Failure", "off")
        self.daemon.visum("step", 1000)
        self.assertEqual(self.get("eye", "Changed"), 0)

    def test_a_scan_comes_as_a_blackboard(self):
        self.daemon.visum("step", 200)
        with visum.Client(self.daemon.connect, role="observer") as client:
            data = client.part("scan").read_blackboard("scan")
        scan = struct.unpack("<361f", data)
        self.assertAlmostEqual(min(scan), self.get("scan", "Nearest Distance"), delta=1e-6)
        self.assertAlmostEqual(min(scan), 3 * math.cos(0.4) - 0.1, delta=0.05)
        self.assertEqual(max(scan), 6.0)

    def test_a_camera_takes_the_same_picture_in_every_run(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "picture.png"
            early = self.daemon.visum("camera", "camera", "-o", file, expect=1)
            self.assertIn("has taken no picture yet", early.stderr)
            wrong = self.daemon.visum("camera", "eye", "-o", file, expect=2)
            self.assertIn("takes no pictures", wrong.stderr)
            self.daemon.visum("step", 500)
            told = json.loads(self.daemon.visum("camera", "camera", "-o", file, "--json").stdout)
            self.assertEqual([told[key] for key in ("width", "height", "shows", "taken_s")],
                             [640, 480, "color", 0.45])
            first = file.read_bytes()
            self.assertTrue(first.startswith(b"\x89PNG"))
            self.daemon.visum("reset")
            self.daemon.visum("step", 500)
            self.daemon.visum("camera", "camera", "-o", file)
            self.assertEqual(file.read_bytes(), first)


if __name__ == "__main__":
    unittest.main()
