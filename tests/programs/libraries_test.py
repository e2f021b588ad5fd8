"""Libraries that only some runs need: who loads them, and what a user reads where they are missing."""
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(SOURCE / "tests" / "clients"))
from programs import ARM, BIN, Daemon  # noqa: E402

SENSORS = SOURCE / "models" / "scenes" / "sensors.yaml"
SELDOM_NEEDED = {"libode", "libembree3", "libtbb", "libfcl", "liboctomap", "libprotobuf", "libssl",
                 "libcrypto"}


def loaded_by(daemon):
    maps = pathlib.Path(f"/proc/{daemon.process.pid}/maps").read_text()
    files = {line.split()[-1] for line in maps.splitlines()}
    return {pathlib.Path(file).name.split(".so")[0] for file in files if ".so" in file}


class Libraries(unittest.TestCase):
    def test_they_are_loaded_where_they_are_needed_and_only_there(self):
        with Daemon("--http", "off") as daemon:
            loaded = loaded_by(daemon)
            self.assertIn("libyaml-cpp", loaded)
            self.assertFalse(SELDOM_NEEDED & loaded, loaded)
        with Daemon("--http", "off", scene=SENSORS) as daemon:
            self.assertIn("libembree3", loaded_by(daemon))
        with Daemon("--http", "off", "--engine", "ode") as daemon:
            self.assertIn("libode", loaded_by(daemon))


class MissingLibraries(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))

    def run_without(self, library, *words, expect):
        """The program finds a file of the library's name that is no library. Returns what it says."""
        (self.folder / library).write_text("no library")
        environment = os.environ | {"LD_LIBRARY_PATH": str(self.folder)}
        done = subprocess.run([BIN / words[0], *words[1:]], env=environment, capture_output=True, text=True,
                              timeout=60)
        self.assertEqual(done.returncode, expect, done.stderr)
        return done.stdout + done.stderr

    def test_a_server_without_the_ray_tracer_says_so_where_it_is_needed(self):
        library = "libembree3.so.3"
        said = self.run_without(library, "visumd", SENSORS, "--port", "0", "--http", "off", expect=2)
        self.assertRegex(said, r"the ray tracer \(Embree\) cannot be loaded: .*libembree3\.so\.3: "
                               r"file too short; install libembree3-3")
        self.run_without(library, "visumd", "--version", expect=0)

    def test_an_engine_that_is_missing_is_named_where_it_was_chosen(self):
        reason = r"the engine ODE cannot be loaded: .*libode\.so\.8: file too short; install libode8"
        scene = self.folder / "scene.yaml"
        scene.write_text("visum: 1\nengine: ode\n")
        for words, place, code in ((["visumd", ARM, "--port", "0", "--engine", "ode"], "--engine: ", 2),
                                   (["visumd", scene, "--port", "0"], "scene.yaml:2: engine: ", 3),
                                   (["visum", "check", scene], "scene.yaml:2: engine: ", 3)):
            self.assertRegex(self.run_without("libode.so.8", *words, expect=code), place + reason)


if __name__ == "__main__":
    unittest.main()
