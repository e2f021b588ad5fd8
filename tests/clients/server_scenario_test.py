"""A server that runs scenarios of its installation beside its world, by the command line and by Python."""
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import textwrap
import time
import unittest

from programs import ARM, BIN, DEADLINE_S, Daemon, processes_with, visum as run_visum

sys.path.insert(0, str(BIN.parent / "python"))
import visum  # noqa: E402

FOLDER_WORD = "visum_server_scenario_"
LASTS = "max_sim_s: 100000\nuntil: {at_s: 90000}\nclock: realtime\n"  # longer than any test
TALKS = """
    until: {at_s: 0.4}
    controllers: [{name: talker, joins: false, exchanges: false, command: [sh, -c, 'echo it begins; sleep 0']}]
    checks:
      - {name: never tips over, that: {tilt: {body: box}, below: 1}, when: always}
      - {name: is there soon, that: {position: {body: box, axis: z}, above: 0.1}, when: eventually}
"""


class ServerScenario(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory(prefix=FOLDER_WORD)))
        self.servers = []
        (self.folder / "models" / "scenarios").mkdir(parents=True)
        (self.folder / "models" / "world.yaml").write_text(f"visum: 1\ninclude: [{ARM}]\n")

    def write(self, name, text):
        file = self.folder / "models" / "scenarios" / f"{name}.yaml"
        file.write_text(f"visum_scenario: 1\nname: {name}\nscene: ../world.yaml\n" + textwrap.dedent(text))

    def serve(self, *options, clock="free", program=None):
        daemon = Daemon("--clock", clock, "--models", self.folder / "models", "--files", self.folder, *options)
        if program:
            daemon.command[0] = str(program)
        self.enterContext(daemon)
        self.daemon = daemon
        self.servers.append(daemon.process.pid)
        self.admin = self.enterContext(visum.Client(daemon.connect, role="admin", name="boss"))
        return daemon

    def follow(self):
        """Those events that are about scenarios, until one has ended."""
        told, give_up = [], time.monotonic() + DEADLINE_S
        while not any(event.kind == "scenario" and "begins" not in event.text for event in told):
            self.assertLess(time.monotonic(), give_up)
            told += [event for event in self.admin.events() if event.kind in ("scenario", "line", "check")]
            time.sleep(0.01)
        return told

    def refused(self, code, text, *words, **more):
        with self.assertRaises(visum.Error) as refused:
            self.admin.run_scenario(*words, **more)
        self.assertEqual(refused.exception.code, code)
        self.assertIn(text, str(refused.exception))

    def others(self):
        """Finds the processes of the scenario: all that name our folder, but for the servers themselves."""
        return [pid for pid in processes_with(str(self.folder)) if pid not in self.servers]

    def wait_for_nobody(self):
        give_up = time.monotonic() + DEADLINE_S
        while self.others():
            self.assertLess(time.monotonic(), give_up, "processes are left over")
            time.sleep(0.01)

    def wait_for_its_world(self):
        """Until the scenario's own visumd is there; the process of `visum run`. One that was forked and has not yet
        become its program has its parent's command line: it is not there yet."""
        give_up = time.monotonic() + DEADLINE_S
        while True:
            others = self.others()
            runners = [pid for pid in processes_with("--events") if pid in others]
            if len(runners) == 1 and len(others) >= 2:
                return runners[0]
            self.assertLess(time.monotonic(), give_up, "the scenario does not begin")
            time.sleep(0.01)


