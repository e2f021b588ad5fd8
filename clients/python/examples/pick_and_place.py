#!/usr/bin/python3
"""Picks a box up and puts it down elsewhere, with an arm that is served as a hardware part.

The same job as visum-pick-and-place, in Python: it reads the arm's URDF, does its own inverse kinematics, and commands
the arm through its ports every 10 ms. It uses nothing but ports.

    PYTHONPATH=build/release/python clients/python/examples/pick_and_place.py --connect 127.0.0.1:1500 \\
        --from 0.5,0.2 --to 0.5,-0.2

Exit codes: 0 done, 1 not possible or failed, 2 bad usage, 4 connection lost, 130 interrupted.
"""

from __future__ import annotations

import argparse
import math
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import NamedTuple

import numpy as np

import visum
from visum.trig import arc_tangent, cosine, sin_cos, sine

PERIOD_S = 0.01
LIMIT_MARGIN = 0.06  # rad, kept from every joint's stops
ERROR_BITS = 0x1 | 0x4  # of the PowerCube state word: a fault, or halted

Vector = np.ndarray
Path_ = list[np.ndarray]  # joint angles to pass


class Failed(Exception):
    """The job is impossible, or went wrong."""


# Kinematics ------------------------------------------------------------------------------------------


# Equal runs shall have equal bits on every machine. So sums of products are taken here in a fixed order.
# Behind numpy's `@`, norm and solve stands a BLAS library, whose order depends on the processor.


def product(A: np.ndarray, b: np.ndarray) -> np.ndarray:
    """The matrix times a matrix or a vector."""
    return (A * b).sum(axis=1) if b.ndim == 1 else (A[:, :, None] * b[None, :, :]).sum(axis=1)


def length(v: Vector) -> float:
    return math.sqrt((v * v).sum())


def solution(A: np.ndarray, b: Vector) -> Vector:
    """The x of A x = b, for a positive definite A (elimination without pivots)."""
    rows = np.column_stack([A, b])
    for i in range(len(b)):
        rows[i] /= rows[i, i]
        others = np.arange(len(b)) != i
        rows[others] -= rows[others, i, None] * rows[i]
    return rows[:, -1]


def rotation(axis: Vector, angle: float) -> np.ndarray:
    """The rotation about a unit axis (Rodrigues)."""
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + sine(angle) * cross + (1 - cosine(angle)) * product(cross, cross)


def rotation_vector(R: np.ndarray) -> Vector:
    """The rotation vector (axis times angle), for angles below pi."""
    w = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]]) / 2
    sin = length(w)
    return w if sin < 1e-12 else w / sin * arc_tangent(sin, (np.trace(R) - 1) / 2)


class Joint(NamedTuple):
    """A turning joint: its frame in that of the joint before it, its axis and its limits."""

    rotation: np.ndarray
    offset: Vector
    axis: Vector
    lower: float
    upper: float


