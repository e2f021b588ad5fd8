"""visum mirror: two arms with one controller, their divergence, and which of them is shown."""

from __future__ import annotations

import signal
import socket
import subprocess
import tempfile
import unittest
from pathlib import Path

from programs import BIN
from served_arm import PATIENCE_S, MirrorProgram, Program, serve_real, virtual_arm, wait_until

import visum

READY, HALTED, FAULT = 0, 4, 5


class TwoArms(unittest.TestCase):
    def setUp(self) -> None:
        self.arms = [self.enterContext(virtual_arm()), self.enterContext(virtual_arm())]

    def mirror(self, *options: str) -> None:
        self.program = self.enterContext(MirrorProgram(*self.arms, *options))
        self.client = self.enterContext(visum.Client(self.program.address, name="test", role="admin"))
        self.arm = self.client.part("arm")
        self.divergence = self.client.part("arm_divergence")
        self.client.join()
        self.arm.acquire()

    def seen(self, name: str) -> float:
        part = self.arm if name in ("Part State", "Actual Angle 1") else self.divergence
        return part.outputs(name)[0]

    def go(self, angle: float) -> None:
        self.arm.inputs("Desired Angle")[0] = angle
        self.arm.write()

    def reset(self) -> None:
        counter = self.arm.inputs("Reset")
        counter[0] = counter[0] + 1
        self.arm.write()

    def expect(self, holds, sim_s: float = 10.0) -> None:
        self.assertTrue(wait_until(self.client, self.arm, holds, sim_s))

    def states(self) -> list[float]:
        """Reads the part states from the arms themselves."""
        found = []
        for arm in self.arms:
            with visum.Client(arm.address, name="look", role="observer") as client:
                found.append(client.part("arm").outputs("Part State")[0])
        return found

    def hold_back(self, arm: Program) -> None:
        """The arm moves its joint 1 no more: a controller of its own could not, since the mirror has the lease."""
        with visum.Client(arm.address, name="hand", role="admin") as client:
            client.part("arm").set_parameter("Maximum Acceleration 1", 0.01)

    def test_the_divergence_is_shown_joint_by_joint_and_trips_its_limit(self) -> None:
        self.mirror("--angle-limit", "0.1")
        self.go(0.2)
        self.expect(lambda: self.seen("Actual Angle 1") > 0.195 and self.seen("Part State") == READY)
        self.assertLess(self.seen("Largest Angle Divergence"), 0.1)
        self.assertEqual(self.seen("Divergence Fault"), 0)
        self.hold_back(self.arms[1])
        self.go(1.0)
        self.expect(lambda: self.seen("Divergence Fault") == 1)
        self.assertEqual(self.seen("Part State"), FAULT)
        self.assertLess(self.seen("Divergence of Actual Angle 1"), -0.05)
        self.client.advance_ms(1500)
        stood = self.seen("Actual Angle 1")
        self.client.advance_ms(200)
        self.assertAlmostEqual(self.seen("Actual Angle 1"), stood, places=2)
        self.divergence.set_parameter("Angle Limit", 0.0)
        self.reset()
        self.expect(lambda: self.seen("Part State") == READY)

    def test_the_primary_is_switched_where_they_agree_or_by_force(self) -> None:
        self.mirror()
        self.divergence.set_parameter("Primary", 2)
        self.client.advance_ms(20)
        self.assertEqual(self.seen("Primary"), 2)
        self.hold_back(self.arms[0])
        self.go(0.5)
        self.expect(lambda: self.seen("Actual Angle 1") > 0.2)
        with self.assertRaisesRegex(visum.Error, "rad and .* m apart"):
            self.divergence.set_parameter("Primary", 1)
        self.divergence.set_parameter("Force Primary", 1)
        self.client.advance_ms(20)
        self.assertEqual(self.seen("Primary"), 1)
        self.assertGreater(self.seen("Divergence of Actual Angle 1"), 0.0)

    def test_a_lost_primary_is_a_fault_and_the_shadow_can_take_over(self) -> None:
        self.mirror()
        self.arms[0].end(signal.SIGKILL)
        self.expect(lambda: self.seen("Connected 1") == 0)
        self.assertEqual(self.seen("Part State"), FAULT)
        self.divergence.set_parameter("Force Primary", 2)
        self.expect(lambda: self.seen("Part State") == READY)
        self.go(0.2)
        self.expect(lambda: self.seen("Actual Angle 1") > 0.1)

    def test_counters_are_each_arms_own(self) -> None:
        with visum.Client(self.arms[1].address, name="before") as client:
            arm = client.part("arm")
            with arm.lease():
                arm.inputs("Halt")[0] = 2
                arm.write()
                client.join()
                client.advance_ms(20)
                arm.inputs("Reset")[0] = 1
                arm.write()
                client.advance_ms(20)
        self.mirror()
        self.go(0.3)
        self.expect(lambda: self.seen("Actual Angle 1") > 0.295)
        self.expect(lambda: self.seen("Largest Angle Divergence") < 0.01)  # the shadow was not halted

    def test_a_command_that_the_arms_refuse_halts_them_and_is_told(self) -> None:
        self.mirror()
        self.go(1.0)
        self.expect(lambda: self.seen("Actual Angle 1") > 0.1)
        fingers = self.arm.inputs("Desired Finger Position")
        fingers[0], fingers[1] = 0.01, 0.02  # one drive moves both alike
        self.arm.write()
        self.expect(lambda: self.seen("Divergence Fault") == 1)
        self.assertEqual(self.seen("Part State"), FAULT)
        self.assertGreaterEqual(self.seen("Refusals 1"), 1)
        self.assertIn("Desired Finger Position 2 must be equal", self.divergence.read_blackboard("Fault").decode())
        self.assertEqual(self.states(), [HALTED, HALTED])
        fingers[1] = 0.01
        self.reset()
        self.expect(lambda: self.seen("Part State") == READY)

    def test_a_command_of_the_next_controller_is_done_or_refused_but_never_lost(self) -> None:
        self.mirror()
        with visum.Client(self.program.address, name="next", role="admin") as following:
            arm = following.part("arm")
            following.join()
            self.arms[1].process.send_signal(signal.SIGSTOP)  # is away for a while
            self.addCleanup(self.arms[1].process.send_signal, signal.SIGCONT)
            arm.acquire(take=True)
            self.expect(lambda: self.seen("Connected 2") == 0)
            arm.inputs("Reset")[0] = 1
            arm.write()
            with self.assertRaisesRegex(visum.Error, "is away, and would miss this command") as refused:
                arm.read()
            self.assertEqual(refused.exception.code, visum.ErrorCode.WRONG_STATE)
            self.arms[1].process.send_signal(signal.SIGCONT)
            self.expect(lambda: self.seen("Connected 1") == 1 and self.seen("Connected 2") == 1)
            arm.write()
            arm.read()
            self.expect(lambda: self.seen("Part State") == READY)
            self.expect(lambda: self.states() == [READY, READY])

    def test_looking_for_an_arm_that_is_gone_holds_nobody_up(self) -> None:
        self.mirror()
        self.arms[1].end(signal.SIGKILL)
        self.expect(lambda: self.seen("Connected 2") == 0)
        with socket.create_server(("127.0.0.1", self.arms[1].ready["port"])) as mute:
            mute.settimeout(PATIENCE_S)
            search, _ = mute.accept()
            with search:
                self.assertTrue(search.recv(1024), "says hello, and waits for a second")
                self.client.advance_ms(50)
                search.setblocking(False)
                with self.assertRaises(BlockingIOError):  # waits still
                    search.recv(1)

    def test_parameters_reach_both(self) -> None:
        self.mirror()
        self.arm.set_parameter("Maximum Acceleration 1", 0.5)
        for arm in self.arms:
            with visum.Client(arm.address, name="look", role="observer") as client:
                self.assertEqual(client.part("arm").parameter("Maximum Acceleration 1"), 0.5)

    def test_shows_the_world_of_the_primary_and_follows_its_changes(self) -> None:
        self.mirror()
        self.expect(lambda: self.seen("World Of") == 1)
        self.go(0.3)
        self.expect(lambda: self.seen("Actual Angle 1") > 0.295 and self.seen("Part State") == READY)
        self.client.advance_ms(20)
        self.assertAlmostEqual(self.client.read_world().joint("arm/joint_1").position, 0.3, delta=0.005)
        with visum.Client(self.arms[0].address, name="look", role="admin") as admin:
            admin.add_body("{name: ball, mass: 0.1, pose: {xyz: [1.5, 1.5, 0.05]}, shapes: [{sphere: 0.05}]}")
        self.expect(lambda: "ball" in self.client.world().body_names)
        self.assertAlmostEqual(self.client.read_world().body("ball").position[0], 1.5, places=3)

    def test_shows_the_world_of_the_shadow_where_the_primary_is_real(self) -> None:
        with serve_real("tcp")() as real:
            self.arms[0] = real
            self.mirror()
            self.expect(lambda: self.seen("World Of") == 2)
            self.assertIn("box", self.client.world().body_names)


