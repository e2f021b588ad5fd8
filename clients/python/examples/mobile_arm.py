#!/usr/bin/python3
"""Fetches a box from one table and puts it on another, with an arm on a base that drives.

It knows only ports: it reckons the base's place from the angles of the wheels, and sees how far away and how much turned the
front of a table is by the base's scanner. The arm grasps as pick_and_place.py does.

    mobile_arm.py --connect 127.0.0.1:1500
"""

from __future__ import annotations

import argparse
import math
import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np

import pick_and_place as grasping
import visum
from visum.trig import arc_tangent, cosine, sine

# Lengths of models/mobile_base and models/scenes/mobile_arm.yaml, m.
WHEEL_RADIUS, HALF_TRACK = 0.10, 0.26
SCANNER_AT = 0.50  # ahead of the axle
ARM_AT = 0.28
TABLE_TOP = 0.20  # above the arm's foot
FACE_AT = 1.60  # of either table: x of the first, y of the second, from the start
BOX, GOAL = (1.80, 0.15), (0.60, 1.80)
TURN_AT = 0.60  # x, where there is room to turn

STOP_BEFORE = 0.10  # from the scanner to the table
PERIOD_S = grasping.PERIOD_S
ACCELERATION, CRUISE = 0.3, 0.4  # m/s2, m/s
TURN_ACCELERATION, TURN_SPEED = 0.5, 0.6  # rad/s2, rad/s
FAN = 0.6  # rad: rays within it meet the table ahead
NEAR = 2.0  # m: and nothing farther away counts


class Pose(NamedTuple):
    """The pose of the middle of the axle, from where the base started."""

    x: float
    y: float
    heading: float

    def seen(self, place: tuple[float, float]) -> np.ndarray:
        """A place as the arm's foot sees it, on the table's top."""
        x, y = place[0] - self.x, place[1] - self.y
        s, c = sine(self.heading), cosine(self.heading)
        return np.array([c * x + s * y - ARM_AT, c * y - s * x, TABLE_TOP])


