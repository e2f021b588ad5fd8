"""visum exec: programs that open a device by its own name find a part's bus there."""
import json
import os
import pathlib
import pwd
import signal
import stat
import subprocess
import sys
import tempfile
import unittest

from programs import ARM, BIN, DEADLINE_S, Daemon, visum

SERIAL_ARM = BIN / "visum-serial-arm"
UNUSED = "ttyVisum0"  # no driver makes a device of that name


def place(*words):
    """How these words end in a place of their own, as (exit code, both outputs)."""
    done = subprocess.run(list(map(str, words)), capture_output=True, text=True, timeout=DEADLINE_S)
    return done.returncode, done.stdout + done.stderr


NAMESPACES = place("unshare", "--mount", "true")[0] == 0


# Writes as libm5api does, which discards both directions before each write: here right after it, which is
# the same for commands whose answers nobody waits for. SAVEPARAMS counts what came through.
DISCARDER = """
import os, sys, termios, tty
line = os.open(sys.argv[1], os.O_RDWR | os.O_NOCTTY)
tty.setraw(line)
for _ in range(200):
    os.write(line, bytes([0x02, 0x04, 0x21, 0x10, 0x90, 0x35, 0x03]))
    termios.tcflush(line, termios.TCIOFLUSH)
os.write(line, bytes([0x02, 0x04, 0x22, 0x0A, 0x57, 0x87, 0x03]))
answer = b""
while True:
    answer += os.read(line, 64)
    *_, last = answer[:answer.rfind(3) + 1].split(b"\\x02")
    if last[2:4] == bytes([0x0A, 0x57]):
        print(last[4])
        break
"""


class Exec(unittest.TestCase):
    def setUp(self):
        folder = self.enterContext(tempfile.TemporaryDirectory())
        self.tty = pathlib.Path(folder) / "arm.tty"
        self.daemon = self.enterContext(Daemon("--bus", f"arm=pty:{self.tty}", "--run", "--speedup", "5"))

    def words(self, *words, tty="ttyS0=arm"):
        return [str(BIN / "visum"), "exec", "--connect", self.daemon.connect, "--tty", tty, "--", *map(str, words)]

    def run_there(self, *words, **more):
        if not NAMESPACES:
            self.skipTest("no mount namespaces here")
        return place(*self.words(*words, **more))

    def test_a_program_finds_the_arm_at_a_device_that_exists(self):
        if not pathlib.Path("/dev/ttyS0").exists():
            self.skipTest("this machine has no /dev/ttyS0")
        code, text = self.run_there(SERIAL_ARM, "/dev/ttyS0", 38400, 5)
        self.assertEqual(code, 0, text)
        self.assertIn("scan: 8 modules", text)

    def test_a_program_finds_the_arm_at_a_device_that_there_was_not(self):
        code, text = self.run_there(SERIAL_ARM, f"/dev/{UNUSED}", 38400, 5, tty=f"{UNUSED}=arm")
        self.assertEqual(code, 0, text)
        self.assertIn("all well", text)

    def test_the_rest_of_dev_is_as_it_was(self):
        names = "import json, os; print(json.dumps(sorted(os.listdir('/dev'))))"
        _, before = place(sys.executable, "-c", names)
        _, there = self.run_there(sys.executable, "-c", names, tty=f"{UNUSED}=arm")
        self.assertEqual(sorted(json.loads(before) + [UNUSED]), json.loads(there))
        code, _ = self.run_there("sh", "-c", "echo x > /dev/null && head -c 8 /dev/urandom > /dev/null", tty=f"{UNUSED}=arm")
        self.assertEqual(code, 0)

    def test_nobody_else_sees_it(self):
        code, _ = self.run_there("test", "-c", f"/dev/{UNUSED}", tty=f"{UNUSED}=arm")
        self.assertEqual(code, 0)
        self.assertFalse(pathlib.Path(f"/dev/{UNUSED}").exists())

    def test_what_a_program_has_written_stays_written(self):
        code, text = self.run_there(sys.executable, "-c", DISCARDER, f"/dev/{UNUSED}", tty=f"{UNUSED}=arm")
        self.assertEqual((code, text), (0, f"{200 + 1}\n"))

    def test_the_exit_code_is_the_programs(self):
        self.assertEqual(self.run_there("sh", "-c", "exit 37")[0], 37)

    def test_signals_are_the_programs(self):
        if not NAMESPACES:
            self.skipTest("no mount namespaces here")
        program = "trap 'exit 41' TERM; echo up; while :; do sleep 0.01; done"
        with subprocess.Popen(self.words("sh", "-c", program), stdout=subprocess.PIPE, text=True) as process:
            self.assertEqual(process.stdout.readline(), "up\n")
            process.send_signal(signal.SIGTERM)
            self.assertEqual(process.wait(DEADLINE_S), 41)

    def test_a_program_that_is_not_there_is_named(self):
        code, text = self.run_there("no-such-program")
        self.assertEqual(code, 127)
        self.assertIn("no-such-program", text)

    def test_an_ordinary_user_gets_it_or_is_told_why_not(self):
        if os.getuid() != 0:
            self.skipTest("needs root, to become somebody else")
        nobody = pwd.getpwnam("nobody")
        self.tty.parent.chmod(0o755)
        done = subprocess.run(self.words("sh", "-c", "test -c /dev/ttyS0 && id -u"), capture_output=True, text=True,
                              user=nobody.pw_uid, group=nobody.pw_gid, extra_groups=[], timeout=DEADLINE_S)
        if done.returncode == 0:
            self.assertEqual(done.stdout.strip(), str(nobody.pw_uid))
        else:
            self.assertEqual(done.returncode, 125)
            self.assertIn("private mount namespace", done.stderr)


class WrongUse(unittest.TestCase):
    def setUp(self):
        self.daemon = self.enterContext(Daemon("--bus", "arm=tcp:0"))

    def refused(self, *options):
        return visum("exec", *options, "--", "true", expect=2, env={"VISUM_CONNECT": self.daemon.connect}).stderr

    def test_a_part_without_such_a_bus_is_named_with_what_it_has(self):
        text = self.refused("--tty", "ttyS0=arm")
        self.assertIn("--bus arm=pty:PATH", text)
        self.assertIn("arm=tcp:", text)

    def test_a_wrong_place_is_refused(self):
        self.assertIn("DEVICE=PART", self.refused("--tty", "ttyS0"))
        self.assertIn("/dev itself", self.refused("--tty", "/tmp/ttyS0=arm"))
        self.assertIn("--tty", self.refused())

    def test_a_part_that_is_not_there_is_told_by_this_commands_options(self):
        for options in (("--bus", "leg=pty"), ("--tty", "ttyVisum=leg"), ("--can", "esd=leg")):
            text = visum("exec", "--scene", ARM, *options, "--", "true", expect=2).stderr
            self.assertEqual(text, "visum: --bus, --tty or --can: there is no part 'leg'; there is only 'arm'\n")

    def test_a_server_of_its_own_is_no_other_server(self):
        self.assertIn("--connect", self.refused("--scene", ARM, "--connect", self.daemon.connect))
        visum("exec", "--scene", ARM, "--lockstep", "--", "true", env={"VISUM_CONNECT": self.daemon.connect})


if __name__ == "__main__":
    unittest.main(verbosity=2)
