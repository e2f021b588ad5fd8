"""visum exec --lockstep: programs that know nothing of Visum run on the world's time, with the same bits every time."""
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

from programs import ARM, BIN, DEADLINE_S, Daemon

WAITS = BIN / "visum-test-waits"
SERIAL_ARM = BIN / "visum-serial-arm"
STEPS = 12  # of 20 ms each
SHIM = pathlib.Path(__file__).with_name("shim")

# At the end of a program LeakSanitizer waits, which lets time pass: some ticks in one run, none in the next.
os.environ["ASAN_OPTIONS"] = "detect_leaks=0"

KINDS = ["usleep", "absolute", "poll", "select", "condition", "semaphore", "mutex", "timerfd", "alarm", "receive", "spin",
         "yield", "fork", "command", "join", "thread", "future", "future_until", "promise", "acquire"]


def run(*command, scene=ARM, buses=("--bus", "arm=pty"), grade=("--lockstep",), options=(), timeout=DEADLINE_S, expect=0, env=None):
    """One run with a server of its own: (what it said, the figures of the last line, its standard error)."""
    words = [BIN / "visum", "exec", "--scene", scene, *buses, *grade, "--json", "--timeout", timeout, *options, "--", *command]
    done = subprocess.run(list(map(str, words)), capture_output=True, text=True, timeout=2 * DEADLINE_S, env=env)
    if done.returncode != expect:
        raise AssertionError(f"{words}: exit code {done.returncode}, not {expect}\n{done.stdout}\n{done.stderr}")
    lines = done.stdout.splitlines()
    figures = json.loads(lines[-1]) if lines and lines[-1].startswith("{") else None
    return "\n".join(lines[:-1]), figures, done.stderr


class EveryKindOfWait(unittest.TestCase):
    def test_takes_its_time_in_the_world_and_gives_the_same_bits(self):
        for kind in KINDS:
            with self.subTest(kind=kind):
                text, figures, _ = run(WAITS, kind, "{bus.arm}", STEPS)
                again, figures_again, _ = run(WAITS, kind, "{bus.arm}", STEPS)
                self.assertIn(", 0 without an answer", text)
                self.assertEqual((text, figures["state_hash"]), (again, figures_again["state_hash"]))
                self.assertGreaterEqual(figures["ticks"], 20 * STEPS)
                self.assertLess(figures["ticks"], 24 * STEPS)

    def test_waits_of_the_same_length_are_the_same_to_the_world(self):
        same = ["usleep", "absolute", "poll", "select", "condition", "semaphore", "mutex", "timerfd", "alarm", "receive", "fork", "join", "future", "future_until",
                "promise", "acquire"]
        hashes = {run(WAITS, kind, "{bus.arm}", STEPS)[1]["state_hash"] for kind in same}
        self.assertEqual(len(hashes), 1)


