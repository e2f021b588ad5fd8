"""Inverse kinematics in Python: three arms (arms.json), and the arm of a running world."""
import json
import math
import os
import sys
import unittest

from programs import ARM, BIN, SOURCE

sys.path.insert(0, str(BIN.parent / "python"))
os.environ.setdefault("VISUM_BIN", str(BIN))
import visum  # noqa: E402
from visum.kinematics import Chain, ChainJoint, Pose, compose, inverse_of  # noqa: E402

POSES = 60  # of each arm; the C++ library does ten thousand of each by the same method
ARMS = json.loads((SOURCE / "tests/clients/arms.json").read_text())


def arm(name):
    return Chain("", [ChainJoint(joint["name"], "", joint["slides"], Pose(tuple(joint["frame"][:3]), tuple(joint["frame"][3:])),
                                 tuple(joint["axis"]), joint["lower"], joint["upper"]) for joint in ARMS[name]])


class Numbers:
    """The generator of Park and Miller, as in the tests of the page and of the C++ library."""

    def __init__(self, seed):
        self.seed = seed

    def within(self, chain):
        values = []
        for joint in chain.joints:
            self.seed = 48271 * self.seed % 2147483647
            values.append(joint.lower + self.seed / 2147483647 * (joint.upper - joint.lower))
        return values


def apart(a, b):
    sign = math.copysign(1.0, sum(x * y for x, y in zip(a.orientation, b.orientation)))
    return max(*(abs(x - y) for x, y in zip(a.position, b.position)), *(abs(x - sign * y) for x, y in zip(a.orientation, b.orientation)))


class ThreeArms(unittest.TestCase):
    def test_every_pose_that_can_be_reached_is_found_within_the_limits(self):
        for name in ARMS:
            chain, numbers = arm(name), Numbers(7)
            for i in range(POSES):
                tool = chain.forward(numbers.within(chain))
                found = chain.inverse(tool, numbers.within(chain))
                with self.subTest(arm=name, pose=i):
                    self.assertTrue(found.reached)
                    self.assertLess(apart(chain.forward(found.values), tool), 2e-6)
                    for value, joint in zip(found.values, chain.joints):
                        self.assertTrue(joint.lower <= value <= joint.upper)

    def test_a_pose_out_of_reach_is_told(self):
        found = arm("amtec_arm").inverse(Pose((5.0, 0.0, 0.5)), [0.1] * 7, starts=1)
        self.assertFalse(found.reached)
        self.assertGreater(found.position_error, 3.5)

    def test_a_vector_of_the_wrong_length_is_refused(self):
        with self.assertRaisesRegex(visum.Error, "2 values were given for 7 joints"):
            arm("amtec_arm").forward([0.0, 0.0])

    def test_a_pose_and_its_inverse_cancel(self):
        chain = arm("cylindrical")
        pose = chain.forward(Numbers(3).within(chain))
        self.assertLess(apart(compose(pose, inverse_of(pose)), Pose()), 1e-12)


class InAWorld(unittest.TestCase):
    def test_the_chain_agrees_with_the_world_and_brings_the_hand_to_a_pose(self):
        with visum.launch(ARM, clock="lockstep") as client:
            chain = client.chain("arm/link_7")
            self.assertEqual([joint.name for joint in chain.joints], [f"arm/joint_{i}" for i in range(1, 8)])
            part = client.part("arm")
            desired = part.inputs("Desired Angle")
            body = client.read_world().body("arm/link_7")
            base = client.read_world().body(chain.base) if chain.base else None
            tool = chain.forward(list(desired))
            if base:
                tool = compose(Pose(base.position, base.quaternion), tool)
            self.assertLess(apart(tool, Pose(body.position, body.quaternion)), 1e-3)
            goal = chain.forward(list(desired))
            goal = goal._replace(position=(goal.position[0], goal.position[1] + 0.1, goal.position[2] + 0.05))
            found = chain.inverse(goal, list(desired), starts=1)
            self.assertTrue(found.reached)
            with part.lease():
                client.join()
                desired.set(found.values)
                part.write()
                client.advance_ms(6000)
                now = client.read_world().body("arm/link_7")
            moved = [b - a for a, b in zip(body.position, now.position)]
            for was, wanted in zip(moved, (0.0, 0.1, 0.05)):
                self.assertAlmostEqual(was, wanted, delta=2e-3)

    def test_a_body_that_nothing_drives_has_no_chain(self):
        with visum.launch(ARM, clock="lockstep") as client:
            with self.assertRaisesRegex(visum.Error, "no part drives a joint that carries 'box'"):
                client.chain("box")
            with self.assertRaisesRegex(visum.Error, "arm/link_7"):
                client.chain("arm/link_8")


if __name__ == "__main__":
    unittest.main()
