#!/usr/bin/python3
"""Explores a room with the cart: drives until it has been near all of the floor that it can reach, and touches nothing.

It knows only its ports. It reckons its place from the angles of the rear wheels. Its distance sensor casts rays all around, or
one ray from a mast that it turns (--neck). From both it draws a map (floor_map.py). It searches for the cheapest way to floor
that it has not been near, drives there, and looks again. It stands while it thinks.

    explorer.py --connect 127.0.0.1:1500 --time 300
"""

from __future__ import annotations

import argparse
import math
import sys
from collections import deque
from collections.abc import Callable
from contextlib import ExitStack

import numpy as np
import visum
from cart import Cart, Pose
from floor_map import CENTRE_AT, CIRCLE_RADIUS, CIRCLES_AT, FloorMap, Move, ahead, along, find_way
from visum.trig import arc_tangent, cosine, hypotenuse, sin_cos, sine

PERIOD_S = 0.05
CRUISE, ACCELERATION = 0.4, 0.6  # m/s, m/s2
STEPS_PER_LOOK = 4
STEERING_S = 0.4  # from one side to the other
LATERAL_GAIN, HEADING_GAIN = 16.0, 8.0  # 1/m2, 1/m: an error dies out, critically damped, within 0.5 m
MAXIMUM_CURVATURE = 1.3
STOP_SHORT = 0.1  # m ahead of where it would stand, that must be free
KEEP_AWAY = 0.03  # m, from what it did not expect
WAYS_OUT = (-0.3, 0.3, -0.15, 0.15)  # m, straight on: from where it finds no way, another place may have one


def let_pass(client: visum.Client, seconds: float, meanwhile: Callable[[], None]) -> None:
    client.begin_advance_ns(round(1e9 * seconds))
    meanwhile()
    client.finish_advance()


class Eye:
    """The distance sensor on the chassis: angles from straight ahead to the left, and distances."""

    settle_s = 0.5  # until it has seen all around

    def __init__(self, part: visum.Part, mounted_at: float) -> None:
        self._part, self._mounted_at = part, mounted_at
        ports = {port.name: port for port in part.output_ports}
        fan = ports["Nearest Angle"]
        self.reach = ports["Nearest Distance"].maximum
        self.look()
        self._see_along(np.linspace(fan.minimum, fan.maximum, len(self.distances)))

    def _see_along(self, angles: np.ndarray) -> None:
        self.angles, self._directions = angles, sin_cos(angles)

    def look(self) -> None:
        self.distances = np.frombuffer(self._part.read_blackboard("scan"), dtype="<f4").astype(float)

    def wait(self, client: visum.Client, seconds: float, meanwhile: Callable[[], None]) -> None:
        """Lets time pass, and looks. Calls `meanwhile` while the server is at work."""
        let_pass(client, seconds, meanwhile)
        self.look()

    def now_ns(self) -> int:
        self._part.read()
        return self._part.sample_time_ns

    def place(self, pose: Pose) -> tuple[float, float]:
        return ahead(pose, self._mounted_at)

    def points(self) -> np.ndarray:
        """The ends of the rays that met something, as rows of x and y in the cart's frame."""
        met = self.distances < self.reach - 0.05
        distances, (sin, cos) = self.distances[met], self._directions
        return np.column_stack((self._mounted_at + distances * cos[met], distances * sin[met]))


class TurningEye(Eye):
    """A distance sensor with one ray, on a mast that turns. Its scan holds the points of the last turn, seen from here."""

    RAY_S = 0.005
    SPEED = 12.0  # rad/s: a turn takes 0.52 s, 105 rays
    settle_s = 2.0  # until the mast turns at its speed, and a turn more

    def __init__(self, part: visum.Part, mounted_at: float, neck: visum.Part, cart: visum.Part) -> None:
        self._part, self._mounted_at, self._neck = part, mounted_at, neck
        self._distance, self._angle = part.outputs("Distance"), neck.outputs("Actual Angle")
        self.reach = {port.name: port for port in part.output_ports}["Distance"].maximum
        # Reckons by itself, so that no correction of the map moves what was met before
        self._way = Cart(cart)
        # The mast's angle, and the place that the ray met
        self._met: deque[tuple[float, float, float]] = deque()
        self.distances = np.empty(0)
        self._see_along(self.distances)

    def turn(self) -> None:
        self._neck.inputs("Desired Speed")[0] = self.SPEED
        self._neck.write()

    def wait(self, client: visum.Client, seconds: float, meanwhile: Callable[[], None]) -> None:
        for k in range(round(seconds / self.RAY_S)):
            let_pass(client, self.RAY_S, meanwhile if k == 0 else lambda: None)
            self._way.reckon()
            self._take_ray()
        self.look()

    def _take_ray(self) -> None:
        distance, turned = self._distance[0], self._angle[0]
        x, y = self.place(self._way.pose)
        direction = self._way.pose.heading + turned
        self._met.append((turned, x + distance * cosine(direction), y + distance * sine(direction)))
        while turned - self._met[0][0] > 2 * math.pi:
            self._met.popleft()

    def look(self) -> None:
        x, y = self.place(self._way.pose)
        met = np.array(self._met)
        if not len(met):
            return
        self.distances = hypotenuse(met[:, 1] - x, met[:, 2] - y)
        self._see_along(np.array([arc_tangent(b - y, a - x) for _, a, b in self._met]) - self._way.pose.heading)


