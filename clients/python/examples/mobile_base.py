#!/usr/bin/python3
"""Drives the base between obstacles to a goal, and touches nothing.

It knows only its ports: it reckons its place from the angles of the wheels, and sees obstacles by its scanner. Ten times a second
it tries a fan of arcs and takes the best of those that keep clear of all that it saw (the dynamic window approach of Fox, Burgard
and Thrun, 1997). It plans no way: a dead end holds it until its time is over, and then it fails.

    mobile_base.py --connect 127.0.0.1:1500 --goal 7,0
"""

from __future__ import annotations

import argparse
import math
import sys
from collections import deque
from typing import NamedTuple

import numpy as np
import visum
from visum.trig import arc_tangent, cosine, hypotenuse, sine

# Lengths of models/mobile_base, m. x counts from the axle.
WHEEL_RADIUS, HALF_TRACK = 0.10, 0.26
SCANNER_AT = 0.50
CIRCLES_AT, CIRCLE_RADIUS = (-0.02, 0.14, 0.30), 0.31  # circles that cover the base

PERIOD_S = 0.1
ACCELERATION, CRUISE = 0.4, 0.5  # m/s2, m/s
TURN_ACCELERATION, TURN_SPEED = 1.0, 0.8  # rad/s2, rad/s
TURNS = tuple(TURN_SPEED * k / 8 for k in range(-8, 9))  # of the arcs that it tries, rad/s
AHEAD_S, LOOKS = 2.0, 8  # how far an arc is looked along, and at how many places
KEEP_AWAY, WIDE = 0.06, 0.35  # m: never nearer than this, and rather as far as that
WIDE_WEIGHT, TURN_WEIGHT = 2.0, 0.4
SCANS = 30  # that it remembers: an obstacle beside it is outside the fan
ARRIVED = 0.05  # m


class Failed(Exception):
    """The base did not reach its goal."""


class Pose(NamedTuple):
    """The pose of the middle of the axle, from where the base started."""

    x: float = 0.0
    y: float = 0.0
    heading: float = 0.0

    def along(self, way: float, turn: float) -> Pose:
        """After an arc of this length, over which it turns by so much."""
        midway = self.heading + turn / 2
        return Pose(self.x + way * cosine(midway), self.y + way * sine(midway), self.heading + turn)

    def ahead(self, way: float) -> np.ndarray:
        return np.array([self.x + way * cosine(self.heading), self.y + way * sine(self.heading)])


class Base:
    """The ports of the base: commands a speed and a turn, reckons the pose, remembers what the scanner met."""

    def __init__(self, client: visum.Client, part: visum.Part, scanner: visum.Part) -> None:
        self._client, self._part, self._scanner = client, part, scanner
        self._speeds, self._angles = part.inputs("Desired Speed"), part.outputs("Actual Angle")
        ports = {port.name: port for port in scanner.output_ports}
        self._fan = (ports["Nearest Angle"].minimum, ports["Nearest Angle"].maximum)
        self._reach = ports["Nearest Distance"].maximum
        self._rolled = self._angles.values()
        self._scans: deque[np.ndarray] = deque(maxlen=SCANS)
        self.pose = Pose()
        self.speed = self.turn = 0.0

    def go(self, speed: float, turn: float) -> None:
        """Commands it for one period, within its accelerations. Then reckons and looks."""
        self.speed = towards(self.speed, speed, ACCELERATION * PERIOD_S)
        self.turn = towards(self.turn, turn, TURN_ACCELERATION * PERIOD_S)
        for wheel, side in enumerate((-1.0, 1.0)):
            self._speeds[wheel] = (self.speed + side * self.turn * HALF_TRACK) / WHEEL_RADIUS
        self._part.write()
        self._client.advance_ns(round(PERIOD_S * 1e9))
        now = self._angles.values()
        left, right = (WHEEL_RADIUS * (b - a) for a, b in zip(self._rolled, now, strict=True))
        self._rolled = now
        self.pose = self.pose.along((left + right) / 2, (right - left) / (2 * HALF_TRACK))
        self._look()

    def _look(self) -> None:
        distances = np.frombuffer(self._scanner.read_blackboard("scan"), dtype="<f4").astype(float)
        angles = np.linspace(*self._fan, len(distances)) + self.pose.heading
        met = distances < self._reach - 0.05
        self._scans.append(self.pose.ahead(SCANNER_AT) + np.column_stack(
            (distances[met] * cosine(angles[met]), distances[met] * sine(angles[met]))))

    def near(self, within: float) -> np.ndarray:
        """All places that a ray met lately, not farther away than this."""
        points = np.concatenate(self._scans)
        return points[((points - self.pose.ahead(0.0)) ** 2).sum(axis=1) < within * within]


