"""The wheel of the Python client, in environments of their own: it installs without a network, and says what it lacks."""
import os
import pathlib
import subprocess
import tempfile
import unittest

from programs import ARM, BIN, DEADLINE_S

PYTHON = "/usr/bin/python3"
LAUNCH = "import sys, visum; client = visum.launch(sys.argv[1], program=sys.argv[2]); print(visum.__file__, client.part_names())"


def run(*words, **more):
    environment = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "PYTHONDONTWRITEBYTECODE")}
    return subprocess.run(list(map(str, words)), capture_output=True, text=True, timeout=4 * DEADLINE_S, env=environment, **more)


class Wheel(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        build = BIN.parent
        made = run("cmake", "--build", build, "--target", "visum_wheel")
        assert made.returncode == 0, made.stdout + made.stderr
        cls.wheel, = (build / "dist").glob("visum-*.whl")

    def environment(self, name, *options):
        """A virtual environment with the wheel in it; returns its Python."""
        python = pathlib.Path(self.folder.name) / name / "bin" / "python"
        made = run(PYTHON, "-m", "venv", *options, python.parents[1])
        self.assertEqual(made.returncode, 0, made.stdout + made.stderr)
        return python

    def install(self, python, *options):
        return run(python, "-m", "pip", "--disable-pip-version-check", "install", "--no-index", *options, self.wheel)

    def test_it_installs_without_a_network_and_launches_the_arm(self):
        python = self.environment("with-debians-protobuf", "--system-site-packages")
        installed = self.install(python)
        self.assertEqual(installed.returncode, 0, installed.stdout + installed.stderr)
        launched = run(python, "-c", LAUNCH, ARM, BIN / "visumd", cwd=self.folder.name)
        self.assertEqual(launched.returncode, 0, launched.stderr)
        self.assertIn("with-debians-protobuf", launched.stdout)
        self.assertIn("['arm']", launched.stdout)

    def test_pip_asks_for_protobuf_where_there_is_none(self):
        refused = self.install(self.environment("with-nothing"))
        self.assertNotEqual(refused.returncode, 0)
        self.assertIn("protobuf>=3.20", refused.stdout + refused.stderr)

    def test_without_protobuf_the_client_says_so(self):
        python = self.environment("without-protobuf")
        installed = self.install(python, "--no-deps")
        self.assertEqual(installed.returncode, 0, installed.stdout + installed.stderr)
        imported = run(python, "-c", "import visum", cwd=self.folder.name)
        self.assertNotEqual(imported.returncode, 0)
        self.assertIn(f"the package protobuf is missing for {python}", imported.stderr)

    def test_an_old_protobuf_is_named(self):
        python = self.environment("with-an-old-protobuf")
        self.install(python, "--no-deps")
        packages, = (python.parents[1] / "lib").glob("python3*/site-packages")
        internal = packages / "google" / "protobuf" / "internal"
        internal.mkdir(parents=True)
        (internal / "__init__.py").write_text("")  # before 3.20 it had no `builder`
        imported = run(python, "-c", "import visum", cwd=self.folder.name)
        self.assertIn("the package protobuf is too old", imported.stderr)


if __name__ == "__main__":
    unittest.main()
