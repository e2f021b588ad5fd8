"""The command line against a real daemon: what it prints, and its exit codes."""
import json
import os
import pathlib
import pty
import re
import signal
import subprocess
import sys
import tempfile
import termios
import unittest

from programs import ARM, BIN, DEADLINE_S, Daemon, SOURCE, visum

sys.path.insert(0, str(BIN.parent / "python"))
from visum import Client, visum_pb2 as pb  # noqa: E402

URDF = SOURCE / "models" / "amtec_arm" / "amtec_arm.urdf"
QUERIES = [("parts",), ("describe", "arm"), ("get", "arm"), ("get", "arm", "Actual Angle"), ("params", "arm"), ("status",)]


class Usage(unittest.TestCase):
    def test_version_and_help(self):
        self.assertRegex(visum("--version").stdout, r"^visum \d+\.\d+\.\d+\n$")
        self.assertIn("Exit codes", visum("--help").stdout)

    def test_every_verb_has_help_with_an_example(self):
        verbs = re.findall(r"^  ([a-z-]+)  +\w", visum("--help").stdout.split("Subcommands:")[1], re.M)
        self.assertGreater(len(verbs), 15)
        for verb in verbs:
            self.assertRegex(visum(verb, "--help").stdout, r"Examples?:\n  (source <\()?visum", verb)

    def test_wrong_usage_is_2(self):
        for words in ([], ["prats"], ["get"], ["get", "arm", "--nonsense"], ["step", "0"], ["step", "x"], ["speedup", "0"],
                      ["speedup", "nan"], ["push", "box", "1", "2"], ["completion", "tcsh"], ["run"],
                      ["parts", "--connect", "here:there"], ["parts", "--connect", "localhost:0"],
                      ["parts", "--token-file", "/nowhere"]):
            visum(*words, expect=2)

    def test_no_number_is_infinite_or_no_number(self):
        scenario = SOURCE / "models/scenarios/two_link_wave.yaml"
        for words in (["rewind", "run.mcap", "--at"], ["export", "run.mcap", "--from"], ["export", "run.mcap", "--to"],
                      ["record", "run.mcap", ARM, "--speedup"], ["run", scenario, "--node-timeout"], ["run", scenario, "--speedup"],
                      ["check", ARM, "--node-timeout"], ["push", "box", "1", "2"], ["fault", "arm", "network_delay", "--for"],
                      ["watch", "arm", "--every"], ["exec", "--period"], ["exec", "--wait"], ["mirror", "--speedup"]):
            for number in ("nan", "inf", "NAN", "Infinity"):
                self.assertRegex(visum(*words, number, expect=2).stderr, rf"{number}'? (is )?not ", words)

    def test_nobody_there_is_4(self):
        with Daemon("--clock", "lockstep") as daemon:
            connect = daemon.connect
        done = visum("parts", "--connect", connect, expect=4)
        self.assertIn(f"nothing listens at {connect}", done.stderr)

    def test_connect_comes_from_the_environment_too(self):
        with Daemon("--clock", "lockstep") as daemon:
            self.assertEqual(visum("parts", "--names", env={"VISUM_CONNECT": daemon.connect}).stdout, "arm\n")


class Limits(unittest.TestCase):
    def test_status_counts_ticks_that_met_the_limit_of_their_work_and_names_bodies(self):
        with tempfile.TemporaryDirectory() as folder:
            scene = pathlib.Path(folder) / "heap.yaml"
            scene.write_text("visum: 1\nengine: {kind: impulse, work_limit: 1}\nbodies:\n"
                             "  - {name: floor, fixed: true, shapes: [{plane: true}]}\n" + "".join(
                                 f"  - {{name: box_{i}, mass: 1, pose: {{xyz: [{0.02 * i}, 0, {0.05 + 0.03 * i}]}}, "
                                 "shapes: [{box: [0.1, 0.1, 0.1]}]}\n" for i in range(5)))
            with Daemon("--clock", "realtime", scene=scene) as daemon:
                daemon.visum("pause")
                before = daemon.json("status")["limited_ticks"]
                daemon.visum("step", "25")
                status = daemon.json("status")
                self.assertEqual(status["limited_ticks"], before + 25)
                self.assertTrue(set(status["limited_bodies"]) <= {f"box_{i}" for i in range(5)}, status["limited_bodies"])
                self.assertIn(" ticks met the limit of their work", daemon.visum("status").stdout)