class Chain:
    """The arm from its base to the tool, which is midway between the fingers' pads; z reaches, y closes."""

    def __init__(self, urdf: Path) -> None:
        joints = {j.find("child").get("link"): j for j in ElementTree.parse(urdf).getroot().findall("joint")}
        fingers = sorted((j for j in joints.values() if j.get("type") == "prismatic"), key=lambda j: j.get("name"))
        if not fingers:
            raise Failed(f"{urdf}: has no fingers (prismatic joints)")
        self.finger_upper = float(fingers[0].find("limit").get("upper"))
        offsets = [_origin(finger)[1] for finger in fingers]
        path, link = [], fingers[0].find("parent").get("link")
        while link in joints:
            path.append(joints[link])
            link = joints[link].find("parent").get("link")
        self.joints: list[Joint] = []
        R, p = np.eye(3), np.zeros(3)
        for joint in reversed(path):
            R_joint, p_joint = _origin(joint)
            R, p = product(R, R_joint), p + product(R, p_joint)
            if joint.get("type") == "fixed":
                continue
            limit = joint.find("limit")
            self.joints.append(Joint(R, p, _numbers(joint.find("axis"), "xyz"), float(limit.get("lower")),
                                     float(limit.get("upper"))))
            R, p = np.eye(3), np.zeros(3)
        self.tool_rotation, self.tool_offset = R, p + product(R, np.mean(offsets, axis=0))
        self.lower = np.array([j.lower for j in self.joints]) + LIMIT_MARGIN
        self.upper = np.array([j.upper for j in self.joints]) - LIMIT_MARGIN

    def motion(self, angles: Vector) -> tuple[np.ndarray, Vector, np.ndarray, list[Vector]]:
        """The tool's rotation and place, its Jacobian (rows: velocity, angular velocity), the joints' origins."""
        R, p = np.eye(3), np.zeros(3)
        axes, origins = [], []
        for joint, angle in zip(self.joints, angles):
            p = p + product(R, joint.offset)
            R = product(product(R, joint.rotation), rotation(joint.axis, angle))
            axes.append(product(R, joint.axis))
            origins.append(p)
        p = p + product(R, self.tool_offset)
        columns = [np.concatenate([np.cross(a, p - o), a]) for a, o in zip(axes, origins)]
        return product(R, self.tool_rotation), p, np.array(columns).T, origins


def _numbers(element: ElementTree.Element | None, key: str) -> Vector:
    text = element.get(key) if element is not None else None
    return np.array([float(word) for word in text.split()]) if text else np.zeros(3)


def _origin(joint: ElementTree.Element) -> tuple[np.ndarray, Vector]:
    origin = joint.find("origin")
    roll, pitch, yaw = _numbers(origin, "rpy")
    x, y, z = np.eye(3)
    return product(product(rotation(z, yaw), rotation(y, pitch)), rotation(x, roll)), _numbers(origin, "xyz")


def solve(chain: Chain, R: np.ndarray, p: Vector, seed: Vector, rest: Vector) -> Vector | None:
    """Inverse kinematics by damped least squares; the free joints are drawn to `rest`. None: not reached from this seed."""
    angles, checked = np.clip(seed, chain.lower, chain.upper), math.inf
    for i in range(150):
        R_now, p_now, J, _ = chain.motion(angles)
        error = np.concatenate([p - p_now, rotation_vector(product(R, R_now.T))])
        if length(error[:3]) < 1e-5 and length(error[3:]) < 1e-4:
            return angles
        size = length(error)
        if i % 12 == 0:
            if size > 0.7 * checked:
                return None
            checked = size
        wish = min(1.0, 10 * size) * 0.05 * (rest - angles)
        damped = product(J, J.T) + (1e-9 + 1e-2 * size**2) * np.eye(6)
        step = product(J.T, solution(damped, error - product(J, wish))) + wish
        step *= min(1.0, 0.25 / np.max(np.abs(step)))
        angles = np.clip(angles + step, chain.lower, chain.upper)
    return None


def follow_line(chain: Chain, start: Vector, p_end: Vector, rest: Vector) -> Path_ | None:
    """Joint angles for a straight line of the tool, every 5 mm, without a turn. None if they would have to jump."""
    R, p_start, _, _ = chain.motion(start)
    steps = max(1, math.ceil(length(p_end - p_start) / 0.005))
    line = [start]
    for i in range(1, steps + 1):
        angles = solve(chain, R, p_start + i / steps * (p_end - p_start), line[-1], rest)
        if angles is None or np.max(np.abs(angles - line[-1])) > 0.2:
            return None
        line.append(angles)
    return line


# The plan --------------------------------------------------------------------------------------------


def orientation(tilt: float, azimuth: float, side: float) -> np.ndarray:
    """The tool's rotation when the gripper points down by `tilt`, towards `azimuth`. `side` -1 swaps the fingers."""
    s, c = sin_cos(azimuth)
    z = np.array([c * cosine(tilt), s * cosine(tilt), -sine(tilt)])
    y = side * np.array([-s, c, 0.0])
    return np.column_stack([np.cross(y, z), y, z])