class Courses(ServerScenario):
    def test_one_that_passes_tells_its_lines_checks_and_hash(self):
        for clock in ("free", "realtime", "lockstep"):
            with self.subTest(clock=clock):
                self.write("talks", TALKS)
                self.serve(clock=clock)
                self.admin.subscribe_events()
                self.admin.run_scenario("talks")
                told = self.follow()
                self.assertEqual([(e.kind, e.source, e.level) for e in told[:1]], [("scenario", "boss", visum_level("info"))])
                self.assertIn(("line", "talks", "talker: it begins"), [(e.kind, e.source, e.text) for e in told])
                checks = [e.text for e in told if e.kind == "check"]
                self.assertEqual([text.split(",")[0] for text in checks], ["is there soon: passed", "never tips over: passed"],
                                 "as they become certain")
                self.assertRegex(told[-1].text, r"^the scenario 'talks' has passed: 2 of 2 checks; exit code 0, state hash [0-9a-f]{16}$")
                state = self.admin.scenario()
                self.assertEqual((state.name, state.running, state.exit_code, len(state.checks)), ("talks", False, 0, 2))
                alone = json.loads(run_visum("run", self.folder / "models/scenarios/talks.yaml", "--json").stdout.splitlines()[-1])
                self.assertEqual(f"{state.state_hash:016x}", alone["state_hash"])
                self.assertEqual(self.others(), [])

    def test_one_that_fails_says_which_check(self):
        self.write("tips", "until: {at_s: 0.1}\nchecks: [{name: flies, that: {position: {body: box, axis: z}, above: 5}}]\n")
        self.serve()
        done = self.daemon.visum("scenario", "start", "tips", "--wait", expect=1)
        self.assertIn("FAILED  flies: ", done.stdout)
        self.assertIn("flies: failed, ", done.stderr)
        state = self.daemon.json("scenario", "status")
        self.assertEqual((state["verdict"], state["exit_code"]), ("failed", 1))
        self.assertEqual([(c["check"], c["passed"]) for c in state["checks"]], [("flies", False)])

    def test_one_that_proves_nothing_is_invalid(self):
        self.write("silent", "until: {at_s: 0.05}\ncontrollers: [{name: c, joins: false, command: [echo, hello]}]\n")
        self.write("wrong", "until: {at_s: 0.05}\nchecks: [{that: {position: {body: bix, axis: z}, above: 5}}]\n")
        self.write("broken", "untill: {at_s: 0.05}\n")
        self.serve()
        for name, code, why in (("silent", 6, "exchanged nothing"), ("wrong", 3, "did you mean 'box'"), ("broken", 3, "untill")):
            with self.subTest(name):
                self.daemon.visum("scenario", "start", name, "--wait", expect=code)
                state = self.daemon.json("scenario", "status")
                self.assertEqual((state["verdict"], state["exit_code"]), ("invalid", code))
                self.assertIn(why, state["text"])

    def test_a_sweep_tells_its_runs(self):
        self.write("sweeps", "until: {at_s: 0.05}\nsweep: {height: [0.1, 5]}\n"
                             "checks: [{that: {position: {body: box, axis: z}, above: '${height}'}}]\n")
        self.serve()
        self.daemon.visum("scenario", "start", "sweeps", "--wait", expect=1)
        state = self.admin.scenario()
        self.assertEqual([(c.name, c.passed) for c in state.checks], [("run 1: height=0.1", True), ("run 2: height=5", False)])
        self.assertEqual(state.text, "1 of 2 runs")

    def test_the_world_of_the_server_goes_on_and_is_not_touched(self):
        self.write("talks", TALKS)
        self.serve(clock="lockstep")
        self.admin.join()
        self.admin.advance_ms(100)
        before = self.admin.status()
        self.daemon.visum("scenario", "start", "talks")
        self.admin.advance_ms(100)
        while self.admin.scenario().running:
            time.sleep(0.01)
        after = self.admin.status()
        self.assertEqual((after.tick, after.era), (before.tick + 100, before.era))

    def test_a_flood_of_lines_is_bounded_and_costs_no_check(self):
        self.write("floods", """
            until: controllers
            max_sim_s: 1000
            controllers: [{name: c, joins: false, exchanges: false, command: [sh, -c, 'yes flood | head -n 20000']}]
            checks: [{name: stands, that: {tilt: {body: box}, below: 1}}]
        """)
        self.serve()
        self.admin.subscribe_events()
        self.admin.run_scenario("floods")
        told = self.follow()
        lines = [e for e in told if e.kind == "line"]
        self.assertLess(len(lines), 5000)
        self.assertIn("stands: passed", [e.text.split(",")[0] for e in told if e.kind == "check"])
        self.assertEqual(self.admin.scenario().exit_code, 0)


def visum_level(name):
    return {"info": 2, "warning": 3, "error": 4}[name]


