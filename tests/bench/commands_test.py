"""The commands that README.md names run as they are written there, with the programs of this build."""

import os
import pathlib
import re
import subprocess
import tempfile
import unittest

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
BIN = os.environ["VISUM_BIN"]


def do(command, *words):
    return subprocess.run([HERE / command, *map(str, words)], cwd="/", capture_output=True, text=True, timeout=500,
                          env={name: value for name, value in os.environ.items() if name not in ("VISUM_BIN", "PYTHONPATH")})


class Commands(unittest.TestCase):
    def test_every_command_of_the_page_may_be_run(self):
        named = set(re.findall(r"^(tests/\S+)", (HERE / "README.md").read_text(encoding="utf-8"), re.MULTILINE))
        self.assertLessEqual({"tests/bench/run", "tests/bench/end_to_end", "tests/bench/lockstep_figures"}, named)
        for command in named:
            self.assertTrue(os.access(ROOT / command, os.X_OK), command)

    def test_lockstep_figures_tells_what_a_sleep_costs(self):
        done = do("lockstep_figures", "--bin", BIN, "--sleeps", 50, "--results", 1, "--kinds", "usleep")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        for line in (r"a sleep of one tick in an empty world .* us", r"a sleep of one tick in the arm's world .* us",
                     r"a step of one tick, for comparison .* us", r"visumd's tick +[0-9.]+ us",
                     r"the serial C program .* x real time", r"usleep +1 runs, 1 distinct"):
            self.assertRegex(done.stdout, line)

    def test_what_is_not_built_is_named(self):
        with tempfile.TemporaryDirectory() as folder:
            for command in ("lockstep_figures", "end_to_end"):
                done = do(command, "--bin", folder)
                self.assertEqual(done.returncode, 1)
                self.assertRegex(done.stderr, f"^{command}: {folder}.*visum.*cmake --build --preset release")

    def test_end_to_end_compares_whole_runs(self):
        with tempfile.TemporaryDirectory() as folder:
            done = do("end_to_end", "--bin", BIN, "--runs", 1, "--record", "--write", "--out", folder, "two_link_wave")
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            (page,) = pathlib.Path(folder).glob("*-end-to-end.md")
            written = page.read_text(encoding="utf-8")
        self.assertIn("\n| two_link_wave | ", written)
        self.assertIn("until it has ended and the file is closed", " ".join(written.split()))

    def test_the_page_that_end_to_end_writes_is_one_for_git(self):
        page = "tests/bench/results/some-machine-2-end-to-end.md"
        ignored = subprocess.run(["git", "-C", ROOT, "check-ignore", "-q", page], check=False).returncode
        self.assertNotEqual(ignored, 0, page)


if __name__ == "__main__":
    unittest.main()
