"""visum exec --lockstep: programs that know nothing of Visum run on the world's time, with the same bits every time."""
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

from programs import ARM, BIN, DEADLINE_S, Daemon, visum

WAITS = BIN / "visum-test-waits"
SERIAL_ARM = BIN / "visum-serial-arm"
STEPS = 12  # of 20 ms each
SHIM = pathlib.Path(__file__).with_name("shim")

# At the end of a program LeakSanitizer waits, which lets time pass: some ticks in one run, none in the next.
os.environ["ASAN_OPTIONS"] = "detect_leaks=0"

KINDS = ["usleep", "absolute", "poll", "select", "condition", "semaphore", "mutex", "timerfd", "alarm", "receive", "spin",
         "yield", "fork", "command", "join", "thread", "future", "future_until", "promise", "acquire", "kernel"]


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


HABITS = BIN / "visum-test-habits"


class ProgramsForRealModules(unittest.TestCase):
    """Each habit gave other bits in other runs, or ran far below real time."""

    def same_in_runs(self, count, *command, **more):
        ends = [run(*command, **more) for _ in range(count)]
        self.assertEqual(len({(text, figures["state_hash"]) for text, figures, _ in ends}), 1)
        return ends[0]

    def test_one_that_resends_has_nothing_to_resend(self):
        text, figures, _ = self.same_in_runs(20, HABITS, "resend", "{bus.arm}", 60)
        self.assertEqual(text, "0 resent", "FIONREAD counts an answer that is due at that tick")
        self.assertEqual(figures["ticks"], 60, "a tick for each answer")

    def test_one_that_reads_byte_by_byte_does_not_spin(self):
        text, figures, errors = self.same_in_runs(2, HABITS, "bytes", "{bus.arm}", 230)
        self.assertEqual(text, f"{230 * 12} bytes", "with ten times as many looks at the clock as a thread makes that spins")
        self.assertNotIn("spins", errors)
        self.assertEqual(figures["ticks"], 20, "reading takes no time")

    def test_nor_does_one_that_has_spun_before(self):
        text, _, errors = self.same_in_runs(2, HABITS, "spun", "{bus.arm}", 230)
        self.assertEqual(text, f"{230 * 12} bytes", "and no time passed between them")
        self.assertEqual(errors.count("spins"), 1)

    def test_what_poll_has_seen_may_be_gone_when_it_is_read(self):
        text, figures, _ = self.same_in_runs(2, HABITS, "stale", "{bus.arm}", 10)
        self.assertEqual(text, "10 reads found nothing")
        self.assertEqual(figures["ticks"], 10 * 200, "each read waits for its time in the world")

    def test_one_that_spins_while_it_waits_for_modules_that_are_absent(self):
        text, figures, errors = self.same_in_runs(2, HABITS, "scan", "{bus.arm}")
        self.assertEqual(text, "8 found")
        self.assertIn("takes a tick or more", errors)
        self.assertGreaterEqual(figures["sim_seconds"], 23 * 0.93)
        self.assertLess(figures["sim_seconds"], 23 * (0.93 + 0.04), "a look is 10 ms late at most, and each module takes a few")

    def test_a_server_and_its_client_over_loopback(self):
        text, figures, _ = self.same_in_runs(2, HABITS, "serve", "{bus.arm}", 100)
        self.assertEqual(text, "the client ended with 0")
        self.assertEqual(figures["ticks"], 2000)

    def test_one_that_reads_one_of_its_can_handles(self):
        for vendor, program in (("esd", "visum-test-ntcan"), ("peak", "visum-test-pcan")):
            with self.subTest(vendor=vendor):
                text, _, _ = run(BIN / program, 20_000, buses=("--can", vendor))
                self.assertEqual(text, "all answered")