class AVirtualAndARealArm(unittest.TestCase):
    """The real one has no supply, nor an emergency stop, that a program could touch."""

    def setUp(self) -> None:
        self.virtual = self.enterContext(virtual_arm())
        self.real = self.enterContext(serve_real("tcp")())

    def state(self, arm: Program) -> float:
        with visum.Client(arm.address, name="look", role="observer") as client:
            return client.part("arm").outputs("Part State")[0]

    def expect(self, client: visum.Client, holds) -> None:
        self.assertTrue(wait_until(client, client.part("arm"), holds, 10.0))

    def mirror(self, primary: Program, shadow: Program) -> visum.Client:
        program = self.enterContext(MirrorProgram(primary, shadow))
        client = self.enterContext(visum.Client(program.address, name="test", role="admin"))
        client.join()
        return client

    def test_a_parameter_that_the_shadow_refuses_is_taken_back_from_the_primary(self) -> None:
        arm = self.mirror(self.virtual, self.real).part("arm")
        before = arm.parameter("Supply Voltage")
        with self.assertRaisesRegex(visum.Error, f"{self.real.address}: there is no parameter 'Supply Voltage'"):
            arm.set_parameter("Supply Voltage", 20.0)
        self.assertEqual(arm.parameter("Supply Voltage"), before)

    def test_an_emergency_stop_halts_a_shadow_that_has_none(self) -> None:
        self.stop_and_release(self.mirror(self.virtual, self.real))

    def test_an_emergency_stop_halts_a_primary_that_has_none(self) -> None:
        self.stop_and_release(self.mirror(self.real, self.virtual))

    def stop_and_release(self, client: visum.Client) -> None:
        arm = client.part("arm")
        arm.acquire()
        self.assertFalse(arm.parameter("Emergency Stop"))
        arm.set_parameter("Emergency Stop", True)
        self.expect(client, lambda: self.state(self.virtual) == FAULT)
        self.expect(client, lambda: self.state(self.real) == HALTED)
        arm.set_parameter("Emergency Stop", False)
        arm.inputs("Reset")[0] = 1
        arm.write()
        self.expect(client, lambda: self.state(self.virtual) == READY and self.state(self.real) == READY)


class WithTokens(unittest.TestCase):
    def test_sends_each_server_the_token_of_a_controller(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "tokens"
            file.write_text("observer looking-only-0001\ncontroller moves-the-arm-0001\n")
            file.chmod(0o600)
            with (virtual_arm("--token-file", file) as one, virtual_arm("--token-file", file) as other,
                  MirrorProgram(one, other, "--arm-token-file", file) as mirror,
                  visum.Client(mirror.address, name="test") as client):
                self.assertEqual(client.part("arm").outputs("Part State")[0], READY)


class WrongUse(unittest.TestCase):
    def test_arms_that_cannot_be_had_are_named(self) -> None:
        with virtual_arm() as one, visum.Client(one.address, name="somebody") as client:
            self.assertIn("nothing listens", self.refused(one.address, "127.0.0.1:1"))
            client.part("arm").acquire()
            self.assertIn("leased by 'somebody'", self.refused(one.address, one.address))

    @staticmethod
    def refused(primary: str, shadow: str) -> str:
        command = [BIN / "visum", "mirror", "--primary", primary, "--shadow", shadow, "--port", "0"]
        done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE_S)
        assert done.returncode == 2, done.stderr
        return done.stderr


if __name__ == "__main__":
    unittest.main(verbosity=2)
