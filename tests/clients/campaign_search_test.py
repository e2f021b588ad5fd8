"""visum campaign with `search:`: real runs, the same wherever it ran, and a worst case that repeats."""
import json
import pathlib
import shutil
import signal
import subprocess
import tempfile
import textwrap
import time
import unittest

from programs import BIN, DEADLINE_S, processes_with, visum
from sweep_test import WORLD

# A box that slides comes v^2 / (2 mu g) far: at most 0.5734 m here, for the fastest on the slipperiest floor.
SEARCHED = """
    until: {at_s: 1}
    check_every_ms: 100
    sweep: {friction: {uniform: [0.2, 1]}, speed: {uniform: [0.5, 1.5]}}
    sampling: {method: latin_hypercube, runs: 12, seed: 3}
    parameters: {friction: "${friction}", speed: "${speed}"}
    checks:
      - {name: near, that: {position: {body: box, axis: x}, below: 0.45}}
      - {name: upright, that: {tilt: {body: box}, below: 0.1}}
    search: {check: near, runs: 48, seed: 1}
"""


class Search(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory(prefix="visum_search_test_")))
        self.report = self.folder / "report"

    def write(self, text):
        (self.folder / "world.yaml").write_text(textwrap.dedent(WORLD))
        file = self.folder / "scenario.yaml"
        file.write_text("visum_scenario: 1\nname: slide\nscene: world.yaml\n" + textwrap.dedent(text))
        return file

    def campaign(self, file, *options, expect=1, report=None):
        done = visum("campaign", file, "--report", report or self.report, "--json", *options, expect=expect)
        self.assertEqual(processes_with(str(self.folder)), [])
        return json.loads(done.stdout)

    def test_finds_what_samples_do_not(self):
        result = self.campaign(self.write(SEARCHED), "--jobs", 2)
        search = result["search"]
        self.assertEqual((result["runs"], result["failed"]), (12, 0), "the samples are too few to meet the corner")
        self.assertEqual((search["check"], search["runs"], search["invalid"]), ("near", 48, 0))
        self.assertGreater(search["broken"], 0)
        self.assertLess(search["margin"], 0)
        self.assertGreater(search["margin"], 0.45 - 0.58)
        self.assertGreater(search["worst_run"], 12)
        page = (self.report / "report.html").read_text()
        self.assertIn("<h2>Search</h2>", page)
        # The worst case stands by itself, anywhere.
        moved = self.folder / "elsewhere"
        moved.mkdir()
        shutil.copy(self.report / "worst.yaml", moved / "worst.yaml")
        alone = json.loads(visum("run", moved / "worst.yaml", "--json", expect=1).stdout.splitlines()[-1])
        replayed = json.loads(visum("replay", self.report / "worst.mcap", "--json").stdout)
        self.assertTrue(replayed["equal"])
        compared = json.loads(visum("run", self.folder / "scenario.yaml", "--values",
                                    "{" + search["values"].replace("=", ": ") + "}", "--json", expect=1).stdout.splitlines()[-1])
        self.assertEqual(compared["state_hash"], alone["state_hash"])

    def test_the_same_with_any_jobs_and_where_it_was_interrupted(self):
        file = self.write(SEARCHED.replace("runs: 48", "runs: 24"))
        first = self.campaign(file, "--jobs", 3, "--no-recordings")
        again = self.campaign(file, "--jobs", 1, "--no-recordings")
        self.assertEqual((again["reused"], again["search"]["reused"]), (12, 24), "nothing is done twice")
        other = self.folder / "other"
        words = [BIN / "visum", "campaign", file, "--report", other, "--jobs", "1", "--no-recordings"]
        killed = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        until = time.monotonic() + DEADLINE_S
        page = other / "report.html"
        while not (page.exists() and "search, " in page.read_text()) and killed.poll() is None and time.monotonic() < until:
            time.sleep(0.01)
        killed.send_signal(signal.SIGKILL)
        killed.wait()
        while processes_with(str(file)) and time.monotonic() < until:
            time.sleep(0.01)
        rest = self.campaign(file, "--jobs", 2, "--no-recordings", report=other)
        self.assertEqual(rest["reused"], 12)
        shards = self.campaign(file, "--on", "shell", "--shards", 3, "--command", "{command}", "--no-recordings",
                               report=self.folder / "shards")
        for result in (again, rest, shards):
            self.assertEqual(result["hash"], first["hash"])
            self.assertEqual(result["search"]["hash"], first["search"]["hash"])
            self.assertEqual(result["search"]["values"], first["search"]["values"])

    def test_ends_once_the_check_is_broken(self):
        result = self.campaign(self.write(SEARCHED.replace("seed: 1}", "seed: 1, until: broken}")), "--no-recordings")
        self.assertLess(result["search"]["runs"], 48)
        self.assertGreater(result["search"]["broken"], 0)

    def test_what_cannot_be_broken_passes(self):
        result = self.campaign(self.write(SEARCHED.replace("below: 0.45", "below: 0.6").replace("runs: 48", "runs: 12")),
                               "--no-recordings", expect=0)
        self.assertEqual(result["search"]["broken"], 0)
        self.assertGreater(result["search"]["margin"], 0)

    def test_values_are_checked(self):
        file = self.write(SEARCHED)
        self.assertIn("the sweep has no such name", visum("run", file, "--values", "{friction: 1, sped: 1}", expect=3).stderr)
        self.assertIn("speed", visum("run", file, "--values", "{friction: 1}", expect=3).stderr)


if __name__ == "__main__":
    unittest.main()
