"""visum run with the real daemon: passing, failing, controllers that crash, hang, or are killed; nothing is left."""
import json
import os
import pathlib
import random
import resource
import signal
import socket
import subprocess
import sys
import tempfile
import textwrap
import unittest
import xml.etree.ElementTree as xml

from programs import ARM, BIN, DEADLINE_S, SOURCE, children_of, processes_with, visum

RESULT = {"passed", "valid", "ticks", "sim_seconds", "wall_seconds", "state_hash"}


def free_port_that_nobody_is_given():
    """Below the range of ports that the kernel hands out to tests that run beside this one."""
    for port in random.sample(range(20000, 30000), 50):
        with socket.socket() as probe:
            try:
                probe.bind(("127.0.0.1", port))
                return port
            except OSError:
                continue
    raise RuntimeError("no free port")


class Scenario(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory(prefix="visum_run_test_")))

    def write(self, text, name="scenario.yaml"):
        """The world is the arm's, in a file of this folder, so that all processes name the folder in their commands."""
        (self.folder / "world.yaml").write_text(f"visum: 1\ninclude: [{ARM}]\n")
        file = self.folder / name
        file.write_text(f"visum_scenario: 1\nname: {file.stem}\nscene: world.yaml\n" + textwrap.dedent(text))
        return file

    def run_it(self, text, *options, expect=0):
        """The result's line, and all that visum did."""
        done = visum("run", self.write(text), "--json", *options, expect=expect)
        result = json.loads(done.stdout.splitlines()[-1])
        self.assertEqual(set(result) - {"tripped"}, RESULT)  # only where a drive is in fault at the end
        self.assertEqual(result["passed"], expect == 0)
        self.assert_nothing_left()
        return result, done

    def assert_nothing_left(self):
        self.assertEqual(processes_with(str(self.folder)), [])


