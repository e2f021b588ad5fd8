"""A recording that Visum 0.2.0 wrote is read by this build.

data/version_0_2.mcap.xz was written by version 0.2.0 (commit 3d5a3ea8) with `visum run --record`, and data/version_0_2.csv.xz
by its `visum export`. An arm of one link and a ball that falls, for 0.3 s: after 20 ms the angle is commanded, after 120 ms the
encoder sticks. The file holds the scene. Its chunks are plain, every tick has a hash, and all states are of that build.
"""

import csv
import json
import lzma
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

BIN = Path(os.environ["VISUM_BIN"])
DATA = Path(__file__).resolve().parent / "data"
TICKS = 300
COMMIT = "3d5a3ea8"


def visum(*words: object) -> subprocess.CompletedProcess:
    return subprocess.run([BIN / "visum", *map(str, words)], capture_output=True, text=True, timeout=240)


class OldVersion(unittest.TestCase):
    def setUp(self) -> None:
        folder = Path(self.enterContext(tempfile.TemporaryDirectory(prefix="visum_old_version_test_")))
        self.file = folder / "version_0_2.mcap"
        self.file.write_bytes(lzma.decompress((DATA / "version_0_2.mcap.xz").read_bytes()))
        text = lzma.decompress((DATA / "version_0_2.csv.xz").read_bytes()).decode()
        self.rows = list(csv.DictReader(text.splitlines()))

    def test_its_ports_are_exported_with_the_same_digits(self) -> None:
        done = visum("export", self.file)
        self.assertEqual(done.returncode, 0, done.stderr)
        ours = list(csv.DictReader(done.stdout.splitlines()))
        self.assertEqual(len(self.rows), TICKS)
        self.assertEqual([{name: row[name] for name in self.rows[0]} for row in ours], self.rows)

    def test_its_inputs_are_replayed_and_a_difference_is_put_down_to_the_build(self) -> None:
        done = visum("replay", self.file, "--json")
        self.assertIn(done.returncode, (0, 5), done.stdout + done.stderr)
        said = json.loads(done.stdout)
        self.assertEqual(said["damage"], "")
        if not said["equal"]:
            self.assertIn(COMMIT, said["difference"]["other_build"])

    def test_it_is_compared_to_its_last_tick(self) -> None:
        done = visum("compare", self.file, self.file)
        self.assertEqual((done.returncode, done.stdout), (0, f"equal: all {TICKS} ticks\n"), done.stderr)

    def test_it_is_shown_without_its_states(self) -> None:
        with subprocess.Popen([BIN / "visum", "replay", self.file, "--view", "--json"], stdout=subprocess.PIPE,
                              stderr=subprocess.DEVNULL, text=True) as shown:
            try:
                server = ("--connect", f"127.0.0.1:{json.loads(shown.stdout.readline())['port']}")
                for tick in (TICKS, 15, 121):
                    self.assertEqual(visum("param-set", "recording", "Position", tick, *server).returncode, 0)
                    ports = json.loads(visum("get", "arm", "Actual Angle 1", "Desired Angle 1", "--json", *server).stdout)["ports"]
                    self.assertEqual({name: float(self.rows[tick - 1][f"arm/{name}"]) for name in ports}, ports)
            finally:
                shown.terminate()


if __name__ == "__main__":
    unittest.main()