def is_clear(chain: Chain, path: Path_, surface: float, least_tool_z: float) -> bool:
    """True if a path stays dexterous, the tool above `least_tool_z`, and the joints from the elbow on above the surface."""
    for angles in path:
        _, p, J, origins = chain.motion(angles)
        if p[2] < least_tool_z or any(o[2] < surface + 0.07 for o in origins[3:]):
            return False
        if np.linalg.svd(J, compute_uv=False)[-1] < 0.04:
            return False
    return True


def ways_down(chain: Chain, place: Vector, grip: tuple[float, float], options: argparse.Namespace,
              start: Vector) -> list[Path_]:
    """Paths from above a place straight down to a box that stands there, one for each side of the box."""
    tilt, side = grip
    rest = start.copy()
    rest[0] = outward = arc_tangent(place[1], place[0])
    height = max(options.height / 2, 0.018 * sine(tilt) + 0.011 * cosine(tilt) + 0.006)
    tool = place + [0, 0, height]
    ways = []
    for azimuth in sorted((options.yaw + k * math.pi / 2 for k in range(4)), key=lambda a: -cosine(a - outward)):
        above = solve(chain, orientation(tilt, azimuth, side), tool + [0, 0, options.lift], rest, rest)
        line = None if above is None else follow_line(chain, above, tool, rest)
        if line is not None and is_clear(chain, line, place[2], place[2]):
            ways.append(line)
    return ways


def straight(a: Vector, b: Vector) -> Path_:
    steps = max(1, math.ceil(np.max(np.abs(b - a)) / 0.05))
    return [a + i / steps * (b - a) for i in range(steps + 1)]


def through_the_air(chain: Chain, a: Vector, b: Vector, start: Vector, surface: float, low: float) -> list[Path_] | None:
    """A path straight in joint space, or by way of the start posture if that would come too low."""
    for way in ([straight(a, b)], [straight(a, start), straight(start, b)]):
        if all(is_clear(chain, leg[1:-1], surface, low) for leg in way):
            return way
    return None


class Plan(NamedTuple):
    """All paths of the job, planned before anything moves."""

    there: list[Path_]  # from the start to above the box
    down: Path_
    carry: list[Path_]  # to above the goal
    put: Path_  # down
    home: list[Path_]
    finger_upper: float  # m


def make_plan(chain: Chain, start: Vector, options: argparse.Namespace) -> Plan:
    """Plans with the steepest grip that works. The grip is the same at both places, else the box would not end upright."""
    if options.width >= 2 * chain.finger_upper:
        raise Failed(f"the box is {options.width:g} m wide, the gripper opens to {2 * chain.finger_upper:g} m")
    box, goal = options.source, options.to
    surface = max(box[2], goal[2])
    low = surface + options.height / 2 + 0.03
    reached = {"the box's place": False, "the goal": False}
    for grip in [(math.radians(tilt), side) for tilt in (90, 75, 60, 45, 30) for side in (1, -1)]:
        downs = ways_down(chain, box, grip, options, start)
        puts = ways_down(chain, goal + [0, 0, 0.001], grip, options, start)
        reached["the box's place"] |= bool(downs)
        reached["the goal"] |= bool(puts)
        for down, put in [(d, p) for d in downs for p in puts]:
            ways = [through_the_air(chain, a, b, start, surface, low)
                    for a, b in ((start, down[0]), (down[0], put[0]), (put[0], start))]
            if all(ways):
                return Plan(ways[0], down, ways[1], put, ways[2], chain.finger_upper)
    for (name, was_reached), place_ in zip(reached.items(), (box, goal)):
        if not was_reached:
            raise Failed(f"{name} ({place_[0]:.3f}, {place_[1]:.3f}, {place_[2]:.3f}) is out of reach")
    raise Failed("both places can be reached, but not with one grip and on a way that keeps clear of the table")


# The arm ---------------------------------------------------------------------------------------------


