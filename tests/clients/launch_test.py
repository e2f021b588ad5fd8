"""visum.launch(): one line starts a daemon and connects; whoever launched it is never outlived by it."""
import os
import pathlib
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest
import unittest.mock
import urllib.request

from programs import ARM, BIN, DEADLINE_S

sys.path.insert(0, str(BIN.parent / "python"))
import visum  # noqa: E402
from visum import scene as build  # noqa: E402


def is_gone(pid):
    try:
        return pathlib.Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] == "Z"
    except FileNotFoundError:
        return True


def await_gone(pid):
    end = time.monotonic() + DEADLINE_S
    while not is_gone(pid) and time.monotonic() < end:
        time.sleep(0.02)
    return is_gone(pid)


class Launch(unittest.TestCase):
    def test_one_line_serves_the_arm_and_the_block_ends_the_daemon(self):
        with visum.launch(ARM, clock="lockstep") as client:
            self.assertEqual(client.server.clock, "lockstep")
            arm = client.part("arm")
            with arm.lease():
                client.join()
                client.advance_ms(10)
            self.assertEqual(urllib.request.urlopen(client.page, timeout=DEADLINE_S).status, 200)
            with visum.Client(client.address, role="observer") as other:
                self.assertEqual(other.part_names(), ["arm"])
                self.assertEqual(other.connection._socket.family, socket.AF_UNIX)
            with unittest.mock.patch.dict(os.environ, VISUM_LOCAL="another"), visum.Client(client.address) as stranger:
                self.assertEqual(stranger.connection._socket.family, socket.AF_INET)
            pid = client._daemon._process.pid
        self.assertTrue(is_gone(pid))
        self.assertIn("ended at tick", client.log)

    def test_a_scene_made_in_code_is_served_and_leaves_no_file(self):
        scene = build.Scene("drop")
        scene.body("ball", mass=1, pose=build.pose(0, 0, 1), shapes=[build.sphere(0.1)])
        with tempfile.TemporaryDirectory() as folder:
            before = os.getcwd()
            os.chdir(folder)
            try:
                with visum.launch(scene, "--seed", "3") as client:
                    self.assertEqual(client.server.scene, "drop")
                    self.assertEqual(os.listdir("."), [])
            finally:
                os.chdir(before)

    def test_a_refused_scene_raises_with_the_daemons_own_words(self):
        with self.assertRaises(visum.Error) as caught:
            visum.launch("nowhere.yaml")
        self.assertEqual(caught.exception.code, visum.ErrorCode.MISUSE)
        self.assertIn("nowhere.yaml", str(caught.exception))

    def test_a_program_that_is_not_there_is_named(self):
        with self.assertRaises(visum.Error) as caught:
            visum.launch(ARM, program="/nowhere/visumd")
        self.assertIn("/nowhere/visumd", str(caught.exception))

    def test_a_program_that_is_no_visumd_is_told_by_what_it_says(self):
        with self.assertRaises(visum.Error) as caught:
            visum.launch("hello", program="/bin/echo")
        self.assertIn("this is no visumd: it says 'hello --port 0", str(caught.exception))

    def test_a_scene_that_cannot_be_written_is_told(self):
        before = os.getcwd()
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
        try:  # in a folder that is gone, where root cannot write either
            with self.assertRaises(visum.Error) as caught:
                visum.launch(build.Scene("drop"))
        finally:
            os.chdir(before)
        self.assertIn("cannot be written into the working directory", str(caught.exception))

    def test_a_daemon_that_is_never_ready_is_ended(self):
        with tempfile.TemporaryDirectory() as folder:
            idle = pathlib.Path(folder) / "idle"
            idle.write_text(f"#!/bin/sh\necho $$ > {folder}/pid\nexec sleep 1000\n")
            idle.chmod(0o755)
            with self.assertRaises(visum.Error) as caught:
                visum.launch(ARM, program=idle, start_timeout_s=2)
            self.assertEqual(caught.exception.code, visum.ErrorCode.TIMEOUT)
            self.assertTrue(await_gone(int((pathlib.Path(folder) / "pid").read_text())))

    def test_the_daemon_ends_with_its_program_however_that_ends(self):
        program = ("import sys, time, visum; client = visum.launch(sys.argv[1]); "
                   "print(client._daemon._process.pid, flush=True); sys.stdin.readline()")
        for how in ("returns", "is killed"):
            with self.subTest(how), subprocess.Popen(
                    [sys.executable, "-c", program, str(ARM)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
                    env={**os.environ, "PYTHONPATH": str(BIN.parent / "python")}) as launcher:
                pid = int(launcher.stdout.readline())
                self.assertFalse(is_gone(pid))
                if how == "returns":
                    launcher.stdin.write("\n")
                    launcher.stdin.flush()
                else:
                    launcher.send_signal(signal.SIGKILL)
                self.assertTrue(await_gone(pid))


if __name__ == "__main__":
    unittest.main()
