"""The duties of a served arm, whatever program serves it, in real time. The finer points, without a clock:
tests/hwparts/contract_test.cc; the pick-and-place controller in front of modules: closed_loop_test.cc."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import unittest
from collections.abc import Callable

from served_arm import Served, serve_mirror, serve_real, serve_virtual, wait_until

import visum

READY, MOVING, DISABLED, HALTED, FAULT, LOST = 0, 1, 2, 4, 5, 6


class ServedArm:
    """The suite; the classes below say what serves the arm."""

    serve: Callable[[], object]
    simulated = True

    def setUp(self) -> None:
        self.served: Served = self.enterContext(type(self).serve())
        self.client = self.enterContext(visum.Client(self.served.address, name="contract"))
        self.arm = self.client.part("arm")
        self.angles = self.arm.outputs("Actual Angle")
        self.desired = self.arm.inputs("Desired Angle")
        self.client.join()

    def state(self) -> int:
        return int(self.arm.outputs("Part State")[0])

    def expect(self, holds: Callable[[], bool], sim_s: float = 10.0) -> None:
        self.assertTrue(wait_until(self.client, self.arm, holds, sim_s),
                        f"state {self.state()}, angles {list(self.angles)}")

    def bump(self, counter: str) -> None:
        port = self.arm.inputs(counter)
        port[0] = port[0] + 1
        self.arm.write()

    def go(self, joint: int, angle: float) -> None:
        self.desired[joint - 1] = angle
        self.arm.write()

    def truth(self, joint: int) -> list[float]:
        """Where the joint is in the worlds behind."""
        found = []
        for world in self.served.worlds:
            with visum.Client(world.address, name="truth", role="observer") as client:
                found.append(client.part("arm").outputs("Actual Angle")[joint - 1])
        return found

    def test_the_description_is_the_arms(self) -> None:
        with serve_virtual() as other, visum.Client(other.address) as client:
            arm = client.part("arm")

            def contract(ports: list[visum.Port]) -> list[tuple]:
                return [(p.index, p.name, p.unit, p.group, p.minimum, p.maximum) for p in ports]

            self.assertEqual(self.arm.kind, arm.kind)
            self.assertEqual(contract(self.arm.input_ports), contract(arm.input_ports))
            self.assertEqual(contract(self.arm.output_ports), contract(arm.output_ports))
            for mine, theirs in zip(self.arm.input_ports, arm.input_ports):
                self.assertAlmostEqual(mine.initial, theirs.initial, places=3, msg=mine.name)
        self.assertEqual(self.client.server.simulated, self.simulated)
        self.assertIn("kind: amtec_arm", self.arm.read_blackboard("Identity").decode())

    def test_it_goes_where_it_is_told_and_so_does_the_world_behind(self) -> None:
        with self.arm.lease():
            self.go(1, 0.3)
            self.expect(lambda: self.state() == MOVING)
            self.expect(lambda: self.state() == READY)
            self.assertAlmostEqual(self.angles[0], 0.3, places=2)
            # A second arm behind the same part may arrive later.
            self.expect(lambda: all(abs(angle - 0.3) < 0.005 for angle in self.truth(1)))

    def test_halt_and_reset(self) -> None:
        with self.arm.lease():
            self.go(1, 1.0)
            self.expect(lambda: self.angles[0] > 0.05)
            self.bump("Halt")
            self.expect(lambda: self.state() == HALTED)
            self.bump("Reset")
            self.expect(lambda: self.state() == READY)

    def test_it_stands_without_execution_enable(self) -> None:
        with self.arm.lease():
            self.arm.inputs("Execution Enable")[0] = 0
            self.go(1, 0.5)
            self.expect(lambda: self.state() == DISABLED)
            self.client.advance_ms(300)
            self.assertAlmostEqual(self.angles[0], 0.0, places=3)
            self.arm.inputs("Execution Enable")[0] = 1
            self.arm.write()
            self.expect(lambda: self.angles[0] > 0.05)

    def test_a_controller_that_is_killed_stops_the_arm(self) -> None:
        program = ("import sys, visum\n"
                   "client = visum.Client(sys.argv[1], name='victim'); arm = client.part('arm'); arm.acquire()\n"
                   "arm.inputs('Desired Angle')[0] = 1.5; arm.write(); arm.read(); print('up', flush=True)\n"
                   "sys.stdin.read()\n")
        with subprocess.Popen([sys.executable, "-c", program, self.served.address], stdin=subprocess.PIPE,
                              stdout=subprocess.PIPE, text=True) as victim:
            self.assertEqual(victim.stdout.readline(), "up\n")
            self.expect(lambda: self.angles[0] > 0.05)
            os.kill(victim.pid, signal.SIGKILL)
        self.expect(lambda: self.state() == LOST)
        self.client.advance_ms(700)
        stood = self.angles[0]
        self.assertLess(stood, 1.2)
        self.client.advance_ms(200)
        self.assertAlmostEqual(self.angles[0], stood, places=2)
        with self.arm.lease():
            self.bump("Reset")
            self.expect(lambda: self.state() == READY)

    def test_values_out_of_range_and_a_second_controller_are_refused(self) -> None:
        with self.arm.lease(), visum.Client(self.served.address, name="second") as other:
            with self.assertRaisesRegex(visum.Error, "contract"):
                other.part("arm").acquire()
            with self.assertRaisesRegex(visum.Error, "Desired Angle 1"):
                self.go(1, 1e6)


class Virtual(ServedArm, unittest.TestCase):
    serve = serve_virtual


class RealOverPty(ServedArm, unittest.TestCase):
    serve = serve_real("serial")
    simulated = False


class RealOverTcp(ServedArm, unittest.TestCase):
    serve = serve_real("tcp")
    simulated = False


class RealOverSlcan(ServedArm, unittest.TestCase):
    serve = serve_real("slcan")
    simulated = False


class MirrorOfTwo(ServedArm, unittest.TestCase):
    serve = serve_mirror


if __name__ == "__main__":
    unittest.main(verbosity=2)
