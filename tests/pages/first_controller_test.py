#!/usr/bin/python3
"""The controller of the main README: it compiles as README says, and moves the arm under each clock."""

from __future__ import annotations

import json
import os
import re
import subprocess
import tempfile
import unittest
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]
BIN = Path(os.environ.get("VISUM_BIN", SOURCE / "build" / "dev" / "bin")).resolve()
SCENE = SOURCE / "models" / "scenes" / "amtec_arm.yaml"
TIMEOUT_S = 120  # a guard against hanging, not a measure


@contextmanager
def running_daemon(clock: str) -> Iterator[str]:
    command = [BIN / "visumd", SCENE, "--clock", clock, "--port", "0", "--http", "off", "--json"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as daemon:
        try:
            assert daemon.stdout is not None
            yield f"127.0.0.1:{json.loads(daemon.stdout.readline())['port']}"
        finally:
            daemon.terminate()


def first_joint_rad(address: str) -> float:
    get = [BIN / "visum", "get", "arm", "Actual Angle 1", "--connect", address]
    return float(subprocess.run(get, check=True, capture_output=True, text=True, timeout=TIMEOUT_S).stdout)


class FirstController(unittest.TestCase):
    def test_turns_the_first_joint_and_releases_the_arm(self):
        for clock in ("lockstep", "realtime", "free"):
            with self.subTest(clock), running_daemon(clock) as address:
                subprocess.run([BIN / "visum-first-controller", address], check=True, timeout=TIMEOUT_S)
                self.assertGreaterEqual(first_joint_rad(address), 0.49)
                parts = subprocess.run([BIN / "visum", "parts", "--connect", address], check=True,
                                       capture_output=True, text=True, timeout=TIMEOUT_S).stdout
                self.assertRegex(parts, r"(?m)^arm\s.*free")

    @unittest.skipIf(os.environ.get("VISUM_SANITIZE"), "an outside program would need the sanitizer's library")
    def test_compiles_as_readme_says(self):
        found = re.search(r"(?m)^c\+\+ (?:.*\\\n)*.*$", (SOURCE / "README.md").read_text())
        self.assertTrue(found, "README.md has no line that begins with c++")
        subprocess.run(["cmake", "--build", BIN.parent, "--target", "visum_client_shared"], check=True,
                       stdout=subprocess.DEVNULL)
        with tempfile.TemporaryDirectory() as folder:
            program = f"{folder}/first_controller"
            command = found.group(0).replace("-o first_controller", f"-o {program}")
            command = command.replace("$PWD/build/release", str(BIN.parent)).replace("build/release", str(BIN.parent))
            subprocess.run(["sh", "-c", command], cwd=SOURCE, check=True, timeout=TIMEOUT_S)
            with running_daemon("lockstep") as address:
                subprocess.run([program, address], check=True, timeout=TIMEOUT_S)
                self.assertGreaterEqual(first_joint_rad(address), 0.49)


if __name__ == "__main__":
    unittest.main()