class Base:
    """The ports of the base: commands a speed and a turn, reckons the pose."""

    def __init__(self, part: visum.Part, scanner: visum.Part, arm: grasping.Arm) -> None:
        self._part, self._scanner, self._arm = part, scanner, arm
        self._speeds, self._angles = part.inputs("Desired Speed"), part.outputs("Actual Angle")
        fan = {port.name: port for port in scanner.output_ports}["Nearest Angle"]
        self._fan = (fan.minimum, fan.maximum)
        self._rolled = self._angles.values()
        self.pose = Pose(0.0, 0.0, 0.0)

    def go(self, speed: float, turn: float) -> None:
        """Commands it for one period, and reckons."""
        for wheel, side in enumerate((-1.0, 1.0)):
            self._speeds[wheel] = (speed + side * turn * HALF_TRACK) / WHEEL_RADIUS
        self._part.write()
        self._arm.tick()
        now = self._angles.values()
        left, right = (WHEEL_RADIUS * (b - a) for a, b in zip(self._rolled, now, strict=True))
        self._rolled = now
        way, turned = (left + right) / 2, (right - left) / (2 * HALF_TRACK)
        midway = self.pose.heading + turned / 2
        self.pose = Pose(self.pose.x + way * cosine(midway), self.pose.y + way * sine(midway),
                         self.pose.heading + turned)

    def stand(self, seconds: float) -> None:
        for _ in range(round(seconds / PERIOD_S)):
            self.go(0.0, 0.0)

    def table(self) -> tuple[float, float]:
        """Distance to the flat front of what stands ahead, and how far the base is turned to the left of it. By least squares."""
        distances = np.frombuffer(self._scanner.read_blackboard("scan"), dtype="<f4").astype(float)
        angles = np.linspace(*self._fan, len(distances))
        near = (np.abs(angles) < FAN) & (distances < NEAR)
        if near.sum() < 20:
            raise grasping.Failed("the scanner sees no table ahead")
        x, y = distances[near] * cosine(angles[near]), distances[near] * sine(angles[near])
        x_mean, y_mean = x.sum() / len(x), y.sum() / len(y)
        slope = ((x - x_mean) * (y - y_mean)).sum() / ((y - y_mean) ** 2).sum()
        turned = arc_tangent(slope, 1.0)
        return (x_mean - slope * y_mean) * cosine(turned), turned

    def drive(self, way: float) -> None:
        """Goes straight on, or back where `way` is negative, by the wheels."""
        start, side = self.pose, math.copysign(1.0, way)
        speed = 0.0
        for _ in range(6000):
            gone = side * ((self.pose.x - start.x) * cosine(start.heading) +
                           (self.pose.y - start.y) * sine(start.heading))
            left = abs(way) - gone
            if left < 0.002:
                return self.stand(0.5)
            speed = max(0.02, min(speed + ACCELERATION * PERIOD_S, CRUISE, math.sqrt(2 * ACCELERATION * left)))
            self.go(side * speed, 2.0 * (start.heading - self.pose.heading))
        raise grasping.Failed("the base does not arrive")

    def turn_to(self, heading: float) -> None:
        speed = 0.0
        for _ in range(6000):
            left = heading - self.pose.heading
            if abs(left) < 0.001:
                return self.stand(0.5)
            speed = max(0.01, min(speed + TURN_ACCELERATION * PERIOD_S, TURN_SPEED,
                                  math.sqrt(2 * TURN_ACCELERATION * abs(left))))
            self.go(0.0, math.copysign(speed, left))
        raise grasping.Failed("the base does not turn")

    def approach(self) -> tuple[float, float]:
        """Goes up to the table ahead. Returns what it then sees of it, the mean of ten scans."""
        speed = 0.0
        for _ in range(6000):
            distance, turned = self.table()
            left = distance - STOP_BEFORE
            if left < 0.003:
                break
            speed = max(0.02, min(speed + ACCELERATION * PERIOD_S, CRUISE, math.sqrt(2 * ACCELERATION * left)))
            self.go(speed, max(-0.2, min(0.2, -1.0 * turned)))
        else:
            raise grasping.Failed("the base does not reach the table")
        self.stand(0.5)
        seen = []
        for _ in range(10):
            self.stand(0.05)  # a new scan
            seen.append(self.table())
        return sum(d for d, _ in seen) / 10, sum(t for _, t in seen) / 10


class Grip(NamedTuple):
    """A way to hold the box, and the arm's way to it."""

    kind: tuple[float, float]  # tilt and side
    there: list[grasping.Path_]
    down: grasping.Path_


def plan(chain: grasping.Chain, place: np.ndarray, kinds: list[tuple[float, float]], start: np.ndarray,
         options: argparse.Namespace) -> Grip:
    """The first of these ways to hold the box that the arm can reach from where it stands."""
    low = place[2] + options.height / 2 + 0.03
    for kind in kinds:
        for down in grasping.ways_down(chain, place, kind, options, start):
            there = grasping.through_the_air(chain, start, down[0], start, place[2], low)
            if there:
                return Grip(kind, there, down)
    raise grasping.Failed(f"({place[0]:.3f}, {place[1]:.3f}) before the arm is out of reach")