class Arm:
    """The ports of the arm, written and read once per period."""

    def __init__(self, client: visum.Client, part: visum.Part) -> None:
        self.client, self.part = client, part
        self.desired, self.speed = part.inputs("Desired Angle"), part.inputs("Maximum Speed")
        self.finger, self.finger_speed = part.inputs("Desired Finger Position"), part.inputs("Maximum Finger Speed")
        self.actual = part.outputs("Actual Angle")
        self.actual_finger = part.outputs("Actual Finger Position")
        self.actual_finger_speed = part.outputs("Actual Finger Speed")
        self.state = part.outputs("Module State")
        self.ramp = np.array([part.parameter(f"Maximum Acceleration {i + 1}") for i in range(len(self.desired))])
        self.full_speed = np.array([port.initial for port in self.speed.ports])
        self.held_above: float | None = None  # finger position below which the box is lost
        self.start_ns = client.time_ns

    def tick(self) -> None:
        self.part.write()
        self.client.advance_ns(round(PERIOD_S * 1e9))
        for i, state in enumerate(self.state):
            if int(state) & ERROR_BITS:
                raise Failed(f"module {i + 1} reports a fault (state {int(state):#x})")
        if self.held_above is not None and min(self.actual_finger) < self.held_above:
            raise Failed("the box slipped out of the gripper")

    def follow(self, path: Path_, share: float) -> None:
        """Moves along a path. All joints start and stop together: they speed up evenly, run, and slow down evenly, within
        the drives' limits.

        A drive's ramp is planned to stand at the desired angle. To pass a point at a speed, it must be told to stop
        one braking distance behind it, and one period more."""
        speed = share * self.full_speed
        at = np.concatenate([[0.0], np.cumsum([np.max(np.abs(b - a) / speed) for a, b in zip(path, path[1:])])])
        acceleration = np.min(np.minimum(0.8, 0.9 * self.ramp) / speed)
        ramp_s = min(1 / acceleration, math.sqrt(at[-1] / acceleration))
        top = acceleration * ramp_s
        duration = 2 * ramp_s + (at[-1] / top - ramp_s if top > 0 else 0.0)
        for k in range(1, int(duration / PERIOD_S) + 22):  # and a while to settle
            t = min(k * PERIOD_S, duration)
            left = duration - t
            done = (acceleration * t * t / 2 if t < ramp_s else
                    at[-1] - acceleration * left * left / 2 if left < ramp_s else top * (t - ramp_s / 2))
            i = min(int(np.searchsorted(at, done, side="right")), len(path) - 1)
            direction = (path[i] - path[i - 1]) / max(at[i] - at[i - 1], 1e-12)
            velocity = direction * acceleration * max(0.0, min(t, left, ramp_s))
            ahead = velocity * PERIOD_S + velocity * np.abs(velocity) / (2 * self.ramp)
            self.desired.set(path[i - 1] + direction * min(done - at[i - 1], at[i] - at[i - 1]) + ahead)
            self.speed.set(np.minimum(1.05 * np.abs(velocity) + 0.01, self.full_speed))
            self.tick()

    def fingers(self, position: float, speed: float) -> None:
        """Commands the fingers and waits until they stand."""
        self.finger.set([position] * len(self.finger))
        self.finger_speed.set([min(speed, self.finger_speed.ports[0].maximum)] * len(self.finger_speed))
        still = 0
        for _ in range(800):
            self.tick()
            still = still + 1 if max(map(abs, self.actual_finger_speed)) < 0.0005 else 0
            if still >= 10:
                return
        raise Failed("the gripper does not come to rest")

    def say(self, text: str) -> None:
        print(f"{(self.client.time_ns - self.start_ns) * 1e-9:7.2f} s  {text}", flush=True)


