"""The Python client against the real daemon: every verb once, and what goes wrong."""

import math
import tempfile
import unittest
from pathlib import Path

import visum
from programs import running_daemon
from visum.token_file import read_token_file


class OnTheTwoLinkRobot(unittest.TestCase):
    """One daemon in lockstep for all; each test begins with a reset."""

    @classmethod
    def setUpClass(cls) -> None:
        cls.daemon = running_daemon("two_link.yaml", "--clock", "lockstep")
        cls.address = cls.enterClassContext(cls.daemon)

    def setUp(self) -> None:
        self.admin = self.enterContext(visum.Client(self.address, name="admin", role="admin"))
        self.admin.reset()
        self.client = self.enterContext(visum.Client(self.address, name="test"))
        self.robot = self.client.part("robot")

    def test_welcome_tells_clock_and_tick(self) -> None:
        self.assertEqual(self.client.server.clock, "lockstep")
        self.assertEqual(self.client.server.tick_ns, 1_000_000)
        self.assertTrue(self.client.server.simulated)

    def test_part_describes_its_ports(self) -> None:
        self.assertEqual(self.client.part_names(), ["robot"])
        self.assertEqual(self.robot.kind, "servo_group")
        desired = self.robot.inputs("Desired Angle")
        self.assertEqual([port.name for port in desired.ports], ["Desired Angle 1", "Desired Angle 2"])
        self.assertEqual(desired.ports[0].unit, "rad")
        self.assertAlmostEqual(self.robot.outputs("Actual Angle 2")[0], 0.8, places=4)

    def test_moves_where_it_is_told(self) -> None:
        desired, actual = self.robot.inputs("Desired Angle"), self.robot.outputs("Actual Angle")
        with self.robot.lease():
            self.client.join()
            desired.set([0.1, 0.2])
            self.robot.write()
            for _ in range(200):
                self.client.advance_ms(10)
            self.client.leave()
        self.assertEqual(self.client.time_ns, 2_000_000_000)
        self.assertAlmostEqual(actual[0], 0.1, delta=0.005)
        self.assertAlmostEqual(actual[1], 0.2, delta=0.005)

    def test_periods_that_are_no_multiple_of_the_tick_do_not_drift(self) -> None:
        self.client.join()
        for _ in range(100):
            self.client.advance_ns(2_500_000)
        self.assertEqual(self.client.tick, 250)
        self.client.leave()

    def test_bad_values_are_refused_before_they_are_sent(self) -> None:
        desired = self.robot.inputs("Desired Angle")
        for bad in (math.nan, math.inf, -1e308):
            with self.assertRaises(visum.Error) as caught:
                desired[0] = bad
            self.assertEqual(caught.exception.code, visum.ErrorCode.BAD_VALUE)
        with self.assertRaises(visum.Error) as caught:
            desired.set([0.0])
        self.assertEqual(caught.exception.code, visum.ErrorCode.MISUSE)

    def test_unknown_names_get_a_hint(self) -> None:
        with self.assertRaisesRegex(visum.Error, "did you mean 'robot'"):
            self.client.part("robto")
        with self.assertRaisesRegex(visum.Error, "did you mean 'Desired Angle'"):
            self.robot.inputs("Desired Angel")

    def test_second_controller_is_told_who_holds_the_lease(self) -> None:
        with self.robot.lease(), visum.Client(self.address, name="other") as other:
            with self.assertRaises(visum.Error) as caught:
                other.part("robot").acquire()
            self.assertEqual(caught.exception.code, visum.ErrorCode.LEASED)
            self.assertEqual(caught.exception.owner, "test")

    def test_write_without_lease_is_refused(self) -> None:
        self.robot.inputs("Desired Angle")[0] = 0.0
        self.robot.write()
        with self.assertRaises(visum.Error) as caught:
            self.robot.read()
        self.assertEqual(caught.exception.code, visum.ErrorCode.NO_LEASE)

    def test_nothing_of_a_lease_outlasts_it(self) -> None:
        desired = self.robot.inputs("Desired Angle")
        with self.robot.lease():
            desired[0] = 0.3
            self.robot.write()
            desired[1] = 0.9
        with visum.Client(self.address, name="other") as other:
            robot = other.part("robot")
            with robot.lease():
                robot.inputs("Desired Angle").set([-0.4, 0.5])
                robot.write()
        with self.robot.lease():
            self.robot.write()  # a sign of life
            self.client.join()
            self.client.advance_ms(1)
            self.client.leave()
            self.assertEqual(list(desired), [-0.4, 0.5])

    def test_nothing_of_an_era_outlasts_it(self) -> None:
        desired = self.robot.inputs("Desired Angle")
        self.client.join()
        with self.robot.lease():
            initial = list(desired)
            desired.set([0.3, 0.2])
            self.robot.write()
            self.client.advance_ms(1)
            self.admin.reset()
            self.client.advance_ms(1)
            self.assertEqual(list(desired), initial)
            self.robot.write()
            self.client.advance_ms(1)
            self.assertEqual(list(desired), initial)
        self.client.leave()

    def test_what_was_set_counts_though_a_sample_is_older(self) -> None:
        desired = self.robot.inputs("Desired Angle")
        with self.robot.lease():
            desired[0] = 0.0
            for _ in range(200):  # the world stands
                desired[0] += 0.001
                self.robot.write()
                self.robot.read()
            self.assertAlmostEqual(desired[0], 0.2)

    def test_a_lease_begins_with_what_is_in_force(self) -> None:
        with visum.Client(self.address, name="other") as other:
            robot = other.part("robot")
            with robot.lease():
                robot.inputs("Desired Angle")[0] = 0.25
                robot.write()
                other.join()
                other.advance_ms(1)
                other.leave()
        with self.robot.lease():
            self.assertEqual(self.robot.inputs("Desired Angle")[0], 0.25)

    def test_a_lease_that_was_taken_is_over_once_it_is_released(self) -> None:
        self.robot.acquire()
        taken = self.admin.part("robot")
        taken.acquire(take=True)
        with self.assertRaises(visum.Error) as caught:
            self.robot.release()
        taken.release()
        self.assertEqual(caught.exception.code, visum.ErrorCode.NO_LEASE)
        self.assertFalse(self.robot.leased)

    def test_an_advance_that_is_refused_leaves_no_answers_over(self) -> None:
        self.robot.inputs("Desired Angle")[0] = 0.3
        self.robot.write()
        refusals = []
        for _ in range(2):
            with self.assertRaises(visum.Error) as caught:
                self.client.advance_ms(1)
            refusals.append(caught.exception.code)
        self.assertEqual(refusals, [visum.ErrorCode.NO_LEASE, visum.ErrorCode.WRONG_STATE])
        self.assertFalse(self.client.connection._replies)

    def test_values_hold_after_a_release_and_part_is_ready(self) -> None:
        with self.robot.lease():
            self.robot.inputs("Desired Angle")[0] = 0.3
            self.robot.write()
        self.client.join()
        self.client.advance_ms(1000)
        self.client.leave()
        self.assertAlmostEqual(self.robot.outputs("Actual Angle")[0], 0.3, delta=0.005)
        self.assertEqual(self.robot.outputs("Part State")[0], 0)

    def test_an_exception_in_the_lease_stops_the_part(self) -> None:
        with self.assertRaises(ZeroDivisionError):
            with visum.Client(self.address, name="crasher") as crasher, crasher.part("robot").lease():
                raise ZeroDivisionError
        self.client.join()
        self.client.advance_ms(100)
        self.client.leave()
        self.assertEqual(self.robot.outputs("Part State")[0], 6, "controller lost")
        self.assertIn("lease_lost", [event.kind for event in self.client.events()])

    def test_parameters_are_typed(self) -> None:
        before = self.robot.parameter("Position Gain 1")
        with self.robot.lease():
            self.robot.set_parameter("Position Gain 1", 12.5)
            self.robot.set_parameter("On Controller Lost", "hold")
            with self.assertRaises(visum.Error) as caught:
                self.robot.set_parameter("On Controller Lost", "explode")
        self.assertEqual(caught.exception.code, visum.ErrorCode.BAD_VALUE)
        self.assertEqual(self.robot.parameter("Position Gain 1"), 12.5)
        self.assertNotEqual(before, 12.5)

    def test_parameters_take_what_is_a_number_and_nothing_that_is_not(self) -> None:
        class Gain(float):
            """As numpy's are."""

        with self.robot.lease():
            self.robot.set_parameter("Position Gain 1", Gain(12.5))
            with self.assertRaises(visum.Error) as caught:
                self.robot.set_parameter("Position Gain 1", None)
        self.assertEqual(caught.exception.code, visum.ErrorCode.MISUSE)
        self.assertEqual(self.robot.parameter("Position Gain 1"), 12.5)

    def test_blackboard_tells_the_identity(self) -> None:
        self.assertIn(b"example_24nm", self.robot.read_blackboard("Identity"))

    def test_world_is_the_truth_of_the_ports(self) -> None:
        view = self.admin.read_world()
        self.assertIn("robot/upper", view.world.body_names)
        self.assertAlmostEqual(view.joint("robot/elbow").position, self.robot.outputs("Actual Angle")[1], places=4)
        self.assertAlmostEqual(view.body("robot/upper").position[2], 0.5, places=6)
        with self.assertRaises(visum.Error):
            view.body("nobody")

    def test_snapshot_brings_back_the_same_bits(self) -> None:
        snapshot = self.admin.take_snapshot()
        before = self.admin.read_world().state_hash
        self.client.join()
        self.client.advance_ms(50)
        self.client.leave()
        self.assertNotEqual(self.admin.read_world().state_hash, before)
        self.admin.restore_snapshot(snapshot)
        self.assertEqual(self.admin.read_world().state_hash, before)

    def test_bodies_come_and_go_and_are_pushed(self) -> None:
        self.admin.add_body("{name: ball, mass: 0.5, pose: {xyz: [1, 1, 0.5]}, shapes: [{sphere: 0.05}]}")
        self.admin.push_body("ball", [1.0, 0.0, 0.0], 0.1)
        self.client.join()
        self.client.advance_ms(110)
        self.client.leave()
        # Impulse over mass: 1 N for 0.1 s on 0.5 kg.
        self.assertAlmostEqual(self.admin.read_world().body("ball").velocity[0], 0.2, places=6)
        self.admin.remove_body("ball")
        self.assertNotIn("ball", self.admin.world().body_names)

    def test_faults_act_from_the_next_tick_on(self) -> None:
        robot = self.admin.part("robot")
        robot.inject_fault("encoder_offset", joint=1, offset=0.01, seconds=1.0)
        self.client.join()
        self.client.advance_ms(1)
        self.assertEqual(robot.faults(), ["encoder_offset"])
        robot.clear_fault("encoder_offset")
        self.client.advance_ms(1)
        self.client.leave()
        self.assertEqual(robot.faults(), [])
        with self.assertRaisesRegex(visum.Error, "there is no drive 9"):
            robot.inject_fault("encoder_stuck", joint=9)

    def test_paused_world_steps(self) -> None:
        self.admin.pause()
        self.admin.step(7)
        status = self.admin.status()
        self.assertEqual((status.tick, status.paused), (7, True))
        self.admin.resume()

    def test_observer_may_not_command(self) -> None:
        with visum.Client(self.address, name="viewer", role="observer") as viewer:
            with self.assertRaises(visum.Error) as caught:
                viewer.part("robot").acquire()
        self.assertEqual(caught.exception.code, visum.ErrorCode.FORBIDDEN)