class Queries(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.daemon = cls.enterClassContext(Daemon("--clock", "lockstep"))

    def test_every_query_prints_one_json_value(self):
        for words in QUERIES:
            self.assertIsInstance(json.loads(self.daemon.visum(*words, "--json").stdout), dict, words)
            self.assertTrue(self.daemon.visum(*words).stdout, words)

    def test_parts(self):
        self.assertEqual(self.daemon.json("parts"),
                         {"parts": [{"name": "arm", "kind": "amtec_arm", "lease_owner": "", "state": "ready",
                                     "tripped": ""}]})

    def test_describe_names_every_port_with_index_unit_and_range(self):
        part = self.daemon.json("describe", "arm")
        first = part["controller_inputs"][0]
        self.assertEqual((first["index"], first["name"], first["unit"]), (0, "Desired Angle 1", "rad"))
        self.assertLess(first["minimum"], first["maximum"])
        names = self.daemon.visum("describe", "arm", "--names").stdout.splitlines()
        self.assertEqual(names, [p["name"] for p in part["controller_inputs"] + part["sensor_outputs"]])

    def test_get_of_one_port_is_a_number_alone(self):
        self.assertEqual(float(self.daemon.visum("get", "arm", "Actual Angle 2").stdout),
                         self.daemon.json("get", "arm", "Actual Angle 2")["ports"]["Actual Angle 2"])

    def test_get_of_a_group_is_all_of_it(self):
        ports = self.daemon.json("get", "arm", "Actual Angle")["ports"]
        self.assertEqual(list(ports), [f"Actual Angle {i}" for i in range(1, 8)])

    def test_unknown_names_are_told_with_the_nearest(self):
        self.assertEqual(self.daemon.visum("get", "amr", expect=2).stderr,
                         "visum: there is no part 'amr'; did you mean 'arm'?\n")
        self.assertEqual(self.daemon.visum("get", "arm", "Actual Angel 1", expect=2).stderr,
                         "visum: part 'arm' has no port 'Actual Angel 1'; did you mean 'Actual Angle 1'?\n")

    def test_status_names_clock_and_hash(self):
        status = self.daemon.json("status")
        self.assertEqual((status["clock"], status["tick"], status["simulated"]), ("lockstep", 0, True))
        self.assertRegex(status["state_hash"], r"^[0-9a-f]{16}$")

    def test_status_shows_what_a_client_is_busy_with_without_what_steers_the_terminal(self):
        with Client(self.daemon.connect, name="waiter") as client:
            client.join()
            client.connection.request(note=pb.Note(text="waits\033[2J for\nits turn"))
            self.assertIn("waiter: L4 (steps of its own), lets the world run up to tick 0", text := self.daemon.visum("status").stdout)
            self.assertRegex(text, r"; it waits\\x1b\[2J for\\x0aits turn\n")

    def test_what_cannot_be_printed_is_1_but_for_a_reader_that_has_seen_enough(self):
        for words in (["get", "arm", "--connect", self.daemon.connect], ["get", "--help"]):
            with open("/dev/full", "w") as full:
                done = subprocess.run([BIN / "visum", *words], stdout=full, stderr=subprocess.PIPE, text=True, timeout=DEADLINE_S)
            self.assertEqual(done.returncode, 1)
            self.assertRegex(done.stderr, "^visum: standard output: cannot be written(: No space left on device)?\n$")
            reader, writer = os.pipe()
            os.close(reader)
            done = subprocess.run([BIN / "visum", *words], stdout=writer, stderr=subprocess.PIPE, text=True, timeout=DEADLINE_S)
            os.close(writer)
            self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_no_colours_in_a_pipe(self):
        self.assertNotIn("\033", self.daemon.visum("status").stdout)


class Commands(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.daemon = cls.enterClassContext(Daemon("--clock", "realtime", "--speedup", "20", "--run"))

    def get(self, port):
        return float(self.daemon.visum("get", "arm", port).stdout)

    def test_set_is_in_force_when_it_returns_and_holds_after_it(self):
        self.daemon.visum("set", "arm", "Maximum Speed 1", "0.25", "Desired Angle 1", "0.5")
        self.assertEqual(self.get("Maximum Speed 1"), 0.25)
        self.assertEqual(self.get("Desired Angle 1"), 0.5)
        self.assertEqual(self.daemon.json("parts")["parts"][0]["lease_owner"], "")
        self.assertLess(self.get("Part State"), 2, "a release in good order is no fault")
        done = self.daemon.json("set", "arm", "Maximum Speed 1", "0.5")
        self.assertEqual((done["part"], done["applied"]), ("arm", True))

    def test_set_takes_negative_numbers(self):
        self.daemon.visum("set", "arm", "Desired Angle 7", "-0.25")
        self.assertEqual(self.get("Desired Angle 7"), -0.25)

    def test_set_of_nonsense_is_2_and_changes_nothing(self):
        before = self.daemon.json("get", "arm", "Desired Angle")["ports"]
        for words in (["Desired Angle 1"], ["Desired Angle 1", "nan"], ["Desired Angle 1", "1e9"],
                      ["Actual Angle 1", "1"], ["Desired Angel 1", "1"],
                      ["Desired Angle 1", "0.1", "Desired Angle 1", "0.2"], ["Desired Angle 1", "0.1", "Desired Angle 2", "x"]):
            self.daemon.visum("set", "arm", *words, expect=2)
        self.assertEqual(self.daemon.json("get", "arm", "Desired Angle")["ports"], before)

    def test_set_of_a_value_out_of_range_names_port_and_range(self):
        error = self.daemon.visum("set", "arm", "Desired Angle 1", "1e9", expect=2).stderr
        self.assertRegex(error, r"^visum: port 'Desired Angle 1' of part 'arm' takes -\S+ .. \S+ rad, not '1e9'\n$")

    def test_what_the_part_refuses_as_a_whole_leaves_the_lease_free(self):
        error = self.daemon.visum("set", "arm", "Desired Finger Position 1", "0.01",
                                  "Desired Finger Position 2", "0.03", expect=2).stderr
        self.assertTrue(error)
        self.assertEqual(self.daemon.json("parts")["parts"][0]["lease_owner"], "")

    def test_param_set(self):
        for parameter in self.daemon.json("params", "arm")["parameters"]:
            if parameter["read_only"]:
                continue
            value = parameter["value"]
            text = str(value).lower() if isinstance(value, bool) else str(value)
            self.daemon.visum("param-set", "arm", parameter["name"], text)
            self.assertEqual(self.daemon.json("parts")["parts"][0]["lease_owner"], "")
            break
        else:
            self.fail("the arm has no parameter that can be set")
        self.daemon.visum("param-set", "arm", "nonsense", "1", expect=2)

    def test_pause_step_and_resume(self):
        self.daemon.visum("pause")
        before = self.daemon.json("status")
        self.assertTrue(before["paused"])
        self.assertEqual(self.daemon.json("step", "25")["tick"], before["tick"] + 25)
        done = self.daemon.visum("set", "arm", "Maximum Speed 2", "0.5")
        self.assertIn("takes effect with the next tick", done.stderr)
        self.assertEqual(self.daemon.json("status")["tick"], before["tick"] + 25)
        self.daemon.visum("resume")
        self.assertFalse(self.daemon.json("status")["paused"])

    def test_speedup(self):
        self.daemon.visum("speedup", "10")
        self.assertEqual(self.daemon.json("status")["speed"], 10)
        self.daemon.visum("speedup", "20")

    def test_snapshot_restore_and_reset_begin_new_eras(self):
        era = self.daemon.json("status")["era"]
        number = self.daemon.visum("snapshot").stdout.strip()
        self.daemon.visum("restore", number)
        self.assertEqual(self.daemon.json("status")["era"], era + 1)
        self.daemon.visum("reset")
        self.assertEqual(self.daemon.json("status")["era"], era + 2)
        self.assertEqual(self.daemon.visum("restore", "999999", expect=2).stdout, "")

    def test_push(self):
        self.daemon.visum("push", "box", "0", "0", "-5", "--for", "0.01")
        self.daemon.visum("push", "bux", "0", "0", "5", expect=2)

    def test_faults_are_listed_put_in_and_ended(self):
        kinds = {kind["name"] for kind in self.daemon.json("faults", "arm")["kinds"]}
        self.assertIn("encoder_stuck", kinds)
        self.assertNotIn("sensor_off", kinds)  # an arm is no sensor
        self.daemon.visum("fault", "arm", "torque_lost", "joint=3", "share=0.5")
        self.assertEqual(self.active_faults(1), [{"part": "arm", "kind": "torque_lost",
                                                  "numbers": {"joint": 3, "share": 0.5}, "until_tick": 0}])
        self.assertIn("acts on arm: torque_lost joint=3 share=0.5\n", self.daemon.visum("faults").stdout)
        self.daemon.visum("fault", "arm", "torque_lost", "joint=3", "--clear")
        self.assertEqual(self.active_faults(0), [])

    def active_faults(self, count):
        """Once there are so many: they come and go at a tick."""
        for _ in range(100):
            active = self.daemon.json("faults", "arm")["active"]
            if len(active) == count:
                return active
        return active

    def test_faults_that_mean_nothing_are_refused_with_the_reason(self):
        for words, reason in ((("encoder_stuck",), "needs the number 'joint'"), (("encoder_stuck", "joint"), "must be NAME=NUMBER"),
                              (("encoder_stuck", "joint=12"), "there is no drive 12"), (("bus_lost",), "on no field bus"),
                              (("stuck",), "there is no fault 'stuck'"), ((), "no KIND given"),
                              (("supply_dip", "volts=3", "--clear"), "takes only the number joint"),
                              (("--clear", "--for", "1"), "--for excludes --clear")):
            self.assertIn(reason, self.daemon.visum("fault", "arm", *words, expect=2).stderr, words)

    def test_watch_prints_a_line_per_sample_and_ends_by_count(self):
        lines = self.daemon.visum("watch", "arm", "Actual Angle 1", "--every", "10", "--count", "3").stdout.splitlines()
        self.assertEqual(len(lines), 3)
        for line in lines:
            self.assertRegex(line, r"^\d+\.\d{3} s  Actual Angle 1=\S+ rad$")
        samples = [json.loads(line) for line in
                   self.daemon.visum("watch", "arm", "Part State", "--count", "2", "--json").stdout.splitlines()]
        self.assertEqual([list(sample["ports"]) for sample in samples], [["Part State"]] * 2)

    def test_watch_ends_by_interrupt(self):
        process = subprocess.Popen([BIN / "visum", "watch", "arm", "--connect", self.daemon.connect],
                                   stdout=subprocess.PIPE, text=True)
        self.assertTrue(process.stdout.readline())
        process.send_signal(signal.SIGINT)
        process.stdout.read()
        process.stdout.close()
        self.assertEqual(process.wait(timeout=DEADLINE_S), 130)

    def watch_on_a_terminal(self, *words, size=(0, 0)):
        main, terminal = pty.openpty()
        termios.tcsetwinsize(terminal, size)
        env = {**os.environ, "TERM": "xterm", "NO_COLOR": "1"}
        with subprocess.Popen([BIN / "visum", "watch", "arm", *words, "--count", "2", "--connect", self.daemon.connect],
                              stdout=terminal, env=env) as process:
            self.assertEqual(process.wait(timeout=DEADLINE_S), 0)
        os.close(terminal)
        shown = b""
        try:
            while chunk := os.read(main, 4096):
                shown += chunk
        except OSError:
            pass  # the other end is closed: all is read
        os.close(main)
        return shown.decode()

    def test_watch_draws_a_table_on_a_terminal_and_gives_the_cursor_back(self):
        text = self.watch_on_a_terminal("Actual Angle")
        self.assertIn("VIRTUAL  arm at ", text)
        self.assertTrue(text.startswith("\033[?25l") and text.endswith("\033[?25h"))
        self.assertIn("\033[8A", text, "the second table is drawn over the first")
        self.assertNotIn("\033[1m", text, "NO_COLOR")

    def test_watch_cuts_the_table_to_the_terminals_rows(self):
        ports = len(self.daemon.visum("describe", "arm", "--names").stdout.splitlines())
        text = self.watch_on_a_terminal(size=(24, 80))
        self.assertEqual(text.count("\n"), 2 * 23, "a row is the cursor's")
        self.assertIn("\033[23A", text)
        self.assertEqual(text.count(f"... {1 + ports - 22} more lines"), 2)
        self.assertNotIn("more lines", self.watch_on_a_terminal(size=(ports + 2, 80)))


class Refusals(unittest.TestCase):
    def test_a_lease_in_the_way_is_1_and_names_its_owner(self):
        with Daemon("--clock", "realtime", "--speedup", "20") as daemon:
            holder = subprocess.Popen([BIN / "visum-pick-and-place", "--connect", daemon.connect, "--urdf", URDF], stdout=subprocess.PIPE,
                                      stderr=subprocess.DEVNULL)
            holder.stdout.readline()
            error = daemon.visum("set", "arm", "Desired Angle 1", "0", expect=1).stderr
            self.assertIn("visum-pick-and-place", error)
            holder.kill()
            holder.stdout.close()
            holder.wait(timeout=DEADLINE_S)

    def test_speedup_needs_realtime(self):
        with Daemon("--clock", "lockstep") as daemon:
            self.assertIn("realtime", daemon.visum("speedup", "2", expect=1).stderr)

    def test_tokens(self):
        with tempfile.NamedTemporaryFile("w", suffix=".tokens") as tokens:
            tokens.write("observer 0123456789abcdef\nadmin fedcba9876543210\n")
            tokens.flush()
            with Daemon("--clock", "lockstep", "--token-file", tokens.name) as daemon:
                daemon.visum("parts", expect=1)
                daemon.visum("parts", "--token-file", tokens.name)
                daemon.visum("pause", "--token-file", tokens.name)


class Files(unittest.TestCase):
    """A command that fails leaves the files that were there."""

    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        self.file = self.folder / "run.mcap"

    def record(self, *options):
        return subprocess.run([BIN / "visumd", ARM, "--record", self.file, *options], capture_output=True, text=True, timeout=DEADLINE_S)

    def test_a_recording_that_is_being_written_is_nobody_elses(self):
        with Daemon("--record", self.file, "--clock", "free", "--run"):
            second = self.record("--port", "0", "--http", "off")
            self.assertEqual(second.returncode, 2, second.stderr)
            self.assertIn("another program is writing it", second.stderr)
        self.assertTrue(json.loads(visum("replay", self.file, "--json").stdout)["equal"])

    def test_a_daemon_without_a_port_empties_no_file(self):
        self.file.write_text("mine")
        with Daemon() as daemon:
            second = self.record("--port", str(daemon.ready["port"]), "--http", "off")
        self.assertEqual(second.returncode, 2, second.stderr)
        self.assertEqual(self.file.read_text(), "mine")

    def test_a_report_that_cannot_be_written_is_1(self):
        for option in ("--junit", "--result"):
            done = visum("run", SOURCE / "models/scenarios/two_link_wave.yaml", "--recordings", "off", option, "/dev/full", expect=1)
            self.assertEqual(done.stderr, "visum: cannot write /dev/full: No space left on device\n")
        done = visum("run", SOURCE / "models/scenarios/two_link_wave.yaml", "--junit", "/nowhere/report.xml", expect=2)
        self.assertEqual(done.stderr, "visum: cannot write /nowhere/report.xml: No such file or directory\n")

    def test_a_verb_of_the_server_whose_output_cannot_be_written_is_1(self):
        visum("run", SOURCE / "models/scenarios/two_link_wave.yaml", "--record", self.file)
        x3d = self.folder / "cart.x3d"
        for words in (["check", ARM], ["check", ARM, "--json"], ["check", "--help"], ["replay", self.file], ["replay", self.file, "--json"],
                      ["export", self.file], ["convert", SOURCE / "models/scenes/cart.yaml", x3d], ["mirror", "--help"]):
            with open("/dev/full", "w") as full:
                done = subprocess.run([BIN / "visum", *words], stdout=full, stderr=subprocess.PIPE, text=True, timeout=DEADLINE_S)
            self.assertNotIn(done.returncode, (0, 5), words)
            self.assertRegex(done.stderr, "standard output: cannot be written(: No space left on device)?\n$", words)

    def test_a_server_whose_ready_line_cannot_be_written_does_not_start(self):
        with open("/dev/full", "w") as full:
            done = subprocess.run([BIN / "visumd", ARM, "--json", "--port", "0", "--http", "off"], stdout=full, stderr=subprocess.PIPE,
                                  text=True, timeout=DEADLINE_S)
        self.assertEqual(done.returncode, 2)
        self.assertIn("standard output: cannot be written", done.stderr)

    def test_an_export_takes_the_place_of_a_file_once_it_is_whole(self):
        visum("run", SOURCE / "models/scenarios/two_link_wave.yaml", "--record", self.file)
        size = self.file.stat().st_size
        table = self.folder / "run.csv"
        table.write_text("mine")
        for words, code in ((("nowhere.mcap",), 3), ((self.file, "--ports", "nobody/Nothing"), 2)):
            visum("export", *words, "-o", table, expect=code)
            self.assertEqual(table.read_text(), "mine")
        self.assertIn("is the recording itself", visum("export", self.file, "-o", self.folder / "." / "run.mcap", expect=2).stderr)
        self.assertEqual(self.file.stat().st_size, size)
        visum("export", self.file, "-o", table)
        self.assertTrue(table.read_text().startswith("tick,era,time_s"))
        self.assertEqual(sorted(file.name for file in self.folder.iterdir()), ["run.csv", "run.mcap"])
        self.assertTrue(visum("export", self.file, "-o", "/dev/stdout").stdout == table.read_text(), "a pipe is no plain file")


class Completion(unittest.TestCase):
    def complete(self, connect, *words):
        """The words that bash offers for the last one."""
        script = visum("completion", "bash").stdout + f"""
COMP_WORDS=({' '.join(words)}); COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1)); _visum; printf '%s\\n' "${{COMPREPLY[@]}}"
"""
        env = {**os.environ, "PATH": f"{BIN}:{os.environ['PATH']}", "VISUM_CONNECT": connect}
        done = subprocess.run(["bash", "--norc", "-eu", "-c", script], capture_output=True, text=True, env=env,
                              timeout=DEADLINE_S, check=True)
        return done.stdout.splitlines()

    def test_bash_completes_verbs_options_parts_and_ports(self):
        with Daemon("--clock", "lockstep") as daemon:
            self.assertEqual(self.complete(daemon.connect, "visum", "desc"), ["describe"])
            self.assertEqual(self.complete(daemon.connect, "visum", "run", "--ju"), ["--junit"])
            self.assertEqual(self.complete(daemon.connect, "visum", "get", "a"), ["arm"])
            self.assertEqual(self.complete(daemon.connect, "visum", "get", "arm", r"Actual\\\ Angle\\\ 7"),
                             [r"Actual\ Angle\ 7"])
            self.assertEqual(self.complete(daemon.connect, "visum", "get", "arm", r"\"Part\ St"), ["Part State"])
            self.assertEqual(self.complete(daemon.connect, "visum", "completion", "z"), ["zsh"])

    def test_scripts_are_well_formed(self):
        for shell, check in (("bash", ["bash", "-n"]), ("zsh", ["zsh", "-n"]), ("fish", ["fish", "-n"])):
            script = visum("completion", shell).stdout
            self.assertIn("visum", script)
            try:
                subprocess.run([*check], input=script, text=True, check=True, timeout=DEADLINE_S)
            except FileNotFoundError:
                self.assertNotEqual(shell, "bash", "bash is always there")


if __name__ == "__main__":
    unittest.main()