def looks_at(step: int) -> bool:
    return step % STEPS_PER_LOOK == 1


class Explorer:
    def __init__(self, client: visum.Client, cart: Cart, eye: Eye, floor: FloorMap, end_ns: int) -> None:
        self._client, self._cart, self._eye, self._floor, self._end_ns = client, cart, eye, floor, end_ns
        self._steps = 0
        self._drawn = True  # what was seen last is on the map
        self.way = 0.0

    def out_of_time(self) -> bool:
        return self._client.time_ns >= self._end_ns

    def step(self, speed: float, curvature: float) -> None:
        """One period: commands the cart, draws the map while it moves, then reads the sensor and says where it is."""
        self._cart.command(speed, max(-MAXIMUM_CURVATURE, min(MAXIMUM_CURVATURE, curvature)))
        self._eye.wait(self._client, PERIOD_S, self.draw)
        self._cart.reckon()
        self.way += abs(speed) * PERIOD_S
        self._steps += 1
        if looks_at(self._steps):
            self._cart.pose = self._floor.align(self._cart.pose, self._eye.points())
        self._drawn = False

    def draw(self) -> None:
        """Puts onto the map what was seen last."""
        if self._drawn:
            return
        pose = self._cart.pose
        if looks_at(self._steps):
            self._floor.see(self._eye.place(pose), self._eye.angles + pose.heading, self._eye.distances, self._eye.reach)
        self._floor.cover(pose)
        if looks_at(self._steps + 1):
            self._floor.near_walls()
        self._drawn = True

    def stand(self, seconds: float, curvature: float = 0.0) -> None:
        for _ in range(round(seconds / PERIOD_S)):
            self.step(0.0, curvature)

    def explore(self) -> None:
        self.stand(self._eye.settle_s)
        untried = list(WAYS_OUT)
        while not self.out_of_time():
            self.draw()
            moves = find_way(self._floor, self._cart.pose)
            if moves:
                untried = list(WAYS_OUT)
            elif untried:
                moves = [Move(untried.pop(0), 0.0)]
            else:
                return
            self.catch_up()
            self.drive(moves)

    def catch_up(self) -> None:
        """Waits until the present: in real time, time has gone on while it was thinking. Under lockstep it has not."""
        now_ns = self._eye.now_ns()
        while self._client.time_ns < now_ns:
            self.step(0.0, 0.0)

    def drive(self, moves: list[Move]) -> None:
        """Drives along all moves, as far as the way is free, and then stands."""
        start = self._cart.pose
        for run in runs(moves):
            self.stand(STEERING_S, run[0].curvature)
            start, done = self.roll(start, run)
            self.stand(0.1, run[-1].curvature)
            if not done:
                return

    def roll(self, start: Pose, run: list[Move]) -> tuple[Pose, bool]:
        """Drives moves of one direction without a stop between them. Returns their end, and whether they were completed."""
        direction = math.copysign(1.0, run[0].way)
        length = sum(abs(move.way) for move in run)
        driven = speed = 0.0
        # If it stands nearer to something than it should, it may leave, but come no nearer.
        least = min(CIRCLE_RADIUS + KEEP_AWAY, room(self._eye.points(), [Pose()]))
        while driven < length and not self.out_of_time():
            braking = math.sqrt(2 * ACCELERATION * (length - driven))
            speed = max(0.02, min(speed + ACCELERATION * PERIOD_S, braking, CRUISE))
            if self.is_blocked(start, run, driven, speed, least):
                return start, False
            driven = min(driven + speed * PERIOD_S, length)
            wanted, curvature = on_run(start, run, driven)
            aside, turn, behind = errors(self._cart.pose, wanted)
            curvature += LATERAL_GAIN * aside + direction * HEADING_GAIN * turn
            self.step(direction * speed + 2.0 * behind, curvature)
        return on_run(start, run, length)[0], driven >= length

    def is_blocked(self, start: Pose, run: list[Move], driven: float, speed: float, least: float) -> bool:
        """True if the scan shows something nearer than `least` to where the cart will be before it can stop."""
        here, points = self._cart.pose, self._eye.points()
        to = driven + speed * speed / (2 * ACCELERATION) + STOP_SHORT
        poses = [seen_from(here, on_run(start, run, way)[0]) for way in np.arange(driven, to, 0.05).tolist()]
        return room(points, poses) < least