class Worlds(Scenario):
    """Without a controller."""

    def test_passes_with_the_same_bits_every_time(self):
        text = """
            until: {at_s: 0.5}
            timeline:
              - {at_s: 0.1, push: {body: box, force_n: [0.5, 0, 0], duration_s: 0.05}}
              - {at_s: 0.2, set: {part: arm, port: Desired Angle 1, value: 0.1}}
            checks:
              - {that: {tilt: {body: box}, below: 0.1}, when: always}
              - {that: {joint_position: {joint: arm/joint_1}, above: 0.01}}
        """
        results = [self.run_it(text)[0] for _ in range(2)]
        self.assertEqual(results[0]["state_hash"], results[1]["state_hash"])
        self.assertEqual([r["ticks"] for r in results], [500, 500])
        self.assertEqual(results[0]["sim_seconds"], 0.5)

    def test_another_push_gives_other_bits(self):
        text = "until: {{at_s: 0.2}}\ntimeline: [{{at_s: 0.1, push: {{body: box, force_n: [{}, 0, 0]}}}}]\n"
        self.assertNotEqual(self.run_it(text.format(0.5))[0]["state_hash"], self.run_it(text.format(0.6))[0]["state_hash"])

    def test_what_breaks_shows_and_ends(self):
        text = """
            until: {at_s: 0.9}
            timeline:
              - {at_s: 0.1, fault: {part: arm, kind: encoder_stuck, numbers: {joint: 1}, for_s: 0.6}}
              - {at_s: 0.2, set: {part: arm, port: Desired Angle 1, value: 0.5}}
              - {at_s: 0.3, fault: {part: arm, kind: torque_lost, numbers: {joint: 2, share: 0.1}}}
              - {at_s: 0.8, clear_fault: {part: arm, kind: torque_lost, joint: 2}}
            checks:
              - {that: {port: {part: arm, name: Module State 1, mask: 16}, equals: 16}, when: {by_s: 0.7}}
              - {that: {port: {part: arm, name: Actual Angle 1}, between: [-0.001, 0.001]}, when: {to_s: 0.69}}
              - {that: {joint_position: {joint: arm/joint_1}, above: 0.005}}
              - {that: {port: {part: arm, name: Actual Angle 1}, above: 0.005}}
        """
        results = [self.run_it(text)[0] for _ in range(2)]
        self.assertEqual(results[0]["state_hash"], results[1]["state_hash"])
        # The drive that the stuck encoder tripped says so at the end, with its numbers.
        self.assertRegex(results[0]["tripped"][0], r"^arm: joint_1: following error [\d.]+ rad exceeds [\d.]+ rad; ")

    def test_the_values_of_ports_with_names_are_shown_in_words(self):
        text = """
            until: {at_s: 0.2}
            timeline: [{at_s: 0.1, parameter: {part: arm, name: Supply Voltage, value: 5}}]
            checks: [{that: {port: {part: arm, name: Part State}, below: 2}}]
        """
        _, done = self.run_it(text, expect=1)
        self.assertIn('"words":"fault"', done.stdout)

    def test_a_check_that_fails_is_1_and_shows_what_was_measured(self):
        result, done = self.run_it("""
            until: {at_s: 0.05}
            checks:
              - {name: flies, that: {position: {body: box, axis: z}, above: 1}}
              - {name: stands, that: {tilt: {body: box}, below: 0.1}}
        """, expect=1)
        checks = [json.loads(line) for line in done.stdout.splitlines()[:-1]]
        self.assertEqual([(c["check"], c["passed"]) for c in checks], [("flies", False), ("stands", True)])
        self.assertAlmostEqual(checks[0]["value"], 0.24, places=3)
        self.assertRegex(done.stderr, r"FAILED  flies   z of box 0\.2\S+ m at 0\.050 s, must be above 1 m")
        self.assertEqual(result["ticks"], 50)

    def test_ends_when_its_condition_holds_and_settles(self):
        result, _ = self.run_it("until: {time: {}, above: 0.095}\nsettle_s: 0.05\n")
        self.assertEqual(result["ticks"], 150)

    def test_a_condition_that_never_holds_fails(self):
        _, done = self.run_it("until: {position: {body: box, axis: z}, above: 5}\nmax_sim_s: 0.05\n", expect=1)
        self.assertIn("the condition of 'until' never held within max_sim_s, 0.05 s", done.stderr)

    def test_an_entry_that_never_came_due_fails(self):
        _, done = self.run_it("until: {at_s: 0.02}\ntimeline: [{at_s: 5, say: late}]\n", expect=1)
        self.assertRegex(done.stderr, r"scenario\.yaml:5: timeline\[0\]: this entry never came due")

    def test_a_body_that_goes_does_not_confuse_the_others(self):
        self.run_it("""
            until: {at_s: 0.1}
            timeline: [{at_s: 0.05, remove_body: table}]
            checks: [{that: {position: {body: target, axis: x}, equals: 0.5, within: 0.0001}, when: always}]
        """)

    def test_junit(self):
        report = self.folder / "report.xml"
        result, _ = self.run_it("until: {at_s: 0.02}\nchecks: [{name: \"a <b> & c\", that: {tilt: {body: box}, below: 1}}]\n",
                                "--junit", report)
        suite = xml.parse(report).getroot().find("testsuite")
        self.assertEqual([case.get("name") for case in suite.findall("testcase")], ["the run goes to its end", "a <b> & c"])
        properties = {p.get("name"): p.get("value") for p in suite.find("properties")}
        self.assertEqual(properties["state_hash"], result["state_hash"])

    def recordings(self):
        return sorted(file.name for file in self.folder.rglob("*.mcap"))

    def test_a_run_that_fails_leaves_a_recording_beside_its_report(self):
        report = self.folder / "report.xml"
        passes = "until: {at_s: 0.02}\nchecks: [{that: {tilt: {body: box}, below: 1}}]\n"
        fails = passes.replace("below", "above")
        self.run_it(passes, "--junit", report)
        self.assertEqual(self.recordings(), [])
        self.assertNotIn("recording", report.read_text())
        self.run_it(fails, "--junit", report, "--recordings", "off", expect=1)
        self.assertEqual(self.recordings(), [])
        result, _ = self.run_it(fails, "--junit", report, expect=1)
        self.assertEqual(self.recordings(), ["scenario.mcap"])
        properties = {p.get("name"): p.get("value") for p in xml.parse(report).getroot().find("testsuite/properties")}
        self.assertEqual(properties["recording"], str(self.folder / "scenario.mcap"))
        replayed = json.loads(visum("replay", properties["recording"], "--json").stdout)
        self.assertEqual(replayed["state_hash"], result["state_hash"])

    def test_a_recording_in_case_takes_no_other_ones_place(self):
        report = self.folder / "report.xml"
        passes = "until: {at_s: 0.02}\nchecks: [{that: {tilt: {body: box}, below: 1}}]\n"
        fails = passes.replace("below", "above")
        mine = self.folder / "scenario.mcap"
        mine.write_text("mine")
        self.run_it(passes, "--junit", report)
        for number in (2, 3):
            self.run_it(fails, "--junit", report, expect=1)
            self.assertIn(f"scenario_{number}.mcap", report.read_text())
        self.assertEqual(self.recordings(), ["scenario.mcap", "scenario_2.mcap", "scenario_3.mcap"])
        self.assertEqual(mine.read_text(), "mine")
        self.assertEqual([file.name for file in self.folder.iterdir() if file.name.startswith(".")], [])
        self.assertTrue(json.loads(visum("replay", self.folder / "scenario_3.mcap", "--json").stdout)["equal"])

    def test_one_that_cannot_be_made_costs_no_run(self):
        passes = "until: {at_s: 0.02}\nchecks: [{that: {tilt: {body: box}, below: 1}}]\n"
        (self.folder / "file").write_text("")
        _, done = self.run_it(passes, "--recordings", self.folder / "file")
        self.assertIn("if this run fails, it leaves no recording: ", done.stderr)
        wrong = self.write(passes)
        (self.folder / "world.yaml").write_text("visum: 1\nbodies: [{name: b, mass: -1, shapes: [{sphere: 1}]}]\n")
        report = self.folder / "report.xml"
        visum("run", wrong, "--junit", report, expect=3)
        self.assertNotIn("mcap", report.read_text(), "nothing was recorded")

    def run_on_a_small_disk(self, text, room, *options):
        """Runs it where no file can grow beyond `room` bytes: the next write fails, as on a full disk."""
        return subprocess.run([BIN / "visum", "run", self.write(text), *options], capture_output=True, text=True, timeout=DEADLINE_S,
                              restore_signals=False, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (room, room)))

    def test_a_full_disk_costs_a_recording_in_case_and_no_run(self):
        passes = "until: {at_s: 2}\nchecks: [{that: {tilt: {body: box}, below: 1}}]\n"
        for room, trouble in ((0, "cannot be written"), (300_000, "ends early")):
            done = self.run_on_a_small_disk(passes, room, "--recordings", self.folder)
            self.assertEqual(done.returncode, 0, done.stderr)
            done = self.run_on_a_small_disk(passes.replace("below", "above"), room, "--recordings", self.folder)
            self.assertEqual(done.returncode, 1, done.stderr)
            self.assertRegex(done.stdout, rf"  note    (there is no recording: it|the recording) {trouble}: File too large\n")
            self.assertEqual(self.recordings(), [] if room == 0 else ["scenario.mcap"])

    def test_a_full_disk_under_a_recording_that_was_asked_for_is_a_failure(self):
        passes = "until: {at_s: 2}\nchecks: [{that: {tilt: {body: box}, below: 1}}]\n"
        done = self.run_on_a_small_disk(passes, 0, "--record", self.folder / "run.mcap")
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn("run.mcap' cannot be written: File too large", done.stdout)
        done = self.run_on_a_small_disk(passes, 300_000, "--record", self.folder / "run.mcap")
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("  FAILED  the recording ends early: File too large\n", done.stdout)
        self.assertTrue(done.stdout.endswith("FAILED: 1 of 1 checks\n"))

    def test_under_ci_a_run_that_fails_leaves_a_recording(self):
        fails = "until: {at_s: 0.02}\nchecks: [{that: {tilt: {body: box}, above: 1}}]\n"
        for word, left in (("false", []), ("true", ["scenario.mcap"])):
            environment = {**os.environ, "CI": word}
            done = subprocess.run([BIN / "visum", "run", self.write(fails)], cwd=self.folder, env=environment, capture_output=True,
                                  timeout=DEADLINE_S)
            self.assertEqual(done.returncode, 1, done.stderr)
            self.assertEqual(self.recordings(), left)

    def test_every_clock(self):
        for clock in ("lockstep", "free", "realtime"):
            # A host that is busy with other tests may be late as often as it likes.
            result, _ = self.run_it("until: {at_s: 0.05}\nmax_overruns: 1\n", "--clock", clock)
            self.assertGreaterEqual(result["sim_seconds"], 0.05)

    def test_many_side_by_side(self):
        file = self.write("until: {at_s: 0.05}\n")
        runs = [subprocess.Popen([BIN / "visum", "run", file, "--json"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
                                 text=True) for _ in range(4)]
        hashes = {json.loads(run.communicate(timeout=DEADLINE_S)[0].splitlines()[-1])["state_hash"] for run in runs}
        self.assertEqual(len(hashes), 1)


class WrongFiles(Scenario):
    def error(self, text, line, key, reason):
        done = visum("run", self.write(text), expect=3)
        self.assertIn(f"scenario.yaml:{line}: {key}: {reason}", done.stdout + done.stderr)
        self.assert_nothing_left()

    def test_names_that_only_the_world_knows_are_3(self):
        self.error("until: {at_s: 1}\nchecks: [{that: {tilt: {body: bux}, below: 1}}]\n", 5, "checks[0].that.tilt",
                   "there is no body 'bux'; did you mean 'box'?")
        self.error("until: {at_s: 1}\nchecks: [{that: {port: {part: arm, name: Part Stat}, below: 1}}]\n", 5,
                   "checks[0].that.port", "there is no port of part 'arm' called 'Part Stat'; did you mean 'Part State'?")
        self.error("until: {at_s: 1}\ntimeline: [{at_s: 0, set: {part: arm, port: Halt, value: -5}}]\n", 5, "timeline[0]",
                   "port 'Halt' takes")
        self.error("until: {at_s: 1}\ntimeline: [{at_s: 0.5, parameter: {part: arm, name: Supply Voltage, value: low}}]\n", 5,
                   "timeline[0]", "parameter 'Supply Voltage' takes 0 .. 60, not 'low'")

    def test_a_scene_that_is_wrong_is_3_with_its_own_line(self):
        (self.folder / "scene.yaml").write_text("visum: 1\nbodies:\n  - {name: b, mass: -1, shapes: [{sphere: 1}]}\n")
        file = self.folder / "scenario.yaml"
        file.write_text("visum_scenario: 1\nname: n\nscene: scene.yaml\nuntil: {at_s: 1}\n")
        done = visum("run", file, expect=3)
        self.assertRegex(done.stdout + done.stderr, r"scene\.yaml:3: bodies\[0\]\.mass")

    def test_a_file_that_is_not_there_is_3(self):
        self.assertIn("/nowhere.yaml", visum("run", "/nowhere.yaml", expect=3).stderr)

    def test_a_controller_that_cannot_be_started_is_3(self):
        self.error("controllers: [{name: c, command: [/nowhere/program]}]\n", 4, "controllers[0]",
                   "cannot start '/nowhere/program': No such file or directory")

    def test_a_report_that_cannot_be_written_is_2(self):
        visum("run", self.write("until: {at_s: 1}\n"), "--junit", "/nowhere/report.xml", expect=2)


class Controllers(Scenario):
    """Small controllers in Python, with the protocol's own client, beside the real one."""

    PICK = '["{bin}/visum-pick-and-place", "--connect", "{connect}", "--urdf", "%s", "--from", "0.5,0.2", "--to", "0.5,-0.2"]' % (
        SOURCE / "models/amtec_arm/amtec_arm.urdf")

    def pick(self, more=""):
        return f"""
            max_sim_s: 60
            controllers: [{{name: pick, client: visum-pick-and-place, command: {self.PICK}}}]
            {more}
        """

    def test_one_that_ends_badly_before_it_joined_is_1_with_its_last_words(self):
        _, done = self.run_it("controllers: [{name: c, command: [sh, -c, 'echo oh dear; exit 7']}]\n", expect=1)
        self.assertIn("controller 'c' exited with code 7 before it joined the clock", done.stderr)
        self.assertIn("| oh dear", done.stderr)

    def test_one_that_ends_badly_is_1_however_early_or_late(self):
        for clock in ("realtime", "free", "lockstep"):
            for sleep in (0, 0.05):
                _, done = self.run_it(f"max_overruns: 1\ncontrollers: [{{name: c, joins: false, command: [sh, -c, 'sleep {sleep}; exit 7']}}]\n",
                                      "--clock", clock, expect=1)
                self.assertIn("controller 'c' exited with code 7", done.stderr)

    # It computes for longer than it is waited for, then sleeps.
    SPINS = "import time\nend = time.process_time() + 0.4\nwhile time.process_time() < end: pass\ntime.sleep({})\nprint('well')\n"

    def late(self, way, expect, sleep=0.3, more=""):
        program = self.folder / "spins.py"
        program.write_text(self.SPINS.format(sleep))
        command = f"[{sys.executable}, {program}]"
        return self.run_it(f"max_sim_s: 20\ncontrollers: [{{name: c, shim: true, exchanges: false, wait_s: 0.1, on_timeout: {way}, command: {command}}}]\n" + more,
                           expect=expect)

    def test_one_that_is_late_may_end_the_run_or_be_stopped_or_go_on(self):
        _, done = self.late("end", 4)
        self.assertIn("held the lockstep", done.stderr)
        result, done = self.late("free", 0)
        self.assertIn("it goes on in real time", done.stderr)
        self.assertIn("c | well", done.stderr)
        self.assertGreater(result["sim_seconds"], 0.2, "and the world with it")
        self.assertLess(result["sim_seconds"], 10, "but no faster")
        result, done = self.late("stop", 4, 1000, "until: {at_s: 1}\n")
        self.assertIn("its parts are stopped", done.stderr)
        self.assertEqual(result["ticks"], 1000, "the others went on")

    def test_one_that_never_joins_is_4(self):
        _, done = self.run_it("start_wall_s: 4\ncontrollers: [{name: c, command: [sleep, '1000']}]\n", expect=4)
        self.assertIn("controller 'c' has not joined the clock within 4 s", done.stderr)

    def test_one_that_does_not_join_may_end_whenever_it_likes(self):
        result, done = self.run_it("controllers: [{name: c, joins: false, exchanges: false, command: [sh, -c, 'echo $0 {port}', hello]}]\n")
        self.assertRegex(done.stderr, r"c \| hello \d+")

    def test_one_that_is_killed_by_the_time_line_stops_the_arm(self):
        text = self.pick("""until: {at_s: 2.5}
            timeline: [{at_s: 1.5, kill: pick}]
            checks:
              - {name: fault, that: {port: {part: arm, name: Part State}, above: 1.5}}
              - {name: stopped, that: {joint_speed: {joint: arm/joint_2}, between: [-0.001, 0.001]}}""")
        results = [self.run_it(text)[0] for _ in range(2)]
        self.assertEqual(results[0]["state_hash"], results[1]["state_hash"], "also a kill is the same every time")

    def test_one_that_is_killed_from_outside_is_4(self):
        process = subprocess.Popen([BIN / "visum", "run", self.write(self.pick()), "--json"], stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, text=True)
        for line in process.stderr:
            if line.startswith("pick |"):
                break
        (victim,) = children_of(process, "visum-pick-and-place")
        os.kill(victim, signal.SIGKILL)
        out, err = process.communicate(timeout=DEADLINE_S)
        self.assertEqual(process.returncode, 4, err)
        self.assertIn("was ended by signal 9 (Killed)", err)
        self.assertFalse(json.loads(out.splitlines()[-1])["passed"])

    def test_one_that_hangs_in_the_lockstep_is_4(self):
        scene = self.folder / "impatient.yaml"
        scene.write_text(f"visum: 1\ninclude: [{ARM}]\nlockstep_timeout_s: 0.5\n")
        text = self.pick("timeline: [{at_s: 1, say: now}]")
        file = self.write(text)
        file.write_text(file.read_text().replace("world.yaml", scene.name))
        process = subprocess.Popen([BIN / "visum", "run", file, "--json"], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                   text=True)
        for line in process.stderr:
            if line.startswith("scenario | now"):
                break
        (victim,) = children_of(process, "visum-pick-and-place")
        os.kill(victim, signal.SIGSTOP)
        _, err = process.communicate(timeout=DEADLINE_S)
        self.assertEqual(process.returncode, 4, err)
        self.assertIn("'visum-pick-and-place' held the lockstep", err)
        self.assert_nothing_left()

    def test_wall_time_that_is_over_is_124(self):
        _, done = self.run_it("start_wall_s: 100\ncontrollers: [{name: c, command: [sleep, '1000']}]\n", "--timeout", "0.5",
                              expect=124)
        self.assertIn("not done after 0.5 s of wall time", done.stderr)

    def test_a_controller_that_prints_without_end_blocks_nothing(self):
        self.run_it("until: {at_s: 0.2}\ncontrollers: [{name: c, joins: false, exchanges: false, command: ['yes']}]\n")


class Ends(Scenario):
    """However visum ends, nothing of it is left."""

    def start(self, text, *options):
        process = subprocess.Popen([BIN / "visum", "run", self.write(text), *options], stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, text=True)
        line = ""
        while "ready" not in line:
            line = process.stderr.readline()
            self.assertTrue(line, "visum ended too early")
        self.assertTrue(processes_with(str(self.folder)))
        return process

    TEXT = "max_sim_s: 1e5\nuntil: {at_s: 1e5}\ntimeline: [{at_s: 0.01, say: ready}]\n" \
           "controllers: [{name: c, joins: false, command: [sh, -c, 'sleep 1000; true', '{scenario_dir}']}]\n"

    def test_by_interrupt(self):
        process = self.start(self.TEXT)
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=DEADLINE_S)
        self.assertEqual(process.returncode, 130, err)
        self.assert_nothing_left()

    def test_by_kill(self):
        process = self.start(self.TEXT)
        process.kill()
        process.communicate(timeout=DEADLINE_S)
        for _ in range(1000):  # the kernel kills them when it gets to it
            if not processes_with(str(self.folder)):
                break
            subprocess.run(["sleep", "0.01"], check=True)
        self.assert_nothing_left()

    def test_by_the_death_of_the_daemon(self):
        process = self.start(self.TEXT)
        (victim,) = children_of(process, "visumd")
        os.kill(victim, signal.SIGKILL)
        out, err = process.communicate(timeout=DEADLINE_S)
        self.assertEqual(process.returncode, 6, "that says nothing about the scenario: " + err)
        self.assertIn("visumd was ended by signal 9 (Killed)", out)
        self.assert_nothing_left()

    # As on a slow machine, whose runs are invalid.
    def test_keep_goes_on_after_an_invalid_run_too(self):
        silent = "controllers: [{name: c, joins: false, command: [echo, hello]}]\n"
        told = self.keep_and_watch("until: controllers\n" + silent, 6, "INVALID")
        self.assertIn(("line", "info", "scenario", "c: hello"), told)

    def test_keep_goes_on_until_it_is_interrupted(self):
        check = "checks: [{name: upright, that: {tilt: {body: box}, below: 1}}]\n"
        told = self.keep_and_watch("until: {at_s: 0.05}\n" + check, 0, "PASSED: 1 of 1 checks")
        self.assertIn(("check", "info", "scenario", "upright: passed"), told)

    def keep_and_watch(self, text, code, verdict):
        process = subprocess.Popen([BIN / "visum", "run", self.write(text), "--keep"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        connect = None
        while connect is None:
            line = process.stderr.readline()
            self.assertTrue(line, "visum ended too early")
            if "visum watch arm" in line:
                connect = line.split("--connect ")[1].strip()
        samples = visum("watch", "arm", "Part State", "--every", "10", "--count", "5", "--json", "--connect", connect).stdout
        ticks = [json.loads(sample)["tick"] for sample in samples.splitlines()]
        self.assertEqual(ticks, sorted(set(ticks)), "time goes on")
        events = map(json.loads, visum("events", "--json", "--connect", connect).stdout.splitlines())
        told = [(event["kind"], event["level"], event["source"], event["text"]) for event in events]
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=DEADLINE_S)
        self.assertEqual(process.returncode, code, err)
        self.assertIn(verdict, out)
        self.assert_nothing_left()
        return told

    def test_a_fixed_port(self):
        port = free_port_that_nobody_is_given()
        text = "controllers: [{name: c, joins: false, exchanges: false, command: [echo, '{connect}']}]\n"
        done = visum("run", self.write(text), "--port", port)
        self.assertIn(f"c | 127.0.0.1:{port}", done.stderr)


if __name__ == "__main__":
    unittest.main()
