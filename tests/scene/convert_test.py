"""Runs `visum convert`, also on files of X3D and VRML that are wrong in one way each, with their error beside them.

    VISUM_WRITE_ERRORS=1 python3 -m unittest convert_test    writes the errors anew, to be read before they are kept
"""
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

from check_test import BIN, SOURCE, limit

BAD = SOURCE / "tests" / "scene" / "bad_x3d"


def convert(*words, cwd=SOURCE):
    return subprocess.run([BIN / "visum", "convert", *map(str, words)], cwd=cwd, capture_output=True, text=True,
                          errors="replace", preexec_fn=limit, timeout=600)


class Convert(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.to = pathlib.Path(self.folder.name)

    def test_tells_what_is_lost_and_ends_with_1(self):
        done = convert("models/scenes/cart.yaml", self.to / "cart.x3d")
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("X3D has no panels\n", done.stdout)
        self.assertIn("is written, without what is listed above", done.stdout)

    def test_what_loses_nothing_ends_with_0(self):
        done = convert("models/scenes/amtec_arm.yaml", self.to / "arm.yaml", "--json")
        self.assertEqual((done.returncode, json.loads(done.stdout)["losses"]), (0, []), done.stderr)
        self.assertEqual(convert(self.to / "arm.yaml", self.to / "again.yaml").returncode, 0)
        first, again = ((self.to / name).read_text().splitlines()[1:] for name in ("arm.yaml", "again.yaml"))
        self.assertEqual([line.replace("arm.yaml_files", "again.yaml_files") for line in first], again)

    def test_reads_a_bare_model_as_check_does_and_finds_its_packages(self):
        part = self.to / "elsewhere" / "part"
        part.mkdir(parents=True)
        (part / "box.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n")
        robot = self.to / "robot.urdf"
        robot.write_text("<robot name='r'><link name='a'><collision><geometry>"
                         "<mesh filename='package://part/box.obj'/></geometry></collision></link></robot>")
        self.assertEqual(convert(robot, self.to / "robot.yaml").returncode, 3)
        done = convert(robot, self.to / "robot.yaml", "--package", f"part={part}")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn('name: "floor"', (self.to / "robot.yaml").read_text())

    def test_what_it_writes_can_be_checked(self):
        for scene in ("cart", "crawler", "amtec_arm"):
            with self.subTest(scene):
                self.assertEqual(convert(f"models/scenes/{scene}.yaml", self.to / "out.sdf").returncode, 1)
                done = subprocess.run([BIN / "visum", "check", self.to / "out.sdf", "--json"], capture_output=True,
                                      text=True, timeout=600)
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertTrue(json.loads(done.stdout)["actuated"])

    def test_wrong_usage_is_no_wrong_scene(self):
        self.assertEqual(convert("a.yaml").returncode, 2)
        self.assertEqual(convert("models/scenes/cart.yaml", self.to / "cart.doc").returncode, 3)
        self.assertEqual(convert("models/scenes/cart.yaml", self.to / "missing" / "cart.x3d").returncode, 3)

    def test_each_bad_file_says_what_is_wrong_and_where(self):
        files = sorted(file for file in BAD.iterdir() if file.suffix != ".error")
        self.assertGreaterEqual(len(files), 15)
        for file in files:
            with self.subTest(file.name):
                done = convert(file.name, self.to / "out.yaml", cwd=BAD)
                self.assertEqual(done.returncode, 3, done.stdout + done.stderr)
                self.assertEqual(done.stdout, "")
                self.assertFalse((self.to / "out.yaml").exists())
                expected = file.with_suffix(file.suffix + ".error")
                if os.environ.get("VISUM_WRITE_ERRORS"):
                    expected.write_text(done.stderr)
                self.assertEqual(done.stderr, expected.read_text())


if __name__ == "__main__":
    unittest.main()