def seen_from(here: Pose, there: Pose) -> Pose:
    x, y = there.x - here.x, there.y - here.y
    sin, cos = sin_cos(here.heading)
    return Pose(x * cos + y * sin, y * cos - x * sin, there.heading - here.heading)


def room(points: np.ndarray, poses: list[Pose]) -> float:
    """The distance of the nearest point to the middle of one of the circles that cover the cart at any of the poses."""
    if not len(points):
        return math.inf
    circles = np.array([ahead(pose, way) for pose in poses for way in CIRCLES_AT])
    x, y = points[:, 0] - circles[:, :1], points[:, 1] - circles[:, 1:]
    return math.sqrt((x * x + y * y).min())


def runs(moves: list[Move]) -> list[list[Move]]:
    """Splits the moves into stretches of one direction."""
    stretches: list[list[Move]] = []
    for move in moves:
        if not stretches or stretches[-1][-1].way * move.way < 0:
            stretches.append([])
        stretches[-1].append(move)
    return stretches


def on_run(start: Pose, run: list[Move], driven: float) -> tuple[Pose, float]:
    """The pose after so much of a run, and the curvature there. Beyond its end, straight on."""
    for move in run:
        if driven < abs(move.way):
            return along(start, Move(math.copysign(driven, move.way), move.curvature)), move.curvature
        start, driven = along(start, move), driven - abs(move.way)
    return along(start, Move(math.copysign(driven, run[-1].way), 0.0)), run[-1].curvature


def errors(pose: Pose, wanted: Pose) -> tuple[float, float, float]:
    """The errors of a pose: to the left, in heading, and ahead."""
    x, y = wanted.x - pose.x, wanted.y - pose.y
    sin, cos = sin_cos(wanted.heading)
    return y * cos - x * sin, math.remainder(wanted.heading - pose.heading, 2 * math.pi), x * cos + y * sin


def parse_options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--connect", default="127.0.0.1:1500", metavar="HOST:PORT")
    parser.add_argument("--name", default="explorer.py", help="shown to others as the owner of the lease")
    parser.add_argument("--part", default="cart")
    parser.add_argument("--eye", default="eye", help="the distance sensor, a part of kind scanner")
    parser.add_argument("--neck", help="the part that turns the eye, which then is of kind distance")
    parser.add_argument("--time", type=float, default=300.0, help="simulated seconds that it has")
    parser.add_argument("--near", type=float, default=0.4, help="m from its middle, within which floor counts as covered")
    options = parser.parse_args()
    if not options.time > 0 or not 0.1 <= options.near <= 2:
        parser.error("the time must be more than 0, 'near' from 0.1 to 2 m")
    return options


def eye_of(client: visum.Client, cart: visum.Part, options: argparse.Namespace, leases: ExitStack) -> Eye:
    if not options.neck:
        return Eye(client.part(options.eye), CENTRE_AT)
    neck = client.part(options.neck)
    leases.enter_context(neck.lease())
    eye = TurningEye(client.part(options.eye), CENTRE_AT, neck, cart)
    eye.turn()
    return eye


def keep_memory() -> None:
    """Lets the C library keep up to 32 MB that are free, as it does once it has given back 16 MB at a time (M_MMAP_THRESHOLD in
    mallopt(3)). Else it gives back the map's memory after each scan, and getting it anew takes longer than the map itself."""
    np.empty(16 << 20, dtype=np.uint8)


def control(options: argparse.Namespace) -> None:
    keep_memory()
    with visum.Client(options.connect, name=options.name) as client:
        part = client.part(options.part)
        with ExitStack() as leases:
            leases.enter_context(part.lease())
            eye = eye_of(client, part, options, leases)
            client.join()
            floor = FloorMap(options.near)
            explorer = Explorer(client, Cart(part), eye, floor, client.time_ns + round(options.time * 1e9))
            explorer.explore()
            explorer.stand(0.5)
            client.leave()
        print(f"done: has driven {explorer.way:.1f} m")


if __name__ == "__main__":
    words = parse_options()
    sys.exit(visum.exit_code_of("explorer.py", lambda: control(words)))
