"""Sensors as a user meets them: the example scene in a real daemon, read by the command line."""
import json
import math
import os
import pathlib
import struct
import subprocess
import sys
import tempfile
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(SOURCE / "tests" / "clients"))
from programs import ARM, BIN, Daemon  # noqa: E402

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
            self.assertIn("has taken no picture yet", self.daemon.visum("camera", "camera", "-o", file, expect=1).stderr)
            self.assertIn("takes no pictures", self.daemon.visum("camera", "eye", "-o", file, expect=2).stderr)
            self.daemon.visum("step", 500)
            told = json.loads(self.daemon.visum("camera", "camera", "-o", file, "--json").stdout)
            self.assertEqual((told["width"], told["height"], told["shows"], told["taken_s"]), (640, 480, "color", 0.45))
            first = file.read_bytes()
            self.assertTrue(first.startswith(b"\x89PNG"))
            self.daemon.visum("reset")
            self.daemon.visum("step", 500)
            self.daemon.visum("camera", "camera", "-o", file)
            self.assertEqual(file.read_bytes(), first)


class Libraries(unittest.TestCase):
    def loaded_by(self, daemon):
        files = {line.split()[-1] for line in pathlib.Path(f"/proc/{daemon.process.pid}/maps").read_text().splitlines()}
        return {pathlib.Path(file).name.split(".so")[0] for file in files if ".so" in file}

    def test_they_are_loaded_where_they_are_needed_and_only_there(self):
        with Daemon("--http", "off") as daemon:
            loaded = self.loaded_by(daemon)
            self.assertIn("libyaml-cpp", loaded)
            self.assertFalse({"libode", "libembree3", "libtbb", "libfcl", "liboctomap", "libprotobuf", "libssl", "libcrypto"} & loaded, loaded)
        with Daemon("--http", "off", scene=SCENE) as daemon:
            self.assertIn("libembree3", self.loaded_by(daemon))
        with Daemon("--http", "off", "--engine", "ode") as daemon:
            self.assertIn("libode", self.loaded_by(daemon))

    def test_a_server_without_the_ray_tracer_says_so_where_it_is_needed(self):
        with tempfile.TemporaryDirectory() as folder:
            (pathlib.Path(folder) / "libembree3.so.3").write_text("no library")
            environment = os.environ | {"LD_LIBRARY_PATH": folder}
            done = subprocess.run([BIN / "visumd", SCENE, "--port", "0", "--http", "off"], env=environment,
                                  capture_output=True, text=True, timeout=60)
            self.assertRegex(done.stderr, r"the ray tracer \(Embree\) cannot be loaded: .*libembree3\.so\.3: file too short")
            self.assertEqual(done.returncode, 2)
            subprocess.run([BIN / "visumd", "--version"], env=environment, check=True, timeout=60, capture_output=True)

    def test_a_scene_whose_engine_is_missing_is_refused_with_the_reason(self):
        with tempfile.TemporaryDirectory() as folder:
            (pathlib.Path(folder) / "libode.so.8").write_text("no library")
            done = subprocess.run([BIN / "visumd", ARM, "--port", "0", "--engine", "ode"], env=os.environ | {"LD_LIBRARY_PATH": folder},
                                  capture_output=True, text=True, timeout=60)
            self.assertRegex(done.stdout + done.stderr, r"the engine ODE cannot be loaded: .*libode\.so\.8: file too short")
            self.assertEqual(done.returncode, 2)


if __name__ == "__main__":
    unittest.main()
