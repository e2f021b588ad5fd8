#!/usr/bin/python3
"""Stacks three cubes, with a 6-axis arm and a parallel gripper that are served as two hardware parts.

The gripper points straight down all the time, so that the joint angles for a place have a closed form. The arm moves along
paths as in pick_and_place.py.

    PYTHONPATH=build/release/python clients/python/examples/six_axis_arm.py --connect 127.0.0.1:1500

Exit codes: 0 done, 1 not possible or failed, 2 bad usage, 4 connection lost, 130 interrupted.
"""

from __future__ import annotations

import argparse
import math
import sys

import numpy as np

import pick_and_place as moving
import visum
from visum.trig import arc_tangent, sin_cos

# Lengths of models/six_axis_arm, m.
SHOULDER, UPPER_ARM, FOREARM = 0.1625, 0.425, 0.3922
ASIDE = 0.1333  # of the tool, from the plane in which the arm bends
WRIST, TOOL = 0.0997, 0.0996 + 0.1034  # ahead of the wrist's first axis, and below its second one

# Places of models/scenes/six_axis_arm.yaml, from the arm's foot, m.
CUBE = 0.05
CUBES = [(0.35, 0.3), (0.45, 0.3), (0.55, 0.3)]
GOAL = (0.45, -0.25)

LIFT = 0.12  # above where a cube is taken or put
OPENED = CUBE / 2 + 0.012  # position of each finger
CLOSED = CUBE / 2 - 0.002  # where they would go without the cube
GENTLE = 0.008  # m/s of a finger that closes


def angles_at(x: float, y: float, z: float) -> np.ndarray:
    """The joint angles for the point between the finger tips, with the fingers moving along y."""
    across = math.sqrt(x * x + y * y - ASIDE * ASIDE)
    turn = arc_tangent(y, x) - arc_tangent(ASIDE, across)
    reach, height = across - WRIST, z + TOOL - SHOULDER
    square = reach * reach + height * height
    cosine = (square - UPPER_ARM**2 - FOREARM**2) / (2 * UPPER_ARM * FOREARM)
    if not -1.0 < cosine < 1.0:
        raise moving.Failed(f"({x:.3f}, {y:.3f}, {z:.3f}) is out of reach")
    sine = math.sqrt(1.0 - cosine * cosine)
    elbow = arc_tangent(sine, cosine)
    shoulder = arc_tangent(reach, height) - arc_tangent(FOREARM * sine, UPPER_ARM + FOREARM * cosine)
    return np.array([turn, shoulder, elbow, math.pi / 2 - shoulder - elbow, -math.pi / 2, turn + math.pi / 2])


def line(x: float, y: float, low: float, high: float) -> list[np.ndarray]:
    """Joint angles straight down from `high` to `low`, every 5 mm."""
    steps = max(1, math.ceil((high - low) / 0.005))
    return [angles_at(x, y, high + i / steps * (low - high)) for i in range(steps + 1)]


class Arm(moving.Arm):
    """The ports of arm and gripper. The paths are those of pick_and_place.py."""

    def __init__(self, client: visum.Client, part: visum.Part, gripper: visum.Part) -> None:
        self.client, self.part, self.gripper = client, part, gripper
        self.desired, self.speed = part.inputs("Desired Angle"), part.inputs("Maximum Speed")
        self.state = part.outputs("Module State")
        self.fingers_desired, self.fingers_actual = gripper.inputs("Desired Position"), gripper.outputs("Actual Position")
        self.finger_speed, self.finger_speeds = gripper.inputs("Maximum Speed"), gripper.outputs("Actual Speed")
        self.ramp = np.array([part.parameter(f"Maximum Acceleration {i + 1}") for i in range(len(self.desired))])
        self.full_speed = np.array([port.initial for port in self.speed.ports])
        self.held_above: float | None = None  # finger position below which the cube is lost
        self.start_ns = client.time_ns

    def tick(self) -> None:
        self.part.write()
        self.gripper.write()
        self.client.advance_ns(round(moving.PERIOD_S * 1e9))
        for i, state in enumerate(self.state):
            if int(state) & moving.ERROR_BITS:
                raise moving.Failed(f"drive {i + 1} of the arm reports a fault (state {int(state):#x})")
        if self.held_above is not None and min(self.fingers_actual) < self.held_above:
            raise moving.Failed("the cube slipped out of the gripper")

    def grip(self, position: float, speed: float = 0.05) -> None:
        """Commands the fingers and waits until they stand."""
        self.fingers_desired.set([position] * len(self.fingers_desired))
        self.finger_speed.set([speed] * len(self.finger_speed))
        still = 0
        for _ in range(300):
            self.tick()
            still = still + 1 if max(map(abs, self.finger_speeds)) < 0.0005 else 0
            if still >= 10:
                return
        raise moving.Failed("the gripper does not come to rest")


def run(arm: Arm, start: np.ndarray, fast: float) -> None:
    slow, here = 0.4 * fast, start
    arm.grip(OPENED)
    for level, (x, y) in enumerate(CUBES):
        down = line(x, y, CUBE / 2, CUBE / 2 + LIFT)
        rest = CUBE * (level + 0.5) + 0.001
        put = line(*GOAL, rest, rest + LIFT)
        arm.say(f"fetches the cube at ({x:.2f}, {y:.2f})")
        arm.follow(moving.straight(here, down[0]), fast)
        arm.follow(down, slow)
        arm.grip(CLOSED, GENTLE)
        arm.held_above = CLOSED + 0.001
        if min(arm.fingers_actual) < arm.held_above:
            raise moving.Failed("the gripper closed on nothing: no cube is there")
        up = line(x, y, CUBE / 2, rest + LIFT)[::-1]
        arm.follow(up, slow)
        arm.say(f"puts it down at level {level + 1}")
        arm.follow(moving.straight(up[-1], put[0]), fast)
        arm.follow(put, slow)
        arm.held_above = None
        arm.grip(OPENED)
        arm.follow(put[::-1], slow)
        here = put[0]
    arm.follow(moving.straight(here, start), fast)
    arm.say("done: three cubes stand on each other")


def control(options: argparse.Namespace) -> None:
    with visum.Client(options.connect, name=options.name) as client:
        part, gripper = client.part("arm"), client.part("gripper")
        start = np.array(part.outputs("Actual Angle").values())
        with part.lease(), gripper.lease():
            client.join()
            run(Arm(client, part, gripper), start, options.speed)
            client.leave()


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--connect", default="127.0.0.1:1500", metavar="HOST:PORT")
    parser.add_argument("--name", default="six_axis_arm.py", help="shown to others as the owner of the lease")
    parser.add_argument("--speed", type=float, default=0.5, help="share of the drives' maximum speeds")
    options = parser.parse_args()
    try:
        return visum.exit_code_of("six_axis_arm.py", lambda: control(options))
    except moving.Failed as error:
        print(f"six_axis_arm.py: {error}", file=sys.stderr)
        return 1


if __name__ == "__main__":
    sys.exit(main())