class Verdict(unittest.TestCase):
    """A run is valid only if every process has announced itself."""

    def invalid(self, *command):
        _, figures, errors = run(*command, expect=6)
        self.assertFalse(figures["valid"])
        self.assertIn("INVALID: " + figures["invalid_reason"], errors)
        return figures["invalid_reason"]

    def test_a_static_program(self):
        self.assertEqual(self.invalid(BIN / "visum-test-static"), "the program itself has not loaded the time shim")

    def test_a_static_child_however_it_is_started(self):
        static = BIN / "visum-test-static"
        for command in (["sh", "-c", f"{static}; true"], ["bash", "-c", f"exec {static}"],
                        [sys.executable, "-c", f"import os; os.system('exec {static}')"],
                        [sys.executable, "-c", f"import subprocess; subprocess.run(['{static}'])"],
                        [sys.executable, "-c", f"import os; os.waitpid(os.posix_spawn('{static}', ['x'], os.environ), 0)"]):
            with self.subTest(command=command):
                self.assertRegex(self.invalid(*command), "has not loaded the time shim|waits by the host's time")

    def test_a_child_of_a_system_call_is_followed(self):
        program, static = BIN / "visum-test-raw-sleep", BIN / "visum-test-static"
        for how in ("clone", "clone3", "fork"):
            with self.subTest(how=how):
                text, figures, _ = run(program, how, program)
                self.assertEqual((text, figures["valid"], figures["ticks"]), ("done", True, 200))
                self.assertRegex(self.invalid(program, how, static), "has not loaded the time shim|waits by the host's time")

    def test_one_with_a_timer_of_the_hosts(self):
        self.assertIn("has a timer of timer_create()", self.invalid(BIN / "visum-test-raw-sleep", "timer"))

    def test_one_that_sleeps_past_the_library(self):
        self.assertIn("waits by the host's time", self.invalid(BIN / "visum-test-raw-sleep", "raw"))

    def test_one_in_a_process_namespace_of_its_own(self):
        own = ["unshare", "--user", "--map-root-user", "--pid", "--fork"]
        if subprocess.run([*own, "true"], capture_output=True).returncode != 0:
            self.skipTest("this machine allows no namespaces")
        for command in ([*own, "sleep", "0.1"], [*own, "sh", "-c", "sleep 0.1; true"]):
            with self.subTest(command=command):
                self.assertIn("a process namespace of its own", self.invalid(*command))

    def test_a_scenario_with_such_a_controller_is_invalid_and_not_passed(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "static.yaml"
            file.write_text(f"visum_scenario: 1\nname: static\nscene: {ARM}\nclock: lockstep\nmax_sim_s: 10\ncontrollers:\n"
                            f"  - {{name: stranger, command: [\"{BIN / 'visum-test-static'}\"], shim: true}}\n"
                            "checks: [{name: the arm is there, that: {port: {part: arm, name: Part State}, equals: 0},"
                            " when: eventually}]\n")
            done = visum("run", file, "--json", expect=6)
        result = json.loads(done.stdout.splitlines()[-1])
        self.assertEqual((result["passed"], result["valid"]), (False, False))
        self.assertIn("controller 'stranger': the program itself has not loaded the time shim", result["invalid_reason"])

    def test_one_that_could_not_be_started_is_not_valid_either(self):
        _, figures, _ = run("no-such-program", expect=127)
        self.assertFalse(figures["valid"])

    def test_the_same_program_in_step(self):
        text, figures, _ = run(BIN / "visum-test-raw-sleep")
        self.assertEqual((text, figures["valid"], figures["ticks"]), ("done", True, 200))

    def test_children_that_announce_themselves(self):
        for command in (["sh", "-c", "sleep 0.01; sleep 0.01"], ["bash", "-c", "exec sleep 0.02"],
                        [sys.executable, "-c", "import os; os.system('sleep 0.02')"]):
            with self.subTest(command=command):
                self.assertTrue(run(*command)[1]["valid"])


class Options(unittest.TestCase):
    """All ways to give a part a bus, together."""

    def test_a_bus_beside_a_placed_device(self):
        text, _, _ = run("sh", "-c", "ls /dev/ttyVisum; echo {bus.arm}", options=["--tty", "ttyVisum=arm"])
        self.assertRegex(text, r"/dev/ttyVisum\n.*/arm\.tty")

    def test_can_brings_its_own_bus(self):
        self.assertIn("all well", run(BIN / "visum-test-pcan", buses=("--can", "peak"))[0])

    def test_slcan(self):
        self.assertRegex(run("echo", "{bus.arm}", buses=("--bus", "arm=slcan"))[0], r"/arm\.can$")

    def test_all_at_once(self):
        text, _, _ = run("echo", "{bus.arm}", buses=("--bus", "arm=slcan"), options=["--tty", "ttyVisum=arm", "--can", "esd"])
        self.assertRegex(text, r"/arm\.can$")

    def test_wrong_ones_are_told_of_by_this_commands_names(self):
        self.assertIn("PART=pty, PART=slcan or PART=tcp", run("true", buses=("--bus", "arm=rs485"), expect=2)[2])
        with Daemon() as daemon:
            done = visum("exec", "--connect", daemon.connect, "--tty", "ttyS0=arm", "--", "true", expect=2)
            self.assertIn("start visumd with --bus arm=pty:PATH", done.stderr)


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
