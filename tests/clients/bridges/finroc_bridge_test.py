"""The real visumd, the real `visum bridge finroc`, and a Finroc peer of our own."""
import json
import os
import pathlib
import socket
import struct
import subprocess
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from programs import BIN, DEADLINE_S, Daemon, visum  # noqa: E402
import finroc_peer as finroc  # noqa: E402


class Bridge:
    """A `visum bridge finroc` for the length of a `with`."""

    def __init__(self, daemon, *options):
        self.command = [BIN / "visum", "bridge", "finroc", "--connect", daemon.connect, "--json", *map(str, options)]

    def __enter__(self):
        self.process = subprocess.Popen(self.command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.ready = json.loads(self.process.stdout.readline())
        self.port = self.ready["port"]
        return self

    def end(self):
        self.process.terminate()
        return self.process.wait(timeout=DEADLINE_S)

    def __exit__(self, *_):
        self.end()
        self.process.stdout.close()
        self.process.stderr.close()


class Structure(unittest.TestCase):
    def test_ready_line_and_tree(self):
        with Daemon() as daemon, Bridge(daemon, "--port", 0) as bridge, finroc.Peer(bridge.port) as peer:
            self.assertEqual(bridge.ready, {"ready": True, "bridge": "finroc", "port": bridge.port,
                                            "connect": daemon.connect, "parts": ["arm"]})
            self.assertEqual(peer.structure.flags, 5)
            self.assertEqual(peer.values.flags, 2)
            self.assertEqual(peer.by_path["/amtec_arm"].tags, ["group"])
            self.assertEqual(peer.by_path["/amtec_arm/arm"].tags, ["module"])
            described = daemon.json("describe", "arm")
            for vector, interface in (("controller_inputs", "Controller Input"), ("sensor_outputs", "Sensor Output"),
                                      ("parameters", "Parameters")):
                above = peer.by_path[f"/amtec_arm/arm/{interface}"]
                self.assertTrue(above.flags & finroc.INTERFACE)
                names = [e.name for e in peer.structure.elements if e.parent == above.handle]
                self.assertEqual(names, [port["name"] for port in described[vector]])  # in this order
            self.assertTrue(peer.find("Input/Desired Angle 1").flags & finroc.ACCEPTS)
            self.assertTrue(peer.find("Output/Actual Angle 1").flags & finroc.READ_ONLY)
            handles = [element.handle for element in peer.structure.elements]
            self.assertEqual(len({handle >> 12 for handle in handles}), len(handles))

    def test_usual_port_or_the_next_free_one(self):
        with Daemon() as daemon, Bridge(daemon) as first, Bridge(daemon) as second:
            self.assertGreaterEqual(first.port, 4444)
            self.assertGreater(second.port, first.port)
            taken = visum("bridge", "finroc", "--connect", daemon.connect, "--port", first.port, expect=2)
            self.assertIn(str(first.port), taken.stderr)

    def test_beyond_loopback_only_if_the_user_says_so(self):
        with Daemon() as daemon:
            refused = visum("bridge", "finroc", "--connect", daemon.connect, "--listen", "0.0.0.0", expect=2)
            self.assertIn("--no-authentication", refused.stderr)
            with Bridge(daemon, "--port", 0, "--listen", "0.0.0.0", "--no-authentication") as bridge:
                finroc.Peer(bridge.port).__exit__()

    def test_list_of_bridges(self):
        self.assertEqual(json.loads(visum("bridge", "--list", "--json").stdout),
                         {"bridges": [{"name": "finroc", "built": True, "reason": ""}]})
        self.assertIn("did you mean 'finroc'", visum("bridge", "finrok", expect=2).stderr)
        self.assertIn("--no-authentication", visum("bridge", "finroc", "--help").stdout)


class Values(unittest.TestCase):
    def test_a_write_moves_the_arm(self):
        with Daemon() as daemon, Bridge(daemon, "--port", 0) as bridge, finroc.Peer(bridge.port) as peer:
            desired, actual = peer.find("Input/Desired Angle 1"), peer.find("Output/Actual Angle 1")
            peer.subscribe(desired, actual)
            start = peer.wait_for(actual, lambda _: True)
            peer.write(desired, finroc.number(start + 0.05))
            peer.wait_for(actual, lambda angle: abs(angle - start - 0.05) < 1e-3)
            self.assertAlmostEqual(peer.seen[desired.handle], start + 0.05)
            # The lease is free again: a controller may come.
            self.assertEqual(daemon.json("parts")["parts"][0]["lease_owner"] or "", "")

    def test_an_initial_value_moves_nothing(self):
        with Daemon() as daemon, Bridge(daemon, "--port", 0) as bridge, finroc.Peer(bridge.port) as peer:
            desired = peer.find("Input/Desired Angle 1")
            peer.write(desired, finroc.number(1.0), change=finroc.INITIAL)
            self.assertEqual(peer.apply(peer.find("Input/Maximum Speed 1"), finroc.number(0.25)), "")
            peer.subscribe(desired, peer.find("Input/Maximum Speed 1"))
            peer.wait_for(peer.find("Input/Maximum Speed 1"), lambda speed: speed == 0.25)
            self.assertNotEqual(peer.wait_for(desired, lambda _: True), 1.0)

    def test_refusals_reach_the_user(self):
        with Daemon() as daemon, Bridge(daemon, "--port", 0) as bridge, finroc.Peer(bridge.port) as peer:
            desired, last = peer.find("Input/Desired Angle 1"), peer.find("Bridge/Sensor Output/Last Refusal")
            self.assertRegex(peer.apply(desired, finroc.number(1e6)), "Desired Angle 1: 1e.06 is not in .* rad")
            self.assertRegex(peer.apply(desired, finroc.number(float("nan"))), "nan is not in")
            self.assertIn("output", peer.apply(peer.find("Output/Actual Angle 1"), finroc.number(0)))
            self.assertIn("no Number", peer.apply(desired, b""))
            peer.subscribe(last, desired)
            peer.write(desired, finroc.number(1e6))  # as fingui writes: nobody answers
            peer.wait_for(last, lambda text: "1e+06 is not in" in text)
            self.assertLess(peer.wait_for(desired, lambda _: True), 10)
            bridge.end()
            self.assertEqual(bridge.process.stdout.read(), "")  # it holds the ready line alone
            self.assertIn("1e+06 is not in", bridge.process.stderr.read())

    def test_another_client_holds_the_lease(self):
        with Daemon() as daemon, Bridge(daemon, "--port", 0) as bridge, finroc.Peer(bridge.port) as peer:
            held = subprocess.Popen([sys.executable, "-c", """
import sys; sys.path.insert(0, sys.argv[2])
import visum
with visum.Client(sys.argv[1], name="the controller") as client:
    with client.part("arm").lease():
        print("held", flush=True); sys.stdin.readline()
""", daemon.connect, str(BIN.parent / "python")],
                                    stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
            self.assertEqual(held.stdout.readline().strip(), "held")
            desired = peer.find("Input/Desired Angle 1")
            self.assertIn("the controller", peer.apply(desired, finroc.number(0.1)))
            stop = peer.find("Parameters/Emergency Stop")
            self.assertEqual(peer.apply(stop, b"\1"), "")  # which anybody may pull
            held.communicate("\n", timeout=DEADLINE_S)

    def test_parameters_are_typed(self):
        with Daemon() as daemon, Bridge(daemon, "--port", 0) as bridge, finroc.Peer(bridge.port) as peer:
            stop = peer.find("Parameters/Emergency Stop")
            self.assertEqual(stop.type, "bool")
            peer.subscribe(stop)
            peer.wait_for(stop, lambda value: value is False)
            self.assertEqual(peer.apply(stop, b"\1"), "")
            peer.wait_for(stop, lambda value: value is True)
            self.assertIn("true", daemon.visum("params", "arm").stdout)


class Lockstep(unittest.TestCase):
    """The world waits for the peers' messages (grade L1)."""

    def run_once(self, swap):
        """Two peers write the same port in 20 cycles, in this or the other order. Returns the state's hash."""
        gates = ("--gate", "arm/Desired Angle 1", "--gate", "arm/Desired Angle 2")
        with Daemon("--clock", "lockstep") as daemon, Bridge(daemon, "--port", 0, "--lockstep", *gates) as bridge:
            with finroc.Peer(bridge.port, name="anna") as anna, finroc.Peer(bridge.port, name="bert") as bert:
                time, first = anna.find("Sensor Output/Simulated Time"), "Input/Desired Angle 1"
                anna.subscribe(time)
                anna.wait_for(time, lambda now: now == 0)
                for cycle in range(1, 21):
                    writes = [(anna, first, 0.01 * cycle), (bert, first, 0.02 * cycle)]
                    for peer, port, angle in reversed(writes) if swap else writes:
                        peer.write(peer.find(port), finroc.number(angle))
                        peer.settle()
                    self.assertLess(anna.seen[time.handle], 0.01 * cycle - 0.005)  # a gate is missing
                    bert.write(bert.find("Input/Desired Angle 2"), finroc.number(-0.4 + 0.001 * cycle))
                    anna.wait_for(time, lambda now: now > 0.01 * cycle - 0.005)
                self.assertAlmostEqual(anna.seen[time.handle], 0.2)  # 20 periods of 10 ms
                return daemon.json("status")["state_hash"]

    def test_one_hash_in_ten_runs(self):
        self.assertEqual(len({self.run_once(swap=run % 2 == 1) for run in range(10)}), 1)

    def test_steps_are_asked_for_by_a_counter(self):
        with Daemon("--clock", "lockstep") as daemon:
            with Bridge(daemon, "--port", 0, "--lockstep", "--period", 5) as bridge, finroc.Peer(bridge.port) as peer:
                step, time = peer.find("Bridge/Controller Input/Step"), peer.find("Sensor Output/Simulated Time")
                peer.subscribe(time)
                peer.write(peer.find("Input/Desired Angle 1"), finroc.number(0.1))  # waits for the step
                self.assertEqual(peer.wait_for(time, lambda _: True), 0)
                self.assertEqual(peer.apply(step, finroc.number(3)), "")
                peer.wait_for(time, lambda now: abs(now - 0.015) < 1e-9)
                self.assertIn("at least 1", peer.apply(step, finroc.number(2)))
                self.assertIn("0.1", daemon.visum("get", "arm", "Desired Angle 1").stdout)

    def test_an_emergency_stop_waits_for_no_cycle(self):
        with Daemon("--clock", "lockstep") as daemon:
            with Bridge(daemon, "--port", 0, "--lockstep") as bridge, finroc.Peer(bridge.port) as peer:
                stop = peer.find("Parameters/Emergency Stop")
                self.assertEqual(peer.apply(stop, b"\1"), "")  # nobody asks for a step
                self.assertIn("true", daemon.visum("params", "arm").stdout)
                peer.subscribe(stop)
                peer.wait_for(stop, lambda value: value is True)

    def test_says_what_is_wrong(self):
        with Daemon("--clock", "lockstep") as daemon:
            wrong = visum("bridge", "finroc", "--connect", daemon.connect, "--lockstep", "--gate", "arm/Angle", expect=2)
            self.assertIn("'arm/Angle'", wrong.stderr)
        with Daemon() as daemon:
            wrong = visum("bridge", "finroc", "--connect", daemon.connect, "--lockstep", expect=1)
            self.assertIn("--clock lockstep", wrong.stderr)


class Modules(unittest.TestCase):
    """The modules of a real controller: the parts hardware and motion."""

    def start(self, kind, lower):
        process = subprocess.Popen([BIN / f"visum-mca-{kind}", "--lower", lower, "--port", "0"],
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.addCleanup(process.wait, timeout=DEADLINE_S)
        self.addCleanup(process.kill)
        return process

    def test_they_come_with_values_and_edges_are_held_and_go(self):
        with Daemon("-r") as daemon, Bridge(daemon, "--port", 0) as bridge, finroc.Peer(bridge.port) as peer:
            peer.subscribe(peer.find("Output/Actual Angle 1"))  # so that the bridge looks often
            hardware = self.start("hardware", f"arm@{daemon.connect}")
            motion = self.start("motion", f"hardware@{daemon.connect}")
            supervisor = "/motion/Arm/Supervisor"
            peer.await_structure(lambda peer: f"{supervisor}/Profile/Held For Test" in peer.by_path and
                                 "/hardware/Guard/Sensor Input/Part State" in peer.by_path)
            self.assertEqual(peer.by_path["/motion/Arm"].tags, ["group"])
            self.assertEqual(peer.by_path[supervisor].tags, ["module"])
            target = peer.by_path["/hardware/Sensor Input/Actual Angle 1"].handle
            peer.await_structure(lambda peer: target in peer.find("arm/Sensor Output/Actual Angle 1").targets)
            self.assertIn(peer.by_path[f"{supervisor}/Sensor Input/Part State"].handle,
                          peer.by_path["/motion/Arm/Sensor Input/Part State"].targets)

            state, fault = (peer.by_path[f"{supervisor}/{port}"] for port in
                            ("Sensor Input/Part State", "Sensor Output/Fault"))
            held, release = (peer.by_path[f"{supervisor}/{port}"] for port in
                             ("Profile/Held For Test", "Parameters/Release Held"))
            peer.subscribe(state, fault, held, peer.by_path[f"{supervisor}/Profile/Sense Time"])
            peer.wait_for(peer.by_path[f"{supervisor}/Profile/Sense Time"], lambda seconds: seconds > 0)
            self.assertEqual(peer.apply(state, finroc.number(3)), "")
            peer.wait_for(fault, lambda value: value == 1)
            peer.wait_for(held, lambda text: text == "Part State = 3")
            self.assertEqual(peer.apply(release, b"\1"), "")
            peer.wait_for(held, lambda text: text == "")
            self.assertIn("output", peer.apply(fault, finroc.number(0)))
            for process in (motion, hardware):
                process.terminate()
                process.wait(timeout=DEADLINE_S)
            peer.await_structure(lambda peer: not any(path.startswith(("/motion", "/hardware")) for path in peer.by_path))


    def test_parameters_are_edited_in_the_module_and_blackboards_are_shown(self):
        with Daemon("-r") as daemon, Bridge(daemon, "--port", 0) as bridge, finroc.Peer(bridge.port) as peer:
            peer.subscribe(peer.find("Output/Actual Angle 1"))  # so that the bridge looks often
            self.start("hardware", f"arm@{daemon.connect}")
            self.start("motion", f"hardware@{daemon.connect}")
            self.start("task", f"motion@{daemon.connect}")
            trajectory = "/motion/Arm/Trajectory/Parameters"
            # All of the controller is there anew when a part of it comes.
            wanted = {f"{trajectory}/Release Held", "/motion/Blackboards/Way/read", "/task/Sequence/Parameters/Release Held"}
            peer.await_structure(lambda peer: wanted <= set(peer.by_path))
            speed, way = peer.by_path[f"{trajectory}/Speed"], peer.by_path["/motion/Blackboards/Way/read"]
            self.assertTrue(speed.flags & finroc.ACCEPTS)
            self.assertTrue(way.flags & finroc.READ_ONLY)
            last = peer.find("Bridge/Sensor Output/Last Refusal")
            peer.subscribe(speed, way, last)
            peer.wait_for(speed, lambda value: value == 0.8)

            def in_force():
                parameters = next(module["parameters"] for module in daemon.json("modules", "motion")["modules"]
                                  if module["name"] == "Trajectory")
                return next(one["value"] for one in parameters if one["name"] == "Speed")
            self.assertEqual(peer.apply(speed, finroc.number(0.5)), "")  # as finstruct
            peer.wait_for(speed, lambda value: value == 0.5)
            self.assertEqual(in_force(), 0.5)
            peer.write(speed, finroc.number(0.25))  # as fingui
            peer.wait_for(speed, lambda value: value == 0.25)
            self.assertEqual(in_force(), 0.25)
            self.assertEqual(peer.apply(speed, finroc.number(3)), "'Speed' must be within 0.05 and 2")
            peer.wait_for(last, lambda text: text.endswith("Trajectory/Parameters/Speed: 'Speed' must be within 0.05 and 2"))
            self.assertEqual(in_force(), 0.25)
            # Somebody else changes it, and the peer sees that.
            daemon.visum("modules", "motion", "--set", "Arm/Trajectory/Speed=0.75")
            peer.wait_for(speed, lambda value: value == 0.75)

            self.assertIn("output", peer.apply(way, b"x\0"))
            rows = peer.wait_for(way, lambda text: text != "").split("; ")
            self.assertTrue(rows[0].startswith("0 "), rows[0])  # the time, and an angle of each joint
            self.assertEqual({len(row.split()) for row in rows[:-1]}, {8})


class Robustness(unittest.TestCase):
    def test_garbage_ends_no_bridge(self):
        with Daemon() as daemon, Bridge(daemon, "--port", 0) as bridge, finroc.Peer(bridge.port) as peer:
            for garbage in (b"GET / HTTP/1.1\r\n\r\n", b"\0" * 5000, finroc.GREETING + b"\1\0\xff\xff\xff\xff",
                            finroc.GREETING + struct.pack("<HI", 1, 9) + b"\xff" * 9):
                with socket.create_connection(("127.0.0.1", bridge.port), timeout=DEADLINE_S) as stranger:
                    stranger.sendall(garbage)
                    self.assertEqual(stranger.recv(1), b"")
            actual = peer.find("Output/Actual Angle 1")
            peer.subscribe(actual)
            peer.wait_for(actual, lambda _: True)

    def test_acknowledges_each_batch(self):
        with Daemon() as daemon, Bridge(daemon, "--port", 0) as bridge, finroc.Peer(bridge.port) as peer:
            for count in range(3):
                peer.values.batch(b"", acknowledge=count)
                self.assertEqual(peer.values.next_batch()[1], count)

    def test_ends_with_its_server_and_at_a_signal(self):
        with Daemon() as daemon:
            with Bridge(daemon, "--port", 0) as bridge:
                self.assertEqual(bridge.end(), 130)
            bridge = Bridge(daemon, "--port", 0).__enter__()
            daemon.process.terminate()
            self.assertEqual(bridge.process.wait(timeout=DEADLINE_S), 4)
            bridge.__exit__()


if __name__ == "__main__":
    os.chdir(pathlib.Path(__file__).parent)
    unittest.main()