class EveryKindOfProgram(unittest.TestCase):
    def same_twice(self, *command, **more):
        first, second = run(*command, **more), run(*command, **more)
        self.assertEqual((first[0], first[1]["state_hash"]), (second[0], second[1]["state_hash"]))
        return first

    def test_python_with_pyserial(self):
        text, figures, _ = self.same_twice(sys.executable, SHIM / "serial_steps.py", "{bus.arm}", STEPS)
        self.assertIn(f"{0.02 * STEPS:.6f} s 2000-01-01", text)
        self.assertEqual(figures["ticks"], 20 * STEPS)

    def test_a_program_with_helpers_of_its_own(self):
        text, figures, _ = self.same_twice(sys.executable, SHIM / "helper_process.py", WAITS, "{bus.arm}", STEPS)
        self.assertIn("helper", text)
        self.assertEqual(figures["ticks"], 3 * (20 * STEPS + 11))

    def test_over_tcp_as_over_a_pseudo_terminal(self):
        command = [sys.executable, SHIM / "serial_steps.py"]
        text, figures, _ = self.same_twice(*command, "socket://{bus.arm}", STEPS, options=["--bus", "arm=tcp"])
        on_tty, _, _ = run(*command, "{bus.arm}", STEPS)
        self.assertEqual(text, on_tty)
        self.assertGreaterEqual(figures["ticks"], 20 * STEPS, "and pyserial sleeps when it closes a socket")

    def test_however_many_connections_come_and_go(self):
        body = ("import select, socket, sys\n"
                "from serial_steps import ETX, frame\n"
                "host, port = sys.argv[1].rsplit(':', 1)\n"
                "at_once = 0\n"
                "for _ in range(100):\n"
                "    with socket.create_connection((host, int(port))) as line:\n"
                "        line.sendall(frame(1, [0x0A, 0x27]))\n"
                "        at_once += len(select.select([line], [], [], 0)[0])\n"
                "        while line.recv(64)[-1] != ETX: pass\n"
                "print(at_once)\n")
        env = {**os.environ, "PYTHONPATH": str(SHIM), "PYTHONDONTWRITEBYTECODE": "1"}
        text, _, _ = self.same_twice(sys.executable, "-c", body, "{bus.arm}", options=["--bus", "arm=tcp"], env=env)
        self.assertEqual(text, "100", "an answer is there before the program looks, on each of them")

    def test_in_a_set_of_epoll_that_held_it_before_it_was_connected(self):
        body = ("import select, socket, sys\n"
                "from serial_steps import ETX, frame\n"
                "host, port = sys.argv[1].rsplit(':', 1)\n"
                "with socket.socket() as line, select.epoll() as watch:\n"
                "    watch.register(line, select.EPOLLIN)\n"
                "    line.connect((host, int(port)))\n"
                "    for longest in 0, None:\n"
                "        line.sendall(frame(1, [0x0A, 0x27]))\n"
                "        print(len(watch.poll(longest)))\n"
                "        while line.recv(64)[-1] != ETX: pass\n")
        env = {**os.environ, "PYTHONPATH": str(SHIM), "PYTHONDONTWRITEBYTECODE": "1"}
        text, _, _ = self.same_twice(sys.executable, "-c", body, "{bus.arm}", options=["--bus", "arm=tcp"], env=env)
        self.assertEqual(text, "1\n1")
        with Daemon("--clock", "lockstep", "--bus", "arm=tcp:0,delay_ms=5") as daemon:
            words = [BIN / "visum", "exec", "--connect", daemon.connect, "--lockstep", "--timeout", "20", "--"]
            address = daemon.ready["buses"]["arm"][0].replace("tcp", "127.0.0.1")
            done = subprocess.run([*words, sys.executable, "-c", body, address], capture_output=True, text=True, env=env)
        self.assertEqual((done.returncode, done.stdout), (0, "0\n1\n"), done.stderr)

    def test_the_serial_c_program(self):
        text, figures, _ = self.same_twice(SERIAL_ARM, "{bus.arm}")
        self.assertIn("all well", text)
        self.assertGreater(figures["sim_seconds"], 10)

    def test_behind_a_vendors_can_library(self):
        text, _, _ = self.same_twice(BIN / "visum-test-pcan", options=["--bus", "arm=tcp", "--can", "pcan=arm"])
        self.assertEqual(text, "all well")

    def test_one_that_asks_without_a_wait_makes_time_pass(self):
        body = ("import os, sys, tty\n"
                "from serial_steps import ETX, frame\n"
                "line = os.open(sys.argv[1], os.O_RDWR | os.O_NOCTTY)\n"
                "tty.setraw(line)\n"
                "for _ in range(1050):\n"
                "    os.write(line, frame(1, [0x0A, 0x27]))\n"
                "    while os.read(line, 64)[-1] != ETX: pass\n")
        env = {**os.environ, "PYTHONPATH": str(SHIM), "PYTHONDONTWRITEBYTECODE": "1"}
        _, figures, errors = run(sys.executable, "-c", body, "{bus.arm}", env=env)
        self.assertIn("asks without letting time pass", errors)
        self.assertEqual(figures["ticks"], 50, "a tick for each request after the first thousand")

    def test_clients_of_the_ports_in_cpp(self):
        move = f"{BIN}/visum set arm 'Desired Angle 1' 0.2 --connect {{connect}}"
        look = f"{BIN}/visum get arm 'Actual Angle 1' --connect {{connect}}"
        text, figures, _ = self.same_twice("sh", "-c", f"{move} && sleep 0.5 && {look}")
        self.assertGreater(float(text), 0.1)
        self.assertGreaterEqual(figures["ticks"], 500)

    def test_clients_of_the_ports_in_python(self):
        body = ("import sys, time, visum\n"
                "with visum.Client(sys.argv[1], name='shimmed') as client:\n"
                "    arm = client.part('arm')\n"
                "    arm.acquire()\n"
                "    for step in range(12):\n"
                "        arm.read()\n"
                "        arm.inputs('Desired Angle')[0] = 0.01 * step\n"
                "        arm.write()\n"
                "        time.sleep(0.02)\n"
                "    arm.read()\n"
                "    print(arm.outputs('Actual Angle')[0])\n")
        env = {**os.environ, "PYTHONPATH": str(BIN.parent / "python")}
        text, _, _ = self.same_twice(sys.executable, "-c", body, "{connect}", env=env)
        self.assertGreater(float(text), 0.02)

    def test_one_that_spins_is_named_and_comes_through(self):
        _, _, errors = run(WAITS, "spin", "{bus.arm}", 2)
        self.assertRegex(errors, r"thread \d+ of process \d+ spins on clock_gettime")

    def test_one_that_is_killed_is_lost_where_it_was(self):
        script = "sleep 0.05; kill -9 $$"
        first, second = (run("bash", "-c", script, expect=4) for _ in range(2))
        self.assertEqual(first[1]["state_hash"], second[1]["state_hash"])
        self.assertEqual(first[1]["ticks"], 50)
        self.assertIn("signal 9", first[2])

    def test_a_child_that_is_killed_holds_nobody(self):
        script = "sleep 100 & sleep 0.05; kill -9 $!; wait $!; echo $?; sleep 0.05"
        text, figures, _ = self.same_twice("bash", "-c", script)
        self.assertEqual(text, "137")
        self.assertEqual(figures["ticks"], 100)


