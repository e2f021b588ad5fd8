#!/usr/bin/python3
"""Drives the cart along a figure of eight: a circle to the left, then one to the right, back to where it started.

It knows only its ports. It reckons its place from the angles of the rear wheels (odometry), and steers back to the figure.
Every 10 ms it commands the speed of each wheel, and the angle of each steered wheel, so that all of them roll about the same
centre (Ackermann).

    cart.py --connect 127.0.0.1:1500 --radius 0.9 --speed 0.6
"""

from __future__ import annotations

import argparse
import math
import sys
from typing import NamedTuple

import visum
from visum.trig import arc_tangent, hypotenuse, sin_cos

# Lengths of models/cart/cart.urdf, m. x counts from the rear axle.
WHEEL_RADIUS = 0.08
WHEELBASE = 0.36
HALF_TRACK = 0.18
WHEELS = ((0.0, HALF_TRACK), (0.0, -HALF_TRACK), (WHEELBASE, HALF_TRACK), (WHEELBASE, -HALF_TRACK))
MAXIMUM_CURVATURE = 1.3  # 1/m: the inner front wheel at 0.55 rad

PERIOD_S = 0.01
ACCELERATION = 0.6  # m/s2, along the figure
STEER_S = 0.5  # to turn the wheels on the spot


class Pose(NamedTuple):
    """The pose of the middle of the rear axle, from the place and heading of the start."""

    x: float = 0.0
    y: float = 0.0
    heading: float = 0.0

    def moved(self, left: float, right: float) -> Pose:
        """After the rear wheels have rolled so far: an arc, with the heading midway along it."""
        way, turn = (left + right) / 2, (right - left) / (2 * HALF_TRACK)
        s, c = sin_cos(self.heading + turn / 2)
        return Pose(self.x + way * c, self.y + way * s, self.heading + turn)

    def seen_from(self, other: Pose) -> tuple[float, float]:
        """How far this pose is ahead of the other one, and to its left, along and across this pose's heading."""
        x, y = self.x - other.x, self.y - other.y
        s, c = sin_cos(self.heading)
        return x * c + y * s, y * c - x * s


class Circle(NamedTuple):
    """A circle from the start back to it, to the left (side 1) or to the right (-1)."""

    radius: float
    side: int

    @property
    def length(self) -> float:
        return 2 * math.pi * self.radius

    @property
    def curvature(self) -> float:
        return self.side / self.radius

    def pose(self, way: float) -> Pose:
        turned = way / self.radius
        s, c = sin_cos(turned)
        return Pose(self.radius * s, self.side * self.radius * (1 - c), self.side * turned)


class Cart:
    """The cart's ports as one speed and one curvature, and its odometry."""

    def __init__(self, part: visum.Part) -> None:
        self._part = part
        self._speeds, self._angles = part.inputs("Desired Speed"), part.inputs("Desired Angle")
        self._actual = part.outputs("Actual Angle")
        self._rolled = self._actual.values()[:2]
        self.pose = Pose()

    def command(self, speed: float, curvature: float) -> None:
        for wheel, (x, y) in enumerate(WHEELS):
            ahead, aside = 1 - curvature * y, curvature * x
            self._speeds[wheel] = speed * hypotenuse(ahead, aside) / WHEEL_RADIUS
            if x > 0:
                self._angles[wheel - 2] = arc_tangent(aside, ahead)
        self._part.write()

    def reckon(self) -> None:
        """Brings the pose up to what the wheels have rolled since the last call."""
        now = self._actual.values()[:2]
        self.pose = self.pose.moved(*(WHEEL_RADIUS * (b - a) for a, b in zip(self._rolled, now, strict=True)))
        self._rolled = now


def correction(aside: float, turn: float) -> float:
    """The curvature that leads back onto the figure, which is `aside` to the left (m) and turned by `turn` (rad).

    A lateral error dies out, critically damped, within 0.5 m.
    """
    return 16.0 * aside + 8.0 * math.remainder(turn, 2 * math.pi)


def drive(client: visum.Client, cart: Cart, circle: Circle, cruise: float) -> None:
    """Steers first and then goes: wheels that are still on their way to an angle would slip."""
    cart.command(0.0, circle.curvature)
    client.advance_ms(1000 * STEER_S)
    way = speed = 0.0
    while way < circle.length:
        brake = math.sqrt(2 * ACCELERATION * (circle.length - way))
        speed = max(0.02, min(speed + ACCELERATION * PERIOD_S, brake, cruise))
        way = min(way + speed * PERIOD_S, circle.length)
        wanted = circle.pose(way)
        ahead, aside = wanted.seen_from(cart.pose)
        curvature = circle.curvature + correction(aside, wanted.heading - cart.pose.heading)
        cart.command(speed + 2.0 * ahead, max(-MAXIMUM_CURVATURE, min(MAXIMUM_CURVATURE, curvature)))
        client.advance_ms(1000 * PERIOD_S)
        cart.reckon()
    cart.command(0.0, 0.0)
    client.advance_ms(1000 * STEER_S)
    cart.reckon()


def parse_options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--connect", default="127.0.0.1:1500", metavar="HOST:PORT")
    parser.add_argument("--name", default="cart.py", help="shown to others as the owner of the lease")
    parser.add_argument("--part", default="cart")
    parser.add_argument("--radius", type=float, default=0.9, help="of each circle, 0.85 to 10 m")
    parser.add_argument("--speed", type=float, default=0.6, help="0.1 to 0.8 m/s")
    options = parser.parse_args()
    if not 0.85 <= options.radius <= 10 or not 0.1 <= options.speed <= 0.8:
        parser.error("the radius must be from 0.85 to 10 m, the speed from 0.1 to 0.8 m/s")
    return options


def control(options: argparse.Namespace) -> None:
    with visum.Client(options.connect, name=options.name) as client:
        part = client.part(options.part)
        with part.lease():
            client.join()
            cart = Cart(part)
            for side in (1, -1):
                drive(client, cart, Circle(options.radius, side), options.speed)
            client.leave()
        print(f"done: reckons to be {hypotenuse(cart.pose.x, cart.pose.y):.3f} m from where it started")


if __name__ == "__main__":
    words = parse_options()
    sys.exit(visum.exit_code_of("cart.py", lambda: control(words)))
