"""The example controllers where things do not go as planned, and under the wall clock; real programs, real TCP."""

import os
import signal
import subprocess
import sys
import unittest
from pathlib import Path

import visum
from programs import BIN, pick_and_place, running_daemon

PYTHON_EXAMPLE = Path(__file__).resolve().parents[2] / "clients" / "python" / "examples" / "pick_and_place.py"
READY = 0
CONTROLLER_LOST = 6


def run(command: list[str]) -> subprocess.CompletedProcess:
    return subprocess.run(command, capture_output=True, text=True, timeout=200)


def python_example(address: str, *options: str) -> list[str]:
    return [sys.executable, str(PYTHON_EXAMPLE), "--connect", address, *options]


class OnTheArm(unittest.TestCase):
    def setUp(self) -> None:
        self.address = self.enterContext(running_daemon("amtec_arm.yaml", "--clock", "lockstep"))
        self.admin = self.enterContext(visum.Client(self.address, name="admin", role="admin"))

    def expect_untouched(self) -> None:
        self.assertEqual(self.admin.status().tick, 0, "time has run, so something may have moved")
        self.assertEqual(self.admin.part("arm").outputs("Part State")[0], READY)

    def test_unreachable_place_is_refused_before_anything_moves(self) -> None:
        for command in (pick_and_place, python_example):
            for options in (["--to", "1.2,0"], ["--from", "0.9,0.4"], ["--width", "0.1"]):
                result = run(command(self.address, *options))
                self.assertEqual(result.returncode, 1, result.stderr)
                self.assertRegex(result.stderr, "out of reach|wide")
                self.expect_untouched()

    def test_bad_usage_is_2(self) -> None:
        for command in (pick_and_place, python_example):
            for options in (["--from", "here"], ["--from", "0.5"], ["--nonsense"], ["--to", "nan,0"], ["--to", "0.5,inf"]):
                self.assertEqual(run(command(self.address, *options)).returncode, 2, options)

    def test_absent_box_is_noticed_and_the_arm_stays_ready(self) -> None:
        self.admin.remove_body("box")
        result = run(pick_and_place(self.address))
        self.assertEqual(result.returncode, 1)
        self.assertIn("closed on nothing", result.stderr)
        self.assertLess(self.admin.part("arm").outputs("Part State")[0], 2)

    def test_interrupt_holds_the_arm_and_gives_it_back(self) -> None:
        with subprocess.Popen(pick_and_place(self.address), stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              text=True) as controller:
            assert controller.stdout is not None
            while "goes down" not in controller.stdout.readline():
                pass
            controller.send_signal(signal.SIGINT)
            controller.communicate(timeout=60)
            self.assertEqual(controller.returncode, 130)
        arm = self.admin.part("arm")
        self.admin.join()
        self.admin.advance_ms(500)
        self.admin.leave()
        self.assertLess(max(map(abs, arm.outputs("Actual Speed"))), 0.002, "still moving")
        self.assertLess(arm.outputs("Part State")[0], 2)
        arm.acquire()  # free again

    def test_killed_controller_is_noticed_and_a_reset_revives_the_arm(self) -> None:
        with subprocess.Popen(pick_and_place(self.address), stdout=subprocess.PIPE, text=True) as controller:
            assert controller.stdout is not None
            while "moves above" not in controller.stdout.readline():
                pass
            controller.kill()
        arm = self.admin.part("arm")
        self.admin.join()
        self.admin.advance_ms(1000)
        self.assertEqual(arm.outputs("Part State")[0], CONTROLLER_LOST)
        refused = run(pick_and_place(self.address))
        self.assertEqual(refused.returncode, 1)
        self.assertIn("reports a fault", refused.stderr)
        with arm.lease():
            arm.inputs("Reset")[0] = 1
            arm.write()
            self.admin.advance_ms(100)
        self.assertEqual(arm.outputs("Part State")[0], READY)
        self.admin.leave()

    def test_part_of_another_robot_is_refused(self) -> None:
        with running_daemon("two_link.yaml") as other:
            result = run(pick_and_place(other, "--part", "robot"))
        self.assertEqual(result.returncode, 1)
        self.assertIn("Desired Finger Position", result.stderr)


class UnderTheWallClock(unittest.TestCase):
    """The same binary against the realtime clock, three times as fast as the wall's."""

    def test_same_controller_puts_the_box_on_the_spot(self) -> None:
        with (running_daemon("amtec_arm.yaml", "--clock", "realtime", "--speedup", "3") as address,
              visum.Client(address, name="checker", role="observer") as checker):
            result = run(pick_and_place(address))
            self.assertEqual(result.returncode, 0, result.stderr)
            box = checker.read_world().body("box")
            self.assertAlmostEqual(box.position[0], 0.5, delta=0.01)
            self.assertAlmostEqual(box.position[1], -0.2, delta=0.01)


if __name__ == "__main__":
    os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, [str(BIN.parent / "python"), os.environ.get("PYTHONPATH")]))
    unittest.main(verbosity=2)
