"""visum campaign, visum run --shard, visum report merge: real runs, one report wherever they were made."""
import csv
import json
import pathlib
import shutil
import signal
import sqlite3
import subprocess
import tempfile
import textwrap
import time
import unittest

from programs import BIN, DEADLINE_S, processes_with, visum
from sweep_test import SLIDE, WORLD

# A box that slides comes v^2 / (2 mu g) far: more than 0.3 m if v^2 > 5.886 mu.
SAMPLED = """
    until: {at_s: 0.2}
    sweep: {friction: {uniform: [0.2, 1]}, speed: {normal: [1, 0.2], between: [0.5, 1.5]}}
    sampling: {method: sobol, runs: 24, seed: 3}
    parameters: {friction: "${friction}", speed: "${speed}"}
    checks:
      - {name: near, that: {position: {body: box, axis: x}, below: 0.08}, when: always}
"""


class Campaign(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory(prefix="visum_campaign_test_")))
        self.report = self.folder / "report"

    def write(self, text, world=WORLD):
        (self.folder / "world.yaml").write_text(textwrap.dedent(world))
        file = self.folder / "scenario.yaml"
        file.write_text("visum_scenario: 1\nname: slide\nscene: world.yaml\n" + textwrap.dedent(text))
        return file

    def campaign(self, file, *options, expect=0, report=None):
        done = visum("campaign", file, "--report", report or self.report, "--json", *options, expect=expect)
        self.assertEqual(processes_with(str(self.folder)), [])
        return json.loads(done.stdout)

    def rows(self, folder=None):
        with open((folder or self.report) / "results.csv", newline="") as file:
            return list(csv.DictReader(file))

    def test_a_campaign_has_figures_and_files(self):
        result = self.campaign(self.write(SLIDE), expect=1)
        self.assertEqual({name: result[name] for name in ("runs", "passed", "failed", "invalid", "reused", "pass_rate", "decision")},
                         {"runs": 4, "passed": 3, "failed": 1, "invalid": 0, "reused": 0, "pass_rate": 0.75, "decision": None})
        self.assertLess(result["low"], 0.75)
        self.assertGreater(result["high"], 0.75)
        self.assertEqual(sorted(file.name for file in self.report.iterdir()),
                         ["report.html", "results.csv", "results.sqlite", "run_2.mcap", "summary.json"])
        rows = self.rows()
        self.assertEqual([(row["run"], row["friction"], row["speed"], row["check"]) for row in rows[:3]],
                         [("1", "0.5", "1", "near"), ("1", "0.5", "1", "as computed"), ("2", "0.5", "2", "near")])
        self.assertEqual([row["check_passed"] for row in rows if row["run"] == "2"], ["0", "1"])
        replayed = visum("replay", self.report / "run_2.mcap", "--json")
        self.assertTrue(json.loads(replayed.stdout)["equal"])
        page = (self.report / "report.html").read_text()
        self.assertNotRegex(page, r"https?:|src=|<link|<script|url\(|@import")
        self.assertIn("friction=0.5, speed=2", page)
        self.assertRegex(page, 'aria-label="Runs that passed over (friction and speed|speed and friction)"')
        self.assertIn('<a href="run_2.mcap"><rect', page, "a cell leads to a recording")
        with sqlite3.connect(self.report / "results.sqlite") as results:
            self.assertEqual(results.execute("SELECT COUNT(*) FROM runs").fetchone(), (4,))

    def test_the_same_wherever_it_runs(self):
        file = self.write(SAMPLED)
        whole = self.campaign(file, "--jobs", 2, expect=1)
        for index in (1, 2, 3):
            visum("run", file, "--shard", f"{index}/3", "--report", self.folder / f"shard_{index}", "--jobs", 2, expect=1)
        shards = [self.folder / f"shard_{index}" for index in (3, 1, 2)]
        merged = json.loads(visum("report", "merge", *shards, "-o", self.folder / "merged", "--json").stdout)
        self.assertEqual(merged, {"runs": 24, "missing": [], "doubled": [], "foreign": [], "hash": whole["hash"]})
        self.assertEqual(self.rows(), self.rows(self.folder / "merged"))
        self.assertEqual(len({row["state_hash"] for row in self.rows()}), 24)
        self.assertIn("shard_", next(row[0] for row in sqlite3.connect(self.folder / "merged" / "results.sqlite").execute(
            "SELECT recording FROM runs WHERE code = 1")), "where the shard's recording lies")

    def test_a_scenario_without_a_sweep_is_a_campaign_of_one(self):
        result = self.campaign(self.write("until: {at_s: 0.1}\nchecks: [{that: {speed: {body: box}, above: 0.1}}]\n"))
        self.assertEqual((result["runs"], self.rows()[0]["run"]), (1, "1"))

    def test_one_of_its_runs_alone_is_the_same(self):
        file = self.write(SAMPLED)
        self.campaign(file, expect=1)
        row = self.rows()[16]
        alone = visum("run", file, "--only", row["run"], "--json", expect=int(row["code"]))
        self.assertEqual(json.loads(alone.stdout.splitlines()[-1])["state_hash"], row["state_hash"])

    def test_the_clusters_environment_chooses_the_shard(self):
        file = self.write(SLIDE)
        visum("run", file, "--shard", "--report", self.report,
              env={"SLURM_ARRAY_TASK_ID": "7", "SLURM_ARRAY_TASK_MIN": "6", "SLURM_ARRAY_TASK_COUNT": "4"}, expect=1)
        self.assertEqual({row["run"] for row in self.rows()}, {"2"})
        refused = visum("run", file, "--shard", "--report", self.report, expect=2)
        self.assertIn("VISUM_SHARD", refused.stderr)
        self.assertIn("--report", visum("run", file, "--shard", "1/2", expect=2).stderr)

    def test_a_few_of_ten_million(self):
        file = self.write(SAMPLED.replace("runs: 24", "runs: 10000000").replace("below: 0.08", "below: 9"))
        visum("run", file, "--shard", "999998/1000000", "--report", self.report, "--recordings", "off", "--json")
        self.assertEqual(len(self.rows()), 10)

    def test_nothing_is_done_twice(self):
        file = self.write(SLIDE)
        first = self.campaign(file, expect=1)
        again = self.campaign(file, expect=1)
        self.assertEqual((again["reused"], again["hash"]), (4, first["hash"]))
        self.assertEqual(self.campaign(file, "--fresh", expect=1)["reused"], 0)

    def test_only_what_changed_is_done_again(self):
        file = self.write(SLIDE)
        self.campaign(file, expect=1)
        more = self.campaign(self.write(SLIDE.replace("[0.5, 1]", "[0.5, 0.75, 1]")), expect=1)
        self.assertEqual((more["runs"], more["reused"]), (6, 4))
        self.assertEqual([row["friction"] for row in self.rows()[::4]], ["0.5", "0.75", "1"])
        other_scene = self.campaign(self.write(SLIDE, WORLD.replace("mass: 1,", "mass: 1.5,")), expect=1)
        self.assertEqual(other_scene["reused"], 0)
        self.assertEqual(self.campaign(self.write(SLIDE, WORLD.replace("mass: 1,", "mass: 1.5,")), expect=1)["reused"], 4)

    def test_a_controllers_program_counts(self):
        script = self.folder / "controller.sh"
        text = """
            sweep: {again: [1, 2]}
            controllers: [{name: c, shim: true, exchanges: false, command: [sh, "{scenario_dir}/controller.sh"]}]
        """
        script.write_text("sleep 0.05\nexit 0\n")
        file = self.write(text)
        self.campaign(file)
        self.assertEqual(self.campaign(file)["reused"], 2)
        script.write_text("sleep 0.05\nexit 1\n")
        changed = self.campaign(file, expect=1)
        self.assertEqual((changed["reused"], changed["failed"]), (0, 2))

    def test_a_recording_that_is_gone_is_made_again(self):
        file = self.write(SLIDE)
        self.campaign(file, expect=1)
        (self.report / "run_2.mcap").unlink()
        self.assertEqual(self.campaign(file, expect=1)["reused"], 3)
        self.assertTrue((self.report / "run_2.mcap").exists())

    def test_killed_at_any_moment_it_goes_on(self):
        file = self.write(SAMPLED.replace("runs: 24", "runs: 60"))
        whole = self.campaign(file, expect=1, report=self.folder / "whole")
        words = [BIN / "visum", "campaign", file, "--report", self.report, "--jobs", "2"]
        killed = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        log = self.report / "results.sqlite-wal"
        until = time.monotonic() + DEADLINE_S
        while not (log.exists() and log.stat().st_size > 100_000) and time.monotonic() < until and killed.poll() is None:
            time.sleep(0.01)
        killed.kill()
        killed.wait()
        while processes_with(str(file)) and time.monotonic() < until:
            time.sleep(0.01)
        rest = self.campaign(file, expect=1)
        self.assertGreater(rest["reused"], 0)
        self.assertEqual(rest["hash"], whole["hash"])

    def test_a_full_disk_is_no_verdict_and_loses_no_run(self):
        file = self.write(SAMPLED.replace("runs: 24", "runs: 40"))
        whole = self.campaign(file, "--no-recordings", expect=1, report=self.folder / "whole")
        self.report.mkdir()
        mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=160k", "tmpfs", self.report], capture_output=True, text=True)
        if mounted.returncode != 0:
            self.skipTest(f"no mount: {mounted.stderr.strip()}")
        try:
            full = visum("campaign", file, "--report", self.report, "--no-recordings", "--jobs", 2, expect=6)
            self.assertIn("the disk is full", full.stderr)
            subprocess.run(["mount", "-o", "remount,size=8m", self.report], check=True)
            rest = self.campaign(file, "--no-recordings", expect=1)
        finally:
            subprocess.run(["umount", self.report], check=True)
        self.assertGreater(rest["reused"], 0)
        self.assertEqual(rest["hash"], whole["hash"])

    def test_results_that_are_no_results(self):
        file = self.write(SLIDE)
        self.campaign(file, expect=1)
        good = (self.report / "results.sqlite").read_bytes()
        for damaged, said in ((good[:100], "holds no results that can be read"), (b"half" * 1000, "holds no results that can be read"),
                              (good[:4096] + b"x" * (len(good) - 4096), "holds no results that can be read")):
            (self.report / "results.sqlite").write_bytes(damaged)
            self.assertIn(said, visum("campaign", file, "--report", self.report, expect=6).stderr)
            self.assertEqual((self.report / "results.sqlite").read_bytes()[4096:], damaged[4096:], "what is there is left to its owner")
        (self.report / "results.sqlite").write_bytes(good)
        with sqlite3.connect(self.report / "results.sqlite") as results:
            results.execute("UPDATE head SET version = 2")
        results.close()
        self.assertIn("results of version 2", visum("campaign", file, "--report", self.report, expect=2).stderr)

    def test_shards_of_another_build_are_foreign(self):
        file = self.write(SLIDE)
        for index in (1, 2):
            visum("run", file, "--shard", f"{index}/2", "--report", self.folder / f"shard_{index}", expect=1 if index == 2 else 0)
        with sqlite3.connect(self.folder / "shard_2" / "results.sqlite") as results:
            results.execute("UPDATE head SET build = '0.1.0 0123456789abcdef'")
        results.close()
        refused = visum("report", "merge", self.folder / "shard_1", self.folder / "shard_2", "-o", self.folder / "merged", "--json", expect=1)
        told = json.loads(refused.stdout)
        self.assertEqual(told["missing"], [2, 4])
        self.assertIn("another build (0.1.0 0123456789abcdef, not", told["foreign"][0])
        self.assertFalse((self.folder / "merged").exists())

    def test_recordings_of_all(self):
        file = self.write(SLIDE)
        self.campaign(file, "--all-recordings", expect=1)
        self.assertEqual(sorted(recording.name for recording in self.report.glob("*.mcap")), [f"run_{run}.mcap" for run in (1, 2, 3, 4)])
        self.assertEqual(self.campaign(file, "--all-recordings", expect=1)["reused"], 4)

    def test_a_page_shows_how_far_it_is(self):
        file = self.write(SAMPLED.replace("runs: 24", "runs: 100000"))
        words = [BIN / "visum", "campaign", file, "--report", self.report, "--jobs", "1", "--no-recordings"]
        running = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        until = time.monotonic() + DEADLINE_S
        page = ""
        while "runs/s, about" not in page and running.poll() is None and time.monotonic() < until:
            time.sleep(0.01)
            page = (self.report / "report.html").read_text() if (self.report / "report.html").exists() else ""
        running.send_signal(signal.SIGINT)
        running.wait()
        self.assertIn("of 100000 runs", page)
        self.assertIn("http-equiv=\"refresh\"", page)
        self.assertNotIn("refresh", (self.report / "report.html").read_text(), "the report of what was made")
        self.assertFalse((self.report / "progress.json").exists())

    def test_two_in_one_folder(self):
        slow = """
            sweep: {again: [1, 2]}
            controllers: [{name: c, joins: false, exchanges: false, command: [sleep, "100"]}]
        """
        file = self.write(slow)
        words = [BIN / "visum", "campaign", file, "--report", self.report, "--jobs", "1"]
        first = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        until = time.monotonic() + DEADLINE_S
        while not (set(processes_with("--worker")) & set(processes_with(str(file)))) and time.monotonic() < until:
            time.sleep(0.01)
        second = visum("campaign", file, "--report", self.report, expect=6)
        self.assertIn("another run writes to it now", second.stderr)
        first.send_signal(signal.SIGINT)
        self.assertIn("interrupted", first.communicate(timeout=DEADLINE_S)[1])
        self.assertEqual(first.returncode, 130)

    def test_a_claim_is_decided(self):
        claim = "decide: {at_least: 0.9, reject_below: 0.5}\n"
        accepted = self.campaign(self.write(SAMPLED.replace("below: 0.08", "below: 9").replace("runs: 24", "runs: 1000000") + "    " + claim), "--jobs", 2)
        self.assertEqual((accepted["decision"], accepted["runs"]), ("accepted", 6))
        one_by_one = self.campaign(self.folder / "scenario.yaml", "--jobs", 1, "--fresh", report=self.folder / "other")
        self.assertEqual(one_by_one["hash"], accepted["hash"])
        rejected = self.campaign(self.write(SAMPLED.replace("below: 0.08", "below: -9") + "    " + claim), expect=1)
        self.assertEqual((rejected["decision"], rejected["runs"]), ("rejected", 2))
        undecided = self.campaign(self.write(SAMPLED.replace("below: 0.08", "below: 9").replace("runs: 24", "runs: 5") + "    " + claim), expect=6)
        self.assertEqual(undecided["decision"], "undecided")

    def test_equal_runs_that_differ_are_a_defect(self):
        text = f"""
            sweep: {{again: [1, 2, 3]}}
            controllers:
              - {{name: c, joins: false, exchanges: false, command: [sh, -c, '"{BIN}/visum" push box $$ 0 0 --connect {{connect}}']}}
            settle_s: 0.1
        """
        result = self.campaign(self.write(text), expect=6)
        self.assertEqual((result["invalid"], result["nondeterministic"]), (3, [1, 2, 3]))

    def test_mistakes_are_told(self):
        self.assertIn("decide.reject_below", visum("campaign", self.write(SLIDE + "    decide: {at_least: 0.9, reject_below: 0.95}\n"),
                                                   "--report", self.report, expect=3).stderr)
        self.assertIn("is for single runs", visum("campaign", self.write(SLIDE + "    record: a.mcap\n"), "--report", self.report,
                                                  expect=3).stderr)
        self.assertIn("takes more", visum("run", self.write(SAMPLED.replace("runs: 24", "runs: 10001")), expect=3).stderr)
        self.assertIn("holds no results.sqlite", visum("report", "merge", self.folder, "-o", self.report, expect=2).stderr)
        self.assertFalse(self.report.exists())


if __name__ == "__main__":
    unittest.main()