def towards(now: float, wanted: float, step: float) -> float:
    return max(now - step, min(now + step, wanted))


def room(points: np.ndarray, pose: Pose) -> float:
    """The distance from the base at `pose` to the nearest point. Less than 0: it is in the base."""
    if not len(points):
        return math.inf
    return math.sqrt(min(((points - pose.ahead(at)) ** 2).sum(axis=1).min() for at in CIRCLES_AT)) - CIRCLE_RADIUS


def room_along(points: np.ndarray, pose: Pose, speed: float, turn: float) -> tuple[float, Pose]:
    """The least room on an arc, and its end."""
    least = math.inf
    for _ in range(LOOKS):
        pose = pose.along(speed * AHEAD_S / LOOKS, turn * AHEAD_S / LOOKS)
        least = min(least, room(points, pose))
    return least, pose


def best_arc(points: np.ndarray, pose: Pose, goal: tuple[float, float], cruise: float) -> tuple[float, float]:
    """The speed and the turn of the cheapest arc that keeps clear. Where no arc does: a turn on the spot that does, or rest."""
    best, choice = math.inf, (0.0, 0.0)
    for share in (1.0, 0.5, 0.0):
        for turn in TURNS:
            least, end = room_along(points, pose, share * cruise, turn)
            if least < KEEP_AWAY:
                continue
            left_x, left_y = goal[0] - end.x, goal[1] - end.y
            off = abs(math.remainder(arc_tangent(left_y, left_x) - end.heading, 2 * math.pi))
            cost = hypotenuse(left_x, left_y) + TURN_WEIGHT * off + WIDE_WEIGHT * max(0.0, WIDE - least)
            if cost < best:
                best, choice = cost, (share * cruise, turn)
    return choice


def drive(base: Base, goal: tuple[float, float], periods: int) -> None:
    for _ in range(periods):
        left = hypotenuse(goal[0] - base.pose.x, goal[1] - base.pose.y)
        if left < ARRIVED:
            break
        if left < 0.6:  # the last stretch: straight to it, as no arc of AHEAD_S ends so near
            off = math.remainder(arc_tangent(goal[1] - base.pose.y, goal[0] - base.pose.x) - base.pose.heading, 2 * math.pi)
            base.go(min(CRUISE, 0.5 * left) if abs(off) < 0.5 else 0.0, max(-TURN_SPEED, min(TURN_SPEED, 1.5 * off)))
        else:
            base.go(*best_arc(base.near(3.0), base.pose, goal, CRUISE))
    else:
        raise Failed(f"did not reach the goal: {left:.2f} m are left")
    for _ in range(20):
        base.go(0.0, 0.0)


def place(text: str) -> tuple[float, float]:
    x, y = (float(word) for word in text.split(","))
    if not (math.isfinite(x) and math.isfinite(y)):
        raise ValueError
    return x, y


def parse_options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--connect", default="127.0.0.1:1500", metavar="HOST:PORT")
    parser.add_argument("--name", default="mobile_base.py", help="shown to others as the owner of the lease")
    parser.add_argument("--base", default="base", help="the part; its scanner is BASE_scanner")
    parser.add_argument("--goal", type=place, default=(7.0, 0.0), metavar="X,Y", help="from where it stands, m")
    parser.add_argument("--time", type=float, default=60.0, help="simulated seconds that it has")
    options = parser.parse_args()
    if not 1 <= options.time <= 3600:
        parser.error("the time must be from 1 to 3600 s")
    return options


def control(options: argparse.Namespace) -> None:
    with visum.Client(options.connect, name=options.name) as client:
        part, scanner = client.part(options.base), client.part(options.base + "_scanner")
        with part.lease():
            client.join()
            base = Base(client, part, scanner)
            base.go(0.0, 0.0)  # the first scan comes within it
            drive(base, options.goal, round(options.time / PERIOD_S))
            client.leave()
        print(f"done: stands at ({base.pose.x:.3f}, {base.pose.y:.3f})")


def main() -> int:
    options = parse_options()
    try:
        return visum.exit_code_of("mobile_base.py", lambda: control(options))
    except Failed as error:
        print(f"mobile_base.py: {error}", file=sys.stderr)
        return 1


if __name__ == "__main__":
    sys.exit(main())