class WithTokens(unittest.TestCase):
    def setUp(self) -> None:
        self.file = Path(self.enterContext(tempfile.TemporaryDirectory())) / "tokens"

    def written(self, text: str) -> Path:
        self.file.write_text(text)
        self.file.chmod(0o600)
        return self.file

    def test_a_line_alone_is_the_token(self) -> None:
        self.assertEqual(read_token_file(self.written("# mine\n\n  0123456789abcdef  # end\n"), "admin"), b"0123456789abcdef")
        self.assertEqual(read_token_file(None, "admin"), b"")

    def test_takes_the_least_role_that_is_enough_or_the_greatest_there_is(self) -> None:
        file = self.written("admin AAAA\nobserver OOOO\ncontroller CN=anna\ncontroller CCCC\n")
        self.assertEqual([read_token_file(file, role) for role in ("observer", "controller", "admin")], [b"OOOO", b"CCCC", b"AAAA"])
        self.assertEqual(read_token_file(self.written("observer OOOO\ncontroller CCCC\n"), "admin"), b"CCCC")

    def test_names_the_file_that_is_wrong(self) -> None:
        for file in (self.written("# nothing\n"), "/nowhere/at/all"):
            with self.assertRaisesRegex(visum.Error, str(file)) as caught:
                read_token_file(file, "admin")
            self.assertEqual(caught.exception.code, visum.ErrorCode.UNAUTHENTICATED)

    def test_the_servers_own_file_opens_its_door(self) -> None:
        file = self.written("observer looking-only-0001\ncontroller moves-the-arm-0001\nadmin does-anything-0001\n")
        with running_daemon("two_link.yaml", "--token-file", str(file)) as address:
            with visum.Client(address, name="mover", token_file=file) as client, client.part("robot").lease():
                pass
            with visum.Client(address, name="looker", role="observer", token_file=file) as client:
                self.assertEqual(client.connection.welcome.role, 1)


class WithoutAServer(unittest.TestCase):
    def test_says_that_nobody_listens(self) -> None:
        with self.assertRaises(visum.Error) as caught:
            visum.Client("127.0.0.1:1", connect_timeout_s=0.0)
        self.assertEqual(caught.exception.code, visum.ErrorCode.CONNECTION)

    def test_refuses_an_address_that_is_none(self) -> None:
        for bad in ("", "host", "host:x", "host:99999999"):
            with self.assertRaises(visum.Error) as caught:
                visum.Client(bad, connect_timeout_s=0.0)
            self.assertEqual(caught.exception.code, visum.ErrorCode.MISUSE)


if __name__ == "__main__":
    unittest.main(verbosity=2)
