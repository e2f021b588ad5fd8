"""Runs tests/corpus/run on models of our own: one that loads and runs, one with two causes, and files that are no models."""
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
BIN = pathlib.Path(os.environ.get("VISUM_BIN", SOURCE / "build" / "dev" / "bin"))
LINK = ("<link name='{}'><inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/>"
        "</inertial></link>")
GOOD = ("<robot name='r'>" + LINK.format("a") + LINK.format("b") +
        "<joint name='j' type='continuous'><parent link='a'/><child link='b'/><axis xyz='0 1 0'/></joint></robot>")


class Corpus(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def run_on(self, *words):
        return subprocess.run([sys.executable, SOURCE / "tests" / "corpus" / "run", "--bin", BIN, *words],
                              capture_output=True, text=True, timeout=600)

    def without_speeds(self, done):
        return [line for line in done.stdout.splitlines() if "times real time" not in line]

    def test_counts_what_loads_what_is_refused_and_what_runs(self):
        models = self.folder / "models"
        models.mkdir()
        (models / "good.urdf").write_text(GOOD)
        (models / "bad.urdf").write_text(GOOD.replace("'continuous'", "'planar'"))
        (models / "other.sdf").write_text("<element name='x'/>")
        (models / "hanging.xml").write_text(
            "<mujoco><worldbody><body name='b'><joint name='j'/><geom size='0.1'/></body></worldbody></mujoco>")
        (models / "other.xml").write_text("<package/>")
        done = self.run_on(str(models), "--json", str(self.folder / "table.json"))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(self.without_speeds(self.run_on(str(models), "--wrap", "--peer", "URDF=grep -q continuous")),
                         [*self.without_speeds(done)[:1], "  1 of 1 that the other program loads (100 %)",
                          self.without_speeds(done)[1] + " (other: refuses)", *self.without_speeds(done)[2:]],
                         "a scene around it changes nothing")
        self.assertEqual(done.stdout.count(", times real time: least "), 4)
        self.assertEqual(self.without_speeds(done), [
            "URDF: 1 of 2 files load (50 %)",
            "      1  refused: joints of type '*' are not simulated (revolute, continuous, prismatic, fixed, "
            "floating are)",
            "      1  impulse, 2 s: ran",
            "      1  ode, 2 s: ran",
            "MJCF: 1 of 1 files load (100 %)",
            "      1  impulse, 2 s: ran",
            "      1  ode, 2 s: ran"])
        results = json.loads((self.folder / "table.json").read_text())
        self.assertEqual([len(result["causes"]) for result in results], [1, 0, 0])

    def test_refuses_a_folder_that_does_not_exist(self):
        done = self.run_on(str(self.folder / "none"))
        self.assertEqual(done.returncode, 1)
        self.assertIn("no folder", done.stderr)


if __name__ == "__main__":
    unittest.main()