class Refusals(ServerScenario):
    def test_names_are_no_paths(self):
        self.write("talks", TALKS)
        (self.folder / "models" / "outside.yaml").write_text("visum_scenario: 1\n")
        self.serve()
        for name in ("../outside", "/etc/passwd", "../scenarios/talks", "talks.yaml", "a/b", "", ".", "x" * 65, "--help", "a\0b"):
            self.refused(visum.ErrorCode.BAD_VALUE, "no path", name)
        self.refused(visum.ErrorCode.UNKNOWN_NAME, "did you mean 'talks'", "talk")
        self.assertIn("did you mean 'talks'", self.daemon.visum("scenario", "start", "talk", expect=2).stderr)
        self.refused(visum.ErrorCode.BAD_VALUE, "timeout_ns", "talks", timeout_s=86401)
        self.refused(visum.ErrorCode.BAD_VALUE, "timeout_ns", "talks", timeout_s=-1)
        self.assertEqual(self.admin.scenario().name, "")
        self.assertIn("no scenario has run", self.daemon.visum("scenario", "status").stdout)

    def test_only_administrators_start_and_stop(self):
        self.write("talks", TALKS)
        self.serve()
        for role in ("observer", "controller"):
            with visum.Client(self.daemon.connect, role=role) as other:
                for call in (lambda: other.run_scenario("talks"), other.stop_scenario):
                    with self.assertRaises(visum.Error) as refused:
                        call()
                    self.assertEqual(refused.exception.code, visum.ErrorCode.FORBIDDEN)
                self.assertEqual(other.scenario().name, "")

    def test_one_at_a_time(self):
        self.write("lasts", LASTS)
        self.write("talks", TALKS)
        self.serve()
        with self.assertRaises(visum.Error) as refused:
            self.admin.stop_scenario()
        self.assertEqual(refused.exception.code, visum.ErrorCode.WRONG_STATE)
        self.admin.run_scenario("lasts")
        self.refused(visum.ErrorCode.BUSY, "'lasts' runs", "talks")
        self.daemon.visum("scenario", "stop")
        while self.admin.scenario().running:
            time.sleep(0.01)
        self.admin.run_scenario("talks")

    def test_it_needs_visum_beside_the_server(self):
        self.write("talks", TALKS)
        bin_folder = self.folder / "bin"
        bin_folder.mkdir()
        shutil.copy2(BIN / "visumd", bin_folder / "visumd")
        self.serve(program=bin_folder / "visumd")
        self.refused(visum.ErrorCode.WRONG_STATE, f"there is no {bin_folder / 'visum'}", "talks")


class Ends(ServerScenario):
    def start_lasting(self, **more):
        self.write("lasts", LASTS)
        self.serve(**more)
        self.admin.subscribe_events()

    def test_a_stop_ends_all_of_it(self):
        self.start_lasting()
        self.admin.run_scenario("lasts")
        self.wait_for_its_world()
        self.admin.stop_scenario()
        self.assertIn("is invalid: stopped; exit code 130", self.follow()[-1].text)
        self.assertEqual(self.others(), [])

    def test_its_time_is_bounded(self):
        self.start_lasting()
        self.admin.run_scenario("lasts", timeout_s=0.5)
        self.assertIn("is invalid: ended after 1 s, the time that it was given", self.follow()[-1].text)
        self.assertEqual(self.others(), [])

    def test_ctrl_c_of_the_command_stops_it(self):
        self.start_lasting()
        command = subprocess.Popen([BIN / "visum", "scenario", "start", "lasts", "--wait", "--connect", self.daemon.connect],
                                   stdout=subprocess.PIPE, text=True)
        while not self.admin.scenario().running:
            time.sleep(0.01)
        command.send_signal(signal.SIGINT)
        out, _ = command.communicate(timeout=DEADLINE_S)
        self.assertEqual((command.returncode, "stopped" in out), (130, True), out)

    def test_it_ends_with_the_server_in_good_order(self):
        for clock in ("realtime", "free"):
            with self.subTest(clock=clock):
                self.start_lasting(clock=clock)
                self.admin.run_scenario("lasts")
                self.wait_for_its_world()
                self.daemon.process.terminate()
                self.assertEqual(self.daemon.process.wait(DEADLINE_S), 0)
                self.assertEqual(self.others(), [])

    def test_it_ends_with_a_server_that_is_killed(self):
        self.start_lasting(clock="realtime")
        self.admin.run_scenario("lasts")
        self.wait_for_its_world()
        os.kill(self.daemon.process.pid, signal.SIGKILL)
        self.daemon.process.wait(DEADLINE_S)
        self.wait_for_nobody()

    def test_a_runner_that_is_killed_is_told(self):
        self.start_lasting()
        self.admin.run_scenario("lasts")
        runner = self.wait_for_its_world()
        os.kill(runner, signal.SIGHUP)  # whose number is that of a failed run
        self.assertIn("visum run was ended by signal 1 (Hangup)", self.follow()[-1].text)
        self.assertEqual((self.admin.scenario().exit_code, self.admin.scenario().running), (129, False))
        self.wait_for_nobody()

    def test_the_child_has_none_of_the_servers_files(self):
        self.start_lasting()
        self.admin.run_scenario("lasts")
        runner = self.wait_for_its_world()
        sockets = {os.readlink(f) for f in pathlib.Path(f"/proc/{self.daemon.process.pid}/fd").iterdir() if "socket" in os.readlink(f)}
        held = {os.readlink(f) for f in pathlib.Path(f"/proc/{runner}/fd").iterdir()}
        self.assertTrue(sockets)
        self.assertEqual(sockets & held, set())
        self.admin.stop_scenario()
        self.follow()


if __name__ == "__main__":
    unittest.main()