class Installed(unittest.TestCase):
    def test_in_a_folder_with_a_space(self):
        with tempfile.TemporaryDirectory(prefix="a place ") as folder, Daemon("--clock", "lockstep") as daemon:
            place = pathlib.Path(folder)
            (place / "bin").mkdir()
            (place / "lib").symlink_to(BIN.parent / "lib")
            visum = shutil.copy(BIN / "visum", place / "bin")
            words = [visum, "exec", "--connect", daemon.connect, "--lockstep", "--json", "--timeout", DEADLINE_S, "--"]
            done = subprocess.run([*map(str, words), "sleep", "0.05"], capture_output=True, text=True, timeout=2 * DEADLINE_S)
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            self.assertEqual(json.loads(done.stdout)["ticks"], 50)


class Ends(unittest.TestCase):
    def test_with_the_code_of_the_program(self):
        self.assertEqual(run("sh", "-c", "exit 37", expect=37)[1]["exit_code"], 37)

    def test_what_it_left_behind_is_gone(self):
        text, _, _ = run("sh", "-c", "sleep 1000 & echo $!")
        stat = pathlib.Path(f"/proc/{text}/stat")
        self.assertTrue(not stat.exists() or ") Z " in stat.read_text(), "it lives")

    def test_a_program_that_does_not_come_to_its_end_is_ended(self):
        run("sh", "-c", "while :; do :; done", timeout=0.5, expect=124)

    def test_not_found_and_not_executable(self):
        self.assertIn("no-such-program", run("no-such-program", expect=127)[2])
        run("/etc/passwd", expect=126)

    def test_a_scene_that_is_wrong(self):
        run("true", scene="/nowhere.yaml", options=[], expect=3)

    def test_nobody_there(self):
        words = [BIN / "visum", "exec", "--connect", "127.0.0.1:1", "--lockstep", "--", "true"]
        self.assertEqual(subprocess.run(words, capture_output=True, timeout=DEADLINE_S).returncode, 125)

    def test_a_world_with_another_clock(self):
        with Daemon("--clock", "realtime") as daemon:
            words = [BIN / "visum", "exec", "--connect", daemon.connect, "--lockstep", "--", "true"]
            done = subprocess.run(words, capture_output=True, text=True, timeout=DEADLINE_S)
            self.assertEqual(done.returncode, 2)
            self.assertIn("--clock lockstep", done.stderr)


if __name__ == "__main__":
    unittest.main(verbosity=2)
