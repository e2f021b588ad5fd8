"""Skips.AreExpected finds a skip in every form, tells it, and fails for one that is not listed, with CI=true alone."""
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import skips

HERE = pathlib.Path(__file__).parent


def block(number, name, output, verdict="Test Passed."):
    line = "-" * 58
    return (f"{number}/9 Testing: {name}\n{number}/9 Test: {name}\nCommand: \"x\"\nDirectory: /x\n\"{name}\" start time: now\nOutput:\n{line}\n"
            f"{output}\n<end of output>\nTest time =   0.15 sec\n{line}\n{verdict}\n\"{name}\" end time: now\n"
            f"\"{name}\" time elapsed: 00:00:00\n{line}\n\n")


LOG = ("Start testing: now\n" + "-" * 58 + "\n"
       + block(1, "Bus.Can", "[ RUN      ] Bus.Can\n/x/bus_test.cc:301: Skipped\nno AF_CAN in this kernel\n[  SKIPPED ] Bus.Can (0 ms)\n"
               "[  SKIPPED ] 1 test, listed below:\n[  SKIPPED ] Bus.Can", "Test Pass Reason:\nSkip regular expression found in output.")
       + block(2, "Clients.exec_test", "test_a (exec_test.Exec.test_a) ... ok\ntest_b (exec_test.Exec.test_b) ... skipped 'no \"x\" here'\n"
               "test_c (exec_test.Exec.test_c)\nIts first line. ... skipped \"isn't there\"\n\nOK (skipped=2)")
       + block(3, "Trial.Walls", "memory             it held\ndisk               SKIPPED: no mount")
       + block(4, "Page.InARealBrowser", "skipped: no Chromium")
       + block(5, "Other.Test", "nothing", "Test Skipped.")
       + block(6, "Bus.Good", "[       OK ] Bus.Good (0 ms)") + block(7, "Bus.Bad", "it failed", "Test Failed."))
FOUND = [("Bus.Can", "no AF_CAN in this kernel"), ("Clients.exec_test: test_b", 'no "x" here'), ("Clients.exec_test: test_c", "isn't there"),
         ("Trial.Walls: disk", "no mount"), ("Page.InARealBrowser", "no Chromium"), ("Other.Test", "no reason given")]


class Skips(unittest.TestCase):
    def test_every_form_is_found(self):
        self.assertEqual(skips.skips_in(LOG), FOUND)

    def test_a_list_has_patterns_and_reasons(self):
        expected = skips.expected_in("# a comment\nBus.*  no kernel has it\n\nTrial.Walls: disk  needs mounts\n")
        self.assertEqual([skip.name for skip in skips.unexpected(skips.skips_in(LOG), expected)],
                         [name for name, _ in FOUND if not name.startswith(("Bus", "Trial"))])
        with self.assertRaisesRegex(ValueError, "Bus.Can"):
            skips.expected_in("Bus.Can needs a reason after two blanks\n")

    def test_an_unlisted_skip_fails_under_ci_alone(self):
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            (folder / "LastTest.log.tmp3").write_text(LOG)
            (folder / "LastTest.log").write_text(block(1, "Of.AnEarlierRun", "skipped: long ago"))
            (folder / "expected.txt").write_text("Bus.*  no kernel has it\n")
            for ci, code in (("", 0), ("false", 0), ("true", 1)):
                done = subprocess.run([sys.executable, HERE / "skips.py", folder, folder / "expected.txt"], capture_output=True, text=True,
                                      env={**os.environ, "CI": ci}, timeout=60)
                self.assertEqual(done.returncode, code, done.stdout + done.stderr)
                self.assertIn("skipped: Bus.Can  no AF_CAN in this kernel\n", done.stdout)
                self.assertIn("skipped, not in the list: Trial.Walls: disk  no mount\n", done.stdout)
                self.assertNotIn("Earlier", done.stdout)

    def test_no_test_goes_round_it(self):
        for file in HERE.parent.rglob("CMakeLists.txt"):
            if file.parent not in (HERE, HERE.parent):
                self.assertNotRegex(file.read_text(), r"(?m)^\s*add_test\(", f"{file}: use visum_add_test")


if __name__ == "__main__":
    unittest.main()
