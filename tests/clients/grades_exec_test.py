"""visum exec in every grade of lockstep: what keeps in step, who is waited for, and what happens to who is late."""
import json
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time
import unittest

from lockstep_exec_test import SHIM, STEPS, WAITS, run
from programs import ARM, BIN, DEADLINE_S, Daemon, children_of, visum

PERIOD_MS = 20  # of the steps of WAITS
PATIENCE_S = 240
PACES = (0.1, 1, 20, None)  # times real time; None: flat out
GATE = ["--gate", "bus:arm", "--period", PERIOD_MS]


WITH_VISUM = {**os.environ, "PYTHONPATH": str(BIN.parent / "python")}


def run_gated(*command, options=(), **more):
    return run(*command, grade=GATE, options=options, **more)


def speedup(pace):
    return [] if pace is None else ["--speedup", pace]


def await_status(daemon, holds):
    """The first status that `holds` says yes to."""
    give_up = time.monotonic() + PATIENCE_S
    while time.monotonic() < give_up:
        status = daemon.json("status")
        if holds(status):
            return status
    raise AssertionError(f"not within {PATIENCE_S} s: {status}")


class InStep(unittest.TestCase):
    """A lockstep server with a bus, and programs that visum exec brings to it."""

    def setUp(self):
        folder = self.enterContext(tempfile.TemporaryDirectory())
        self.tty = pathlib.Path(folder) / "arm.tty"
        self.daemon = self.enterContext(Daemon("--clock", "lockstep", "--bus", f"arm=pty:{self.tty}"))

    def start(self, *words):
        words = [BIN / "visum", "exec", "--connect", self.daemon.connect, "--json", *words]
        process = subprocess.Popen(list(map(str, words)), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(lambda: (process.kill(), process.communicate()))
        return process

    def end(self, process, expect=0):
        out, errors = process.communicate(timeout=DEADLINE_S)
        self.assertEqual(process.returncode, expect, out + errors)
        lines = out.splitlines()
        return json.loads(lines[-1]) if lines and lines[-1].startswith("{") else None, errors

    def stepper(self):
        """Another one in the lockstep, who wants the world to run."""
        body = ("import sys, visum\n"
                "with visum.Client(sys.argv[1], name='stepper') as client:\n"
                "    client.join()\n"
                "    print('joined', flush=True)\n"
                "    sys.stdin.readline()\n"
                "    client.advance_ticks(200)\n"
                "    print(client.status().tick)\n")
        process = subprocess.Popen([sys.executable, "-c", body, self.daemon.connect], stdin=subprocess.PIPE,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                   env=WITH_VISUM)
        self.addCleanup(lambda: (process.kill(), process.communicate()))
        self.assertEqual(process.stdout.readline(), "joined\n")
        return process


class OneHash(unittest.TestCase):
    def test_behind_a_gate_at_every_pace(self):
        runs = [run_gated(WAITS, "usleep", "{bus.arm}", STEPS, options=speedup(pace)) for pace in PACES]
        self.assertEqual(len({(text, figures["state_hash"], figures["ticks"]) for text, figures, _ in runs}), 1)
        self.assertEqual(runs[0][1]["grade"], "L1")
        self.assertEqual(runs[0][1]["ticks"], PERIOD_MS * (STEPS - 1), "each step but the first ended a cycle")

    def test_under_the_shim_at_every_pace(self):
        runs = [run(WAITS, "usleep", "{bus.arm}", STEPS, options=speedup(pace)) for pace in PACES]
        self.assertEqual(len({(text, figures["state_hash"]) for text, figures, _ in runs}), 1)

    def test_of_steps_of_its_own_at_every_pace(self):
        body = ("import sys, visum\n"
                "with visum.Client(sys.argv[1], name='stepper') as client:\n"
                "    arm = client.part('arm')\n"
                "    arm.acquire()\n"
                "    client.join()\n"
                "    for step in range(12):\n"
                "        arm.inputs('Desired Angle')[0] = 0.01 * step\n"
                "        arm.write()\n"
                "        client.advance_ticks(20)\n"
                "    print(client.status().state_hash)\n")
        hashes = set()
        for pace in PACES:
            with Daemon("--clock", "lockstep", *speedup(pace)) as daemon:
                done = subprocess.run([sys.executable, "-c", body, daemon.connect], capture_output=True, text=True,
                                      env=WITH_VISUM, timeout=DEADLINE_S)
                self.assertEqual(done.returncode, 0, done.stderr)
                hashes.add(done.stdout)
        self.assertEqual(len(hashes), 1)


class Gates(unittest.TestCase):
    def test_a_named_frame_ends_the_cycle(self):
        gate = ["--gate", "bus:arm=1:0B", "--period", PERIOD_MS]
        first, second = (run(WAITS, "usleep", "{bus.arm}", STEPS, grade=gate) for _ in range(2))
        self.assertEqual((first[0], first[1]["state_hash"]), (second[0], second[1]["state_hash"]))
        self.assertEqual(first[1]["ticks"], PERIOD_MS * STEPS)

    def test_how_a_program_waits_makes_no_difference(self):
        hashes = {run_gated(WAITS, kind, "{bus.arm}", STEPS)[1]["state_hash"] for kind in ("usleep", "poll", "condition", "absolute")}
        self.assertEqual(len(hashes), 1)

    def test_of_python_over_tcp(self):
        command = [sys.executable, SHIM / "serial_steps.py", "socket://{bus.arm}", STEPS]
        hashes = {run_gated(*command, options=["--bus", "arm=tcp"])[1]["state_hash"] for _ in range(2)}
        self.assertEqual(len(hashes), 1)

    def test_of_a_poller_of_the_ports(self):
        body = ("import sys, time, visum\n"
                "with visum.Client(sys.argv[1], name='poller') as client:\n"
                "    arm = client.part('arm')\n"
                "    arm.acquire()\n"
                "    for step in range(12):\n"
                "        arm.read()\n"
                "        arm.inputs('Desired Angle')[0] = 0.01 * step\n"
                "        arm.write()\n"
                "        time.sleep(0.001 * (step % 3))\n")
        gate = ["--gate", "ports:poller", "--period", PERIOD_MS]
        runs = [run(sys.executable, "-c", body, "{connect}", grade=gate, env=WITH_VISUM)[1] for _ in range(2)]
        self.assertEqual(runs[0]["state_hash"], runs[1]["state_hash"])
        self.assertEqual(runs[0]["ticks"], PERIOD_MS * (1 + STEPS), "acquire() reads, too")

    def test_wrong_use_is_named(self):
        for gate, word in (("bux", "must be bus"), ("bus:", "must be bus"), ("bus:arm=40:0B", "must be bus"),
                           ("bus:arm=1:0", "must be bus"), ("bus:leg", "'leg' has no bus")):
            self.assertIn(word, run("true", grade=["--gate", gate], expect=2)[2])
        self.assertIn("--lockstep or --gate", run("true", grade=["--period", 10], expect=2)[2])
        self.assertIn("whole ticks", run("true", grade=["--gate", "bus", "--period", 1.5], expect=2)[2])
        self.assertIn("--gate", run("true", grade=["--gate", "bus", "--lockstep"], expect=2)[2])


class Shown(InStep):
    def test_a_gate_is_grade_1_and_who_is_waited_for_is_named(self):
        process = self.start("--name", "poller", *GATE, "--", "sleep", 100)
        status = await_status(self.daemon, lambda status: status["lockstep"] and status["lockstep"][0]["waiting_ns"] > 0)
        self.assertEqual((status["lockstep"][0]["client"], status["lockstep"][0]["grade"]), ("poller", 1))
        text = self.daemon.visum("status").stdout
        self.assertRegex(text, r"poller: L1 \(gate\).*WAITED FOR since")
        for child in children_of(process, "sleep"):
            os.kill(child, signal.SIGKILL)
        self.assertIn("signal 9", self.end(process, expect=4)[1])

    def test_a_program_in_no_lockstep_is_grade_0(self):
        process = self.start("--name", "loner", "--", "sleep", 100)
        await_status(self.daemon, lambda status: status["free_running"] == ["loner"])
        self.assertIn("loner: L0 (free-running)", self.daemon.visum("status").stdout)
        process.terminate()
        figures, errors = self.end(process, expect=4)
        self.assertEqual(figures["grade"], "L0")
        self.assertIn("not with 'sleep', which runs in real time (L0)", errors)


class Late(InStep):
    """A program that does not come in time, beside another one that wants to go on."""

    SPINS = ["sh", "-c", "while :; do :; done"]

    def go_on(self, process):
        out, errors = process.communicate("go\n", timeout=DEADLINE_S)
        return out.strip(), errors

    def late(self, way, grade):
        other = self.stepper()
        process = self.start(*grade, "--wait", 0.1, "--on-timeout", way, "--tty", "ttyVisum0=arm", "--", *self.SPINS)
        self.addCleanup(lambda: [os.kill(child, signal.SIGKILL) for child in children_of(process, "sh")])
        await_status(self.daemon, lambda status: len(status["lockstep"]) == 2)
        return other, process

    def part_state(self):
        return float(self.daemon.json("get", "arm")["sensor_outputs"]["Part State"])

    def test_end_ends_the_run_of_all(self):
        for grade in (["--lockstep"], GATE):
            other, process = self.late("end", grade)
            self.assertIn("held the lockstep", self.go_on(other)[1])
            self.assertIn("held the lockstep", self.end(process, expect=4)[1])

    def test_stop_lets_others_go_on(self):
        for grade in (["--lockstep"], GATE):
            other, process = self.late("stop", grade)
            self.assertGreaterEqual(int(self.go_on(other)[0]), 200)
            self.assertIn("held the lockstep", self.end(process, expect=4)[1])

    def test_free_lets_it_go_on_in_real_time(self):
        for grade in (["--lockstep"], GATE):
            other, process = self.late("free", grade)
            self.assertGreaterEqual(int(self.go_on(other)[0]), 200)
            await_status(self.daemon, lambda status: len(status["free_running"]) == 1)
            self.assertIsNone(process.poll(), "it runs on")
            process.terminate()
            self.assertIn("real time (L0)", self.end(process, expect=4)[1])

    def test_hold_holds_the_world(self):
        other, process = self.late("hold", GATE)
        other.stdin.write("go\n")
        other.stdin.flush()
        status = await_status(self.daemon, lambda status: any(m["waiting_ns"] > 500_000_000 for m in status["lockstep"]))
        self.assertEqual(status["tick"], 0)
        self.assertEqual(len(status["lockstep"]), 2)
        process.kill()
        self.assertGreaterEqual(int(other.communicate(timeout=DEADLINE_S)[0]), 200, "who dies holds nobody")


class Alone(unittest.TestCase):
    def test_a_time_out_of_its_own_ends_it(self):
        for grade in (["--lockstep"], GATE):
            _, _, errors = run("sh", "-c", "while :; do :; done", grade=grade, options=["--wait", 0.2], expect=4)
            self.assertIn("held the lockstep", errors)

    def test_free_it_comes_to_its_end_in_real_time(self):
        # It computes for longer than it is waited for, then sleeps.
        body = "import time\nend = time.process_time() + 0.4\nwhile time.process_time() < end: pass\ntime.sleep(0.3)\nprint('well')"
        text, figures, errors = run(sys.executable, "-c", body, options=["--wait", 0.1, "--on-timeout", "free"])
        self.assertEqual(text, "well")
        self.assertIn("real time (L0)", errors)
        self.assertGreater(figures["ticks"], 0, "and the world with it")

    def test_a_period_is_where_the_program_wakes_up(self):
        body = "import time\nfor _ in range(5): time.sleep(0.003)\nprint(time.monotonic() - 1000)"
        text, figures, _ = run(sys.executable, "-c", body, options=["--period", 10])
        self.assertAlmostEqual(float(text), 0.05, places=6)
        self.assertEqual(figures["ticks"], 50)


class TooSlow(unittest.TestCase):
    """No host computes a tick of the arm in a microsecond."""

    PACE = 1000

    def test_exec_says_that_the_run_is_invalid(self):
        _, figures, errors = run(WAITS, "usleep", "{bus.arm}", STEPS, grade=[], options=["--speedup", self.PACE], expect=6)
        self.assertEqual((figures["exit_code"], figures["valid"], figures["grade"]), (0, False, "L0"))
        self.assertRegex(errors, r"INVALID: this host is too slow for 1000 x real time: \d+ of \d+ ticks")

    def test_as_many_overruns_may_be_as_are_said(self):
        options = ["--speedup", self.PACE, "--max-overruns", 1]
        self.assertTrue(run(WAITS, "usleep", "{bus.arm}", STEPS, grade=[], options=options)[1]["valid"])

    def test_run_says_so_too_whatever_its_checks_say(self):
        with tempfile.TemporaryDirectory() as folder:
            file, report = pathlib.Path(folder) / "fast.yaml", pathlib.Path(folder) / "report.xml"
            for bound in ("above: -1", "below: -1"):
                file.write_text(f"visum_scenario: 1\nname: fast\nscene: {ARM}\nclock: realtime\nspeedup: {self.PACE}\n"
                                f"until: {{at_s: 0.3}}\nchecks: [{{that: {{time: {{}}, {bound}}}}}]\n")
                done = visum("run", file, "--json", "--junit", report, expect=6)
                result = json.loads(done.stdout.splitlines()[-1])
                self.assertEqual((result["passed"], result["invalid"]), (False, True))
                self.assertIn("INVALID", done.stderr)
                self.assertIn("too slow", report.read_text())
            done = visum("run", file, "--clock", "lockstep", "--speedup", 20, "--json", expect=1)
            self.assertNotIn("invalid", done.stdout, "in lockstep a slow host changes nothing")


class Debugger(InStep):
    """Grade L3: who is stopped freezes the other, and the trajectory is the same to the bit."""

    COMMAND = [WAITS, "usleep"]
    STEPS = 600  # time enough to disturb it in the middle

    def run_disturbed(self, disturb):
        process = self.start("--lockstep", "--", *self.COMMAND, self.tty, self.STEPS)
        disturb(process)
        return self.end(process)[0]

    def in_the_middle(self):
        return await_status(self.daemon, lambda status: status["tick"] > 100)

    def stand_still(self):
        """The tick at which the world stands for a while."""
        tick = await_status(self.daemon, lambda status: True)["tick"]
        while (later := self.daemon.json("status")["tick"]) != tick:
            tick = later
        for _ in range(20):
            self.assertEqual(self.daemon.json("status")["tick"], tick)
        return tick

    def stop_the_program(self, process):
        self.in_the_middle()
        for child in children_of(process, str(WAITS)):
            os.kill(child, signal.SIGSTOP)
            tick = self.stand_still()
            self.assertLess(tick, PERIOD_MS * self.STEPS)
            os.kill(child, signal.SIGCONT)

    def pause_the_world(self, process):
        self.in_the_middle()
        self.daemon.visum("pause")
        tick = self.stand_still()
        self.assertLess(tick, PERIOD_MS * self.STEPS)
        self.assertIsNone(process.poll(), "the program stands too")
        self.daemon.visum("resume")

    def test_the_trajectory_is_the_same_to_the_bit(self):
        hashes = set()
        for disturb in (lambda process: None, self.stop_the_program, self.pause_the_world):
            self.daemon.visum("reset")
            figures = self.run_disturbed(disturb)
            hashes.add(figures["state_hash"])
            self.assertEqual(figures["ticks"], PERIOD_MS * self.STEPS)
        self.assertEqual(len(hashes), 1)


if __name__ == "__main__":
    unittest.main(verbosity=2)