class Job:
    def __init__(self, chain: grasping.Chain, arm: grasping.Arm, base: Base, options: argparse.Namespace) -> None:
        self.chain, self.arm, self.base, self.options = chain, arm, base, options
        self.start = np.array(arm.actual.values())
        self.opened = options.width / 2 + 0.010

    def reach(self, grip: Grip) -> None:
        for leg in grip.there:
            self.arm.follow(leg, self.options.speed)
        self.arm.follow(grip.down, 0.4 * self.options.speed)

    def draw_back(self, grip: Grip) -> None:
        self.arm.follow(grip.down[::-1], 0.4 * self.options.speed)
        for leg in grip.there[::-1]:
            self.arm.follow(leg[::-1], self.options.speed)

    def fetch(self) -> tuple[float, float]:
        kinds = [(math.radians(tilt), side) for tilt in (90, 75, 60, 45, 30) for side in (1, -1)]
        place = self.base.pose.seen(BOX)
        self.options.yaw = -self.base.pose.heading
        grip = plan(self.chain, place, kinds, self.start, self.options)
        self.arm.say(f"grasps the box at ({place[0]:.3f}, {place[1]:.3f}) before the arm")
        self.arm.fingers(self.opened, self.arm.finger_speed.ports[0].initial)
        self.reach(grip)
        closed = max(0.0, self.options.width / 2 - 0.0012)
        self.arm.fingers(closed, 0.012)
        self.arm.held_above = closed + 0.0005
        if min(self.arm.actual_finger) < self.arm.held_above:
            raise grasping.Failed("the gripper closed on nothing: no box is there")
        self.draw_back(grip)
        return grip.kind

    def put(self, kind: tuple[float, float]) -> None:
        place = self.base.pose.seen(GOAL)
        self.options.yaw = math.pi / 2 - self.base.pose.heading
        grip = plan(self.chain, place + [0, 0, 0.001], [kind], self.start, self.options)
        self.arm.say(f"puts the box down at ({place[0]:.3f}, {place[1]:.3f}) before the arm")
        self.reach(grip)
        self.arm.held_above = None
        self.arm.fingers(self.opened, self.arm.finger_speed.ports[0].initial)
        self.draw_back(grip)

    def run(self) -> None:
        self.base.stand(0.5)
        self.arm.say("drives to the table")
        distance, turned = self.base.approach()
        self.base.pose = Pose(FACE_AT - (SCANNER_AT * cosine(turned) + distance), self.base.pose.y, turned)
        kind = self.fetch()
        self.arm.say("drives back with the box, and turns")
        self.base.drive(TURN_AT - self.base.pose.x)
        self.base.turn_to(math.pi / 2)
        self.arm.say("drives to the second table")
        distance, turned = self.base.approach()
        self.base.pose = Pose(self.base.pose.x, FACE_AT - (SCANNER_AT * cosine(turned) + distance),
                              math.pi / 2 + turned)
        self.put(kind)
        self.arm.say("drives back")
        self.base.drive(-0.4)
        self.arm.say("done")


def parse_options() -> argparse.Namespace:
    urdf = next((folder / models / "amtec_arm" / "amtec_arm.urdf" for folder in Path(__file__).resolve().parents
                 for models in ("models", "share/visum/models") if (folder / models).is_dir()), None)
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--connect", default="127.0.0.1:1500", metavar="HOST:PORT")
    parser.add_argument("--name", default="mobile_arm.py", help="shown to others as the owner of the leases")
    parser.add_argument("--arm", default="arm")
    parser.add_argument("--base", default="base")
    parser.add_argument("--urdf", type=Path, default=urdf, required=urdf is None)
    parser.add_argument("--width", type=float, default=0.04, help="of the box [m]")
    parser.add_argument("--height", type=float, default=0.08, help="of the box [m]")
    parser.add_argument("--lift", type=float, default=0.12, help="how high to lift it [m]")
    parser.add_argument("--speed", type=float, default=0.9, help="share of the arm's maximum speeds")
    return parser.parse_args()


def control(options: argparse.Namespace) -> None:
    chain = grasping.Chain(options.urdf)
    with visum.Client(options.connect, name=options.name) as client:
        arm_part, base_part = client.part(options.arm), client.part(options.base)
        scanner = client.part(options.base + "_scanner")
        with arm_part.lease(), base_part.lease():
            client.join()
            arm = grasping.Arm(client, arm_part)
            Job(chain, arm, Base(base_part, scanner, arm), options).run()
            client.leave()


def main() -> int:
    options = parse_options()
    try:
        return visum.exit_code_of("mobile_arm.py", lambda: control(options))
    except (grasping.Failed, OSError) as error:
        print(f"mobile_arm.py: {error}", file=sys.stderr)
        return 1


if __name__ == "__main__":
    sys.exit(main())
