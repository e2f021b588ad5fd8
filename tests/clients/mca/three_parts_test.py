"""The paper's figure 6: hardware, motion and task in three processes, with the real programs over TCP."""
import contextlib
import json
import pathlib
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from programs import ARM, BIN, DEADLINE_S, Daemon, visum  # noqa: E402
sys.path.insert(0, str(BIN.parent / "python"))
import visum as library  # noqa: E402


class Part:
    """One part of the controller for the length of a `with`."""

    def __init__(self, kind, *options):
        self.command = [BIN / f"visum-mca-{kind}", *map(str, options)]

    def __enter__(self):
        self.process = subprocess.Popen(self.command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        return self

    def wait(self):
        """Waits for its end. Returns the exit code; `said` is then what it wrote."""
        out, self.said = self.process.communicate(timeout=DEADLINE_S)
        return self.process.returncode

    def __exit__(self, *_):
        if self.process.poll() is None:
            self.process.kill()
            self.process.communicate()
        self.process.stdout.close()
        self.process.stderr.close()


class RealArm:
    """An arm behind visum-hwpart for the length of a `with`: the program for real modules, and modules on a bus, which
    another world plays."""

    def __enter__(self):
        with contextlib.ExitStack() as stack:
            self.world = stack.enter_context(Daemon("-r", "--bus", "arm=tcp:0"))
            bus = self.world.ready["buses"]["arm"][0]
            self.process = subprocess.Popen(
                [BIN / "visum-hwpart", ARM, "--bus", bus.replace("tcp:", "tcp:127.0.0.1:"), "--port", "0", "--json", "-v", "0",
                 "--execution-enable", "--answer-ms", "2000", "--session-silence-ms", "0", "--command-age-ms", "0"],
                stdout=subprocess.PIPE, text=True)
            stack.callback(self.process.stdout.close)
            stack.callback(self.process.wait, DEADLINE_S)
            stack.callback(self.process.terminate)
            self.connect = f"127.0.0.1:{json.loads(self.process.stdout.readline())['port']}"
            self.stack = stack.pop_all()
        return self

    def visum(self, verb, *words):
        return visum(verb, *words, "--connect", self.connect)

    def __exit__(self, *_):
        self.stack.close()


def eventually(look, holds):
    """Looks until it holds, and returns what was seen."""
    deadline = time.monotonic() + 60
    while True:
        seen = look()
        if holds(seen):
            return seen
        if time.monotonic() > deadline:
            raise AssertionError(f"it never held; last seen: {seen}")


def hardware(daemon, *options):
    return Part("hardware", "--lower", f"arm@{daemon.connect}", "--port", 0, *options)


def motion(daemon, *options):
    return Part("motion", "--lower", f"hardware@{daemon.connect}", "--port", 0, *options)


def task(daemon, *options):
    return Part("task", "--lower", f"motion@{daemon.connect}", *options)


def port(daemon, name):
    return float(daemon.visum("get", "arm", name).stdout)


class Watch:
    """Every sample of a port for the length of a `with`, however busy the machine is."""

    def __init__(self, daemon, name):
        self.name = name
        self.command = [BIN / "visum", "watch", "arm", name, "--every", "10", "--json", "--connect", daemon.connect]

    def __enter__(self):
        self.file = tempfile.TemporaryFile("w+")
        self.process = subprocess.Popen(self.command, stdout=self.file)
        return self

    def samples(self):
        """Ends it."""
        self.process.send_signal(signal.SIGINT)
        self.process.wait(timeout=DEADLINE_S)
        self.file.seek(0)
        return [json.loads(line)["ports"][self.name] for line in self.file]

    def __exit__(self, *_):
        if self.process.poll() is None:
            self.process.kill()
            self.process.wait()
        self.file.close()


class Lockstep(unittest.TestCase):
    def run_once(self):
        with Daemon("--clock", "lockstep") as daemon, hardware(daemon) as one, motion(daemon) as two, \
                task(daemon) as three:
            codes = [part.wait() for part in (three, two, one)]
            self.assertEqual(codes, [0, 0, 0], [part.said for part in (one, two, three)])
            status = daemon.json("status")
            return status["tick"], status["state_hash"]

    def test_three_processes_have_the_same_bits_in_each_run(self):
        runs = {self.run_once() for _ in range(3)}
        self.assertEqual(len(runs), 1, runs)
        self.assertGreater(runs.pop()[0], 4000)

    def test_a_part_that_stays_away_ends_the_others_and_is_named(self):
        with Daemon("--clock", "lockstep") as daemon, hardware(daemon) as one, \
                motion(daemon, "--upper-timeout", 3) as two, task(daemon) as three:
            eventually(lambda: daemon.json("modules")["modules"], lambda modules: len(modules) >= 5)
            three.process.send_signal(signal.SIGSTOP)
            self.assertEqual(two.wait(), 4)
            self.assertIn("'task' has not come to cycle", two.said)
            self.assertEqual(one.wait(), 4)
            self.assertIn("'motion' is gone without a release", one.said)
            three.process.send_signal(signal.SIGCONT)


    def test_parts_that_never_join_are_named(self):
        with Daemon("--clock", "lockstep") as daemon:
            with hardware(daemon, "--join-timeout", 0.5) as part:
                self.assertEqual(part.wait(), 4)
                self.assertIn("these parts above have not joined within 0.5 s (--join-timeout): 1 of 1", part.said)
            with hardware(daemon, "--uppers", "2", "--join-timeout", 8) as part, motion(daemon):
                self.assertEqual(part.wait(), 4)
                self.assertIn("1 of 2; there is 'motion'", part.said)
            with hardware(daemon, "--uppers", "motion,monitor", "--join-timeout", 8) as part, motion(daemon):
                self.assertEqual(part.wait(), 4)
                self.assertIn("(--join-timeout): 'monitor'", part.said)

    def test_a_part_that_waits_for_nobody_goes_on_alone(self):
        with Daemon("--clock", "lockstep") as daemon, hardware(daemon, "--uppers", 0):
            eventually(lambda: daemon.json("status")["tick"], lambda tick: tick > 100)


class RealTime(unittest.TestCase):
    def setUp(self):
        self.daemon = self.enterContext(Daemon("-r"))

    def modules(self):
        return self.daemon.json("modules")

    def test_modules_groups_and_edges_are_seen(self):
        with hardware(self.daemon), motion(self.daemon), task(self.daemon):
            seen = eventually(self.modules, lambda list: len(list["modules"]) == 5 and
                              all(one["sense_us"] > 0 for one in list["modules"]))
        by_name = {one["name"]: one for one in seen["modules"]}
        self.assertEqual(set(by_name), {"Guard", "Arm", "Trajectory", "Supervisor", "Sequence"})
        self.assertEqual((by_name["Trajectory"]["part"], by_name["Trajectory"]["group"]), ("motion", "Arm"))
        self.assertEqual((by_name["Sequence"]["period_ms"], by_name["Trajectory"]["period_ms"]), (10, 5))
        edges = {(edge["from"], edge["to"]): edge["count"] for edge in seen["edges"]}
        self.assertEqual(edges["motion/Controller Output/Desired Angle 1", "hardware/Controller Input/Desired Angle 1"], 14)
        self.assertEqual(edges["motion/Arm/Trajectory/Controller Output/Desired Angle 1",
                               "motion/Arm/Controller Output/Desired Angle 1"], 14)
        self.assertIn(("hardware/Controller Output/Desired Angle 1", "arm/Controller Input/0"), edges)
        eventually(self.modules, lambda list: list["modules"] == [])  # they go with their programs

    def test_a_sensor_input_holds_a_value_for_a_test(self):
        with hardware(self.daemon), motion(self.daemon) as part:
            eventually(self.modules, lambda list: len(list["modules"]) == 4)
            self.daemon.visum("modules", "motion", "--hold", "Arm/Supervisor/Part State=3")
            supervisor = eventually(lambda: next(one for one in self.daemon.json("modules", "motion", "--values")["modules"]
                                                 if one["name"] == "Supervisor"),
                                    lambda module: module["Sensor Output"]["Fault"] == 1)
            self.assertEqual(supervisor["held"], ["Part State"])
            self.assertIn("holds Part State", self.daemon.visum("modules").stdout)
            self.daemon.visum("modules", "motion", "--release", "Arm/Supervisor/Part State")
            eventually(self.modules, lambda list: not any(one["held"] for one in list["modules"]))
            refused = self.daemon.visum("modules", "motion", "--hold", "Arm/Supervisor/Part Stat=3", expect=2)
            self.assertIn("did you mean 'Part State'", refused.stderr)
            self.assertIn("is no MODULE/PORT=VALUE", self.daemon.visum("modules", "motion", "--hold", "x", expect=2).stderr)
            part.process.send_signal(signal.SIGINT)
            self.assertEqual(part.wait(), 130)
            self.assertIn("'Arm/Supervisor' Sensor Input 'Part State' holds 3 for a test", part.said)

    def module(self, part, name):
        return next(one for one in self.daemon.json("modules", part)["modules"] if one["name"] == name)

    def speed(self):
        return next(one["value"] for one in self.module("motion", "Trajectory")["parameters"] if one["name"] == "Speed")

    def test_parameters_are_changed_in_the_module_or_refused(self):
        with hardware(self.daemon), motion(self.daemon) as part, task(self.daemon, "--name", "boss"):
            eventually(self.modules, lambda list: len(list["modules"]) == 5)
            # A part that is two connections away from the server hears of it, too, and takes longer now.
            self.assertTrue(self.daemon.json("modules", "boss", "--set", "Sequence/Pause=3")["in_force"])
            speed = self.module("motion", "Trajectory")["parameters"][0]
            self.assertEqual({key: speed[key] for key in ("name", "type", "value", "unit", "minimum", "maximum")},
                             {"name": "Speed", "type": "number", "value": 0.8, "unit": "rad/s", "minimum": 0.05, "maximum": 2})
            set_speed = ("modules", "motion", "--set")
            self.assertEqual(self.daemon.json(*set_speed, "Arm/Trajectory/Speed=0.5"), {"sent": True, "in_force": True})
            self.assertEqual(self.speed(), 0.5)
            self.assertIn("motion/Arm/Trajectory/Parameters/Speed 0.5 rad/s", self.daemon.visum("modules", "--values").stdout)
            for words, said in (("Arm/Trajectory/Speed=3", "'Speed' must be within 0.05 and 2"),
                                ("Arm/Trajectory/Sped=1", "did you mean 'Speed'"),
                                ("Arm/Trajector/Speed=1", "did you mean 'Arm/Trajectory'"),
                                ("Arm/Trajectory/Speed", "is no MODULE/PARAMETER=VALUE"),
                                ("Arm/Trajectory/Speed=fast", "parameter 'Speed' takes 0.05 .. 2, not 'fast'")):
                self.assertIn(said, self.daemon.visum(*set_speed, words, expect=2).stderr)
            self.assertEqual(self.speed(), 0.5)
            part.process.send_signal(signal.SIGINT)
            self.assertEqual(part.wait(), 130)
            self.assertIn("'Arm/Trajectory' Speed is 0.5 now", part.said)

    def test_a_blackboard_of_a_part_is_seen_and_read(self):
        def way():
            return self.daemon.json("modules", "motion")["parts"][0]["blackboards"][0]
        with hardware(self.daemon), motion(self.daemon) as part, task(self.daemon):
            address = part.process.stdout.readline().split()[-1]  # "motion serves its ports at ..."
            eventually(self.modules, lambda list: len(list["modules"]) == 5)
            board = eventually(way, lambda board: board["elements"] == 11)
            self.assertEqual((board["name"], board["content_type"], board["element_size"], board["capacity"]),
                             ("Way", "application/x-float64", 64, 704))
            with library.Client(address, role="observer") as client:
                content = client.part("motion").read_blackboard("Way")
            times = [row[0] for row in struct.iter_unpack("<8d", content)]
            self.assertEqual((len(times), times[0]), (11, 0))
            self.assertEqual(times, sorted(times))

    def test_the_python_library_changes_a_parameter(self):
        with hardware(self.daemon), motion(self.daemon), library.Client(self.daemon.connect, name="tester") as client:
            eventually(self.modules, lambda list: len(list["modules"]) == 4)
            client.set_module_parameter("motion", "Arm/Trajectory", "Speed", 0.5)
            eventually(self.speed, lambda speed: speed == 0.5)
            with self.assertRaisesRegex(library.Error, "must be within 0.05 and 2"):
                client.set_module_parameter("motion", "Arm/Trajectory", "Speed", 5.0)

    def test_a_killed_task_stops_the_arm(self):
        with hardware(self.daemon) as one, motion(self.daemon) as two, task(self.daemon) as three:
            eventually(lambda: port(self.daemon, "Actual Angle 1"), lambda angle: angle > 0.05)
            three.process.kill()
            self.assertEqual((two.wait(), one.wait()), (4, 4))
            self.assertIn("'task' is gone without a release", two.said)
        self.assertIn("controller lost", self.daemon.visum("parts").stdout)

    def drive(self, *arms):
        """Runs the whole controller with these arms below it. Returns the largest first angle of each arm."""
        lower = [word for arm in arms for word in ("--lower", f"arm@{arm.connect}")]
        with contextlib.ExitStack() as stack:
            watches = [stack.enter_context(Watch(arm, "Actual Angle 1")) for arm in arms]
            one = stack.enter_context(Part("hardware", *lower, "--port", 0))
            two, top = stack.enter_context(motion(arms[0])), stack.enter_context(task(arms[0]))
            self.assertEqual(top.wait(), 0, top.__dict__.get("said"))
            seen = [max(watch.samples()) for watch in watches]
            for part in (two, one):
                part.process.send_signal(signal.SIGINT)
                self.assertEqual(part.wait(), 130, part.said)
        for arm in arms:
            self.assertEqual(port(arm, "Maximum Speed 1"), 0.8)
            self.assertEqual(port(arm, "Part State"), 0)
        return seen

    def test_two_arms_are_driven_by_two_edges_from_one_output(self):
        with Daemon("-r") as other:
            for angle in self.drive(self.daemon, other):
                self.assertAlmostEqual(angle, 0.6, delta=0.05)
            self.assertAlmostEqual(port(other, "Desired Angle 1"), 0, delta=0.01)
            self.assertEqual(port(self.daemon, "Desired Angle 1"), port(other, "Desired Angle 1"))

    def test_the_real_arm_takes_the_place_of_the_virtual_one_or_moves_beside_it(self):
        with RealArm() as real:
            for arms in ((real,), (self.daemon, real)):
                for angle in self.drive(*arms):
                    self.assertAlmostEqual(angle, 0.6, delta=0.05)


class CommandLine(unittest.TestCase):
    def test_what_is_wrong_is_said(self):
        with Daemon("-r") as daemon, Part("motion", "--lower", f"amr@{daemon.connect}", "--connect-timeout", 0) as part:
            self.assertEqual(part.wait(), 1)
            self.assertIn("has no part 'amr'", part.said)
        for words, code, text in ((["--lower", "arm"], 2, "is no PART@HOST:PORT"),
                                  (["--period", "10"], 2, "is no period"),
                                  (["--timescale", "0"], 2, "--timescale"),
                                  (["--uppers", "33"], 2, "--uppers: 33 is not in 0 .. 32"),
                                  (["--uppers", "-1"], 2, "--uppers: -1 is not in 0 .. 32"),
                                  (["--configfile", "/nowhere.yaml"], 3, "/nowhere.yaml")):
            with Part("task", *words) as part:
                self.assertEqual(part.wait(), code, part.said)
                self.assertIn(text, part.said)

    def test_another_version_is_refused(self):
        with Daemon("-r") as daemon, Part("hardware", "--versioncheck", daemon.connect,
                                          "--lower", f"arm@{daemon.connect}"):
            eventually(lambda: daemon.json("modules")["modules"], lambda modules: modules != [])
        with socket.create_server(("127.0.0.1", 0)) as door:
            part = self.enterContext(Part("hardware", "--versioncheck", f"127.0.0.1:{door.getsockname()[1]}"))
            peer = door.accept()[0]
            peer.recv(1000)  # its hello, which has the number 1
            server = b"other 9.9.9"
            welcome = b"\x08\x01\x12" + bytes([len(server)]) + server + b"\x18\x01\x20\x01\x28\x01"
            message = b"\x08\x01\x22" + bytes([len(welcome)]) + welcome
            peer.sendall(struct.pack("<I", len(message)) + message)
            self.assertEqual(part.wait(), 1)
            self.assertIn("there is 'other 9.9.9'", part.said)
            peer.close()


if __name__ == "__main__":
    unittest.main()
