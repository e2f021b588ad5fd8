"""Programs that are linked with a vendor's CAN library find the arm's modules behind it."""
import subprocess
import unittest

from programs import BIN, DEADLINE_S, Daemon, visum


class CanLibraries(unittest.TestCase):
    def setUp(self):
        self.daemon = self.enterContext(Daemon("--bus", "arm=tcp:0", "--run"))
        self.environment = {"VISUM_CONNECT": self.daemon.connect}

    def test_a_program_linked_with_libntcan_finds_and_moves_the_modules(self):
        text = visum("exec", "--can", "esd", "--", BIN / "visum-test-ntcan", env=self.environment).stdout
        self.assertEqual(text, "8 modules\nmodule 1 came to 0.19\nall well\n")

    def test_a_program_linked_with_libpcan_finds_the_modules(self):
        text = visum("exec", "--can", "peak=arm", "--", BIN / "visum-test-pcan", env=self.environment).stdout
        self.assertEqual(text, "all well\n")

    def test_one_of_several_handles_is_read_and_keeps_its_speed(self):
        for vendor, program in (("esd", "visum-test-ntcan"), ("peak", "visum-test-pcan")):
            with self.subTest(vendor=vendor):
                text = visum("exec", "--can", vendor, "--", BIN / program, 20_000, env=self.environment).stdout
                self.assertEqual(text, "all answered\n")

    def test_wrong_use_is_named(self):
        refused = visum("exec", "--can", "kvaser", "--", "true", expect=2, env=self.environment).stderr
        self.assertIn("must be esd or peak", refused)
        refused = visum("exec", "--can", "esd=leg", "--", "true", expect=2, env=self.environment).stderr
        self.assertIn("part 'leg' has no tcp bus", refused)

    def test_without_a_bus_the_library_says_so(self):
        program = BIN / "visum-test-ntcan"
        for environment, word in (({}, "visum exec --can"), ({"VISUM_CAN": "127.0.0.1:1"}, "no bus at 127.0.0.1:1")):
            done = subprocess.run([program], capture_output=True, text=True, timeout=DEADLINE_S,
                                  env={"LD_LIBRARY_PATH": str(BIN.parent / "lib" / "visum-can"), **environment})
            self.assertEqual(done.returncode, 1)
            self.assertIn(word, done.stderr)


if __name__ == "__main__":
    unittest.main(verbosity=2)
