#!/usr/bin/python3
"""Lets the crawler pull itself forward: stretch the arm, press its tip on the floor, flex, lift, and again.

It knows the arm's lengths and its ports, and commands the three angles every 10 ms along straight ways of the tip.

    crawler.py --connect 127.0.0.1:1500 --strokes 6
"""

from __future__ import annotations

import argparse
import math
import sys
from typing import NamedTuple

import visum

# Lengths of models/crawler/crawler.urdf, m.
UPPER_ARM, FOREARM, HAND = 0.16, 0.16, 0.10
FLOOR = 0.015 - 0.105  # the tip's axis when it touches, below the shoulder
HAND_ANGLE = 2.6  # from straight up, forward: nearly down

PERIOD_S = 0.01
SPEED = 0.15  # of the tip, m/s


class Point(NamedTuple):
    """The place of the tip's axis, from the shoulder: forward and up, m."""

    x: float
    z: float


LIFTED, PRESSED = FLOOR + 0.05, FLOOR - 0.015
STRETCHED, FLEXED = 0.29, 0.13
STROKE = (Point(STRETCHED, LIFTED), Point(STRETCHED, PRESSED), Point(FLEXED, PRESSED), Point(FLEXED, LIFTED))


def angles_at(tip: Point) -> tuple[float, float, float]:
    """The angles of shoulder, elbow and wrist, with the elbow up and the hand at its constant angle."""
    x, z = tip.x - HAND * math.sin(HAND_ANGLE), tip.z - HAND * math.cos(HAND_ANGLE)
    cosine = (x * x + z * z - UPPER_ARM**2 - FOREARM**2) / (2 * UPPER_ARM * FOREARM)
    elbow = math.acos(cosine)
    shoulder = math.atan2(x, z) - math.atan2(FOREARM * math.sin(elbow), UPPER_ARM + FOREARM * cosine)
    return shoulder, elbow, HAND_ANGLE - shoulder - elbow


class Arm:
    """Commands the crawler's ports by the place of the tip."""

    def __init__(self, client: visum.Client, part: visum.Part) -> None:
        self._client, self._part = client, part
        self._desired, self._actual = part.inputs("Desired Angle"), part.outputs("Actual Angle")

    def _command(self, angles: list[float]) -> None:
        for joint, angle in enumerate(angles):
            self._desired[joint] = angle
        self._part.write()
        self._client.advance_ms(1000 * PERIOD_S)

    def take_up(self, angles: tuple[float, float, float], seconds: float = 1.0) -> None:
        """Moves there joint by joint, from any posture."""
        start, steps = self._actual.values(), round(seconds / PERIOD_S)
        for step in range(1, steps + 1):
            self._command([a + (b - a) * step / steps for a, b in zip(start, angles, strict=True)])

    def move(self, start: Point, end: Point) -> None:
        steps = max(1, math.ceil(math.dist(start, end) / (SPEED * PERIOD_S)))
        for step in range(1, steps + 1):
            share = step / steps
            self._command(list(angles_at(Point(start.x + (end.x - start.x) * share,
                                               start.z + (end.z - start.z) * share))))


def crawl(arm: Arm, strokes: int) -> None:
    rest = STROKE[-1]
    arm.take_up(angles_at(rest))
    for _ in range(strokes):
        for start, end in zip((rest, *STROKE), STROKE):
            arm.move(start, end)


def parse_options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--connect", default="127.0.0.1:1500", metavar="HOST:PORT")
    parser.add_argument("--name", default="crawler.py", help="shown to others as the owner of the lease")
    parser.add_argument("--part", default="crawler")
    parser.add_argument("--strokes", type=int, default=6, help="1 to 1000")
    options = parser.parse_args()
    if not 1 <= options.strokes <= 1000:
        parser.error("there must be 1 to 1000 strokes")
    return options


def control(options: argparse.Namespace) -> None:
    with visum.Client(options.connect, name=options.name) as client:
        part = client.part(options.part)
        with part.lease():
            client.join()
            crawl(Arm(client, part), options.strokes)
            client.leave()
    print(f"done: {options.strokes} strokes")


if __name__ == "__main__":
    words = parse_options()
    sys.exit(visum.exit_code_of("crawler.py", lambda: control(words)))