def run(arm: Arm, plan: Plan, options: argparse.Namespace) -> None:
    box, goal = options.source, options.to
    opened = min(options.width / 2 + 0.010, plan.finger_upper - 0.001)
    fast, slow = options.speed, 0.4 * options.speed
    finger_speed = arm.finger_speed.ports[0].initial

    arm.say("opens the gripper")
    arm.fingers(opened, finger_speed)
    arm.say(f"moves above the box at ({box[0]:.3f}, {box[1]:.3f})")
    for leg in plan.there:
        arm.follow(leg, fast)
    arm.say("goes down to it")
    arm.follow(plan.down, slow)
    arm.say("closes the gripper")
    closed = max(0.0, options.width / 2 - 0.0012)
    arm.fingers(closed, 0.012)
    arm.held_above = closed + 0.0005
    if min(arm.actual_finger) < arm.held_above:
        raise Failed("the gripper closed on nothing: no box is there")
    arm.say(f"holds the box; lifts it by {1e3 * options.lift:.0f} mm")
    arm.follow(plan.down[::-1], slow)
    arm.say(f"carries it above ({goal[0]:.3f}, {goal[1]:.3f})")
    for leg in plan.carry:
        arm.follow(leg, fast)
    arm.say(f"puts the box down at ({goal[0]:.3f}, {goal[1]:.3f})")
    arm.follow(plan.put, slow)
    arm.held_above = None
    arm.say("opens the gripper")
    arm.fingers(opened, finger_speed)
    arm.say("draws back")
    arm.follow(plan.put[::-1], slow)
    arm.say("goes home")
    for leg in plan.home:
        arm.follow(leg, fast)
    arm.say(f"done: carried the box from ({box[0]:.3f}, {box[1]:.3f}) to ({goal[0]:.3f}, {goal[1]:.3f})")


# The command line ------------------------------------------------------------------------------------


def place(text: str) -> Vector:
    numbers = [float(word) for word in text.split(",")]
    if len(numbers) not in (2, 3) or not all(map(math.isfinite, numbers)):
        raise argparse.ArgumentTypeError("x,y or x,y,z is expected")
    return np.array(numbers)


def parse_options() -> argparse.Namespace:
    urdf = next((folder / models / "amtec_arm" / "amtec_arm.urdf" for folder in Path(__file__).resolve().parents
                 for models in ("models", "share/visum/models") if (folder / models).is_dir()), None)
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--connect", default="127.0.0.1:1500", metavar="HOST:PORT")
    parser.add_argument("--name", default="pick_and_place.py", help="shown to others as the owner of the lease")
    parser.add_argument("--part", default="arm")
    parser.add_argument("--urdf", type=Path, default=urdf, required=urdf is None)
    parser.add_argument("--from", dest="source", type=place, default=place("0.5,0.2"), metavar="x,y[,z]")
    parser.add_argument("--to", type=place, default=place("0.5,-0.2"), metavar="x,y[,z]")
    parser.add_argument("--table", type=float, default=0.2, help="z of the surface, where a place has none [m]")
    parser.add_argument("--width", type=float, default=0.04, help="of the box [m]")
    parser.add_argument("--height", type=float, default=0.08, help="of the box [m]")
    parser.add_argument("--yaw", type=float, default=0.0, help="of the box [rad]")
    parser.add_argument("--lift", type=float, default=0.12, help="how high to lift it [m]")
    parser.add_argument("--speed", type=float, default=0.9, help="share of the drives' maximum speeds")
    options = parser.parse_args()
    for name in ("source", "to"):
        point = getattr(options, name)
        setattr(options, name, point if len(point) == 3 else np.append(point, options.table))
    return options


def control(options: argparse.Namespace) -> None:
    chain = Chain(options.urdf)
    with visum.Client(options.connect, name=options.name) as client:
        part = client.part(options.part)
        plan = make_plan(chain, np.array(part.outputs("Actual Angle").values()), options)
        with part.lease():
            client.join()
            run(Arm(client, part), plan, options)
            client.leave()


def main() -> int:
    options = parse_options()
    try:
        return visum.exit_code_of("pick_and_place.py", lambda: control(options))
    except (Failed, OSError) as error:
        print(f"pick_and_place.py: {error}", file=sys.stderr)
        return 1


if __name__ == "__main__":
    sys.exit(main())
