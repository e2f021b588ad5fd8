"""Kinematics of an arm: where its tool is for given joint values, and the joint values that bring it to a pose.

    chain = client.chain("arm/link_7")
    goal = chain.forward(values)
    found = chain.inverse(goal._replace(position=(0.4, 0.1, 0.5)), values)
    if found.reached:
        desired.set(found.values)

Lengths are in metres, angles in radians. Poses are those of the tool's link frame in the frame of the body that carries
the chain (`chain.base`; empty: the world). The same method as in the C++ library (clients/cpp/kinematics.h).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from visum.connection import pb
from visum.errors import Error, ErrorCode, unknown_name

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]

_METRES_PER_RADIAN = 0.3  # so much is a radian worth
_FIRST_DAMPING, _LEAST_DAMPING, _MOST_DAMPING = 1e-3, 1e-9, 1e6
_PRIMES = (2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37)
_MOST_JOINTS = 64  # also bounds the way to the root


class Pose(NamedTuple):
    position: Vector = (0.0, 0.0, 0.0)
    orientation: Quaternion = (1.0, 0.0, 0.0, 0.0)  # w x y z, of length 1


class ChainJoint(NamedTuple):
    name: str
    part: str  # the part that drives it
    slides: bool  # else it turns
    frame: Pose  # of the joint, in the link before it
    axis: Vector  # of length 1, in the joint's frame
    lower: float  # infinite: no limit
    upper: float
    child: Pose = Pose()  # of the link behind it, in the moved joint's frame


class InverseSolution(NamedTuple):
    values: list[float]  # the best that was found; always within the limits
    reached: bool
    position_error: float  # m
    rotation_error: float  # rad


def compose(outer: Pose, inner: Pose) -> Pose:
    """`inner` is given in the frame of `outer`."""
    return Pose(_add(outer.position, _rotate(outer.orientation, inner.position)),
                _multiply(outer.orientation, inner.orientation))


def inverse_of(pose: Pose) -> Pose:
    back = _conjugate(pose.orientation)
    x, y, z = _rotate(back, pose.position)
    return Pose((-x, -y, -z), back)


class Chain:
    """The joints from a base to a tool. It knows no server, and does not change."""

    def __init__(self, base: str, joints: Sequence[ChainJoint]) -> None:
        self.base = base
        self.joints = list(joints)

    def __len__(self) -> int:
        return len(self.joints)

    def forward(self, values: Sequence[float]) -> Pose:
        self._check(values)
        pose = Pose()
        for joint, value in zip(self.joints, values):
            pose = compose(compose(compose(pose, joint.frame), _motion(joint, value)), joint.child)
        return pose

    def inverse(self, tool: Pose, start: Sequence[float], *, tolerance: float = 1e-6, iterations: int = 60,
                starts: int = 400) -> InverseSolution:
        """Damped least squares within the limits. An error below `tolerance` (m, and rad) counts as reached. `starts`: how
        many starts are tried until then; 1: only the given one, and so the solution next to it."""
        self._check(start)
        best = self._descend(tool, self._clamped(start), tolerance, iterations)
        for number in range(1, starts):
            if best.reached:
                break
            found = self._descend(tool, self._spread(number), tolerance, iterations)
            if found.reached or _cost(found) < _cost(best):
                best = found
        return best

    def _check(self, values: Sequence[float]) -> None:
        if len(values) != len(self):
            raise Error(ErrorCode.MISUSE, f"{len(values)} values were given for {len(self)} joints")

    def _descend(self, tool: Pose, values: list[float], tolerance: float, iterations: int) -> InverseSolution:
        now = self._judge(tool, values, tolerance)
        damping = _FIRST_DAMPING
        for _ in range(iterations):
            if now.reached:
                break
            step = self._step(tool, now.values, damping)
            then = self._judge(tool, self._clamped([a + b for a, b in zip(now.values, step)]), tolerance)
            if _cost(then) < _cost(now):
                now = then
                damping = max(_LEAST_DAMPING, damping / 5.0)
            else:
                damping *= 4.0
                if damping > _MOST_DAMPING:
                    break
        return now

    def _judge(self, tool: Pose, values: list[float], tolerance: float) -> InverseSolution:
        now = self.forward(values)
        away = math.dist(now.position, tool.position)
        turned = math.hypot(*_rotation_between(now.orientation, tool.orientation))
        return InverseSolution(values, away <= tolerance and turned <= tolerance, away, turned)

    def _step(self, tool: Pose, values: list[float], damping: float) -> list[float]:
        """Solves (JᵀJ + damping) step = Jᵀ error. A joint at a limit that the step would leave does not take part."""
        now = self.forward(values)
        error = _weighted(_subtract(tool.position, now.position), _rotation_between(now.orientation, tool.orientation))
        columns = self._jacobian(values)
        free = [True] * len(self)
        while True:
            normal = [[(_dot(a, b) if free[i] and free[j] else 0.0) + (damping if i == j else 0.0)
                       for j, b in enumerate(columns)] for i, a in enumerate(columns)]
            step = _solve_positive(normal, [_dot(column, error) if free[i] else 0.0 for i, column in enumerate(columns)])
            stuck = next((i for i, joint in enumerate(self.joints) if free[i] and
                          (values[i] <= joint.lower and step[i] < 0.0 or values[i] >= joint.upper and step[i] > 0.0)), None)
            if stuck is None:
                return step
            free[stuck] = False  # at most once for each joint

    def _jacobian(self, values: Sequence[float]) -> list[list[float]]:
        axes = []
        pose = Pose()
        for joint, value in zip(self.joints, values):
            frame = compose(pose, joint.frame)
            axes.append((frame.position, _rotate(frame.orientation, joint.axis)))
            pose = compose(compose(frame, _motion(joint, value)), joint.child)
        return [_weighted(axis, (0.0, 0.0, 0.0)) if joint.slides
                else _weighted(_cross(axis, _subtract(pose.position, at)), axis)
                for joint, (at, axis) in zip(self.joints, axes)]

    def _clamped(self, values: Sequence[float]) -> list[float]:
        return [min(joint.upper, max(joint.lower, value)) for joint, value in zip(self.joints, values)]

    def _spread(self, number: int) -> list[float]:
        """Spread evenly over the joints' ranges, each joint by its own irrational step."""
        values = []
        for i, joint in enumerate(self.joints):
            low = joint.lower if math.isfinite(joint.lower) else -math.pi
            high = joint.upper if math.isfinite(joint.upper) else math.pi
            values.append(low + math.fmod(number * math.sqrt(_PRIMES[i % len(_PRIMES)]), 1.0) * (high - low))
        return values


def chain_of(description: pb.WorldDescription, sample: pb.WorldSample, body: str) -> Chain:
    """The chain of driven joints that carries a body. Joints on the way that no part drives stay where they are."""
    names = [one.name for one in description.bodies]
    if body not in names:
        raise unknown_name("body", body, names)

    def pose_of(name: str) -> Pose:
        return _pose_at(sample.poses, 7 * names.index(name)) if name else Pose()

    def across(joint: pb.JointDescription) -> Pose:
        return compose(inverse_of(pose_of(joint.parent)), pose_of(joint.child))

    carriers = {joint.child: (number, joint) for number, joint in enumerate(description.joints)}
    joints: list[ChainJoint] = []  # from the tool to the base
    rest = Pose()  # of undriven joints behind the next driven one
    base = body
    for _ in range(_MOST_JOINTS):
        if base not in carriers:
            break
        number, joint = carriers[base]
        if joint.part and joint.type in ("hinge", "slider"):
            link = _link(joint, sample.joint_positions[number], across(joint))
            joints.append(link._replace(child=compose(link.child, rest)))
            rest = Pose()
        else:
            rest = compose(across(joint), rest)
        base = joint.parent
    if not joints:
        raise Error(ErrorCode.MISUSE, f"no part drives a joint that carries '{body}'")
    joints.reverse()
    joints[0] = joints[0]._replace(frame=compose(rest, joints[0].frame))
    return Chain(base, joints)


def _link(joint: pb.JointDescription, now: float, across: Pose) -> ChainJoint:
    limited = joint.upper > joint.lower
    x, y, z = joint.axis
    link = ChainJoint(joint.name, joint.part, joint.type == "slider", _pose_at(joint.pose, 0), (x, y, z),
                      joint.lower if limited else -math.inf, joint.upper if limited else math.inf)
    # Where the child's frame is behind the joint shows in where it is now.
    return link._replace(child=compose(inverse_of(compose(link.frame, _motion(link, now))), across))


def _pose_at(numbers: Sequence[float], at: int) -> Pose:
    x, y, z, qw, qx, qy, qz = numbers[at:at + 7]
    return Pose((x, y, z), (qw, qx, qy, qz))


def _motion(joint: ChainJoint, value: float) -> Pose:
    x, y, z = joint.axis
    if joint.slides:
        return Pose((value * x, value * y, value * z))
    s = math.sin(value / 2.0)
    return Pose((0.0, 0.0, 0.0), (math.cos(value / 2.0), s * x, s * y, s * z))


def _weighted(linear: Vector, angular: Vector) -> list[float]:
    return [*linear, *(_METRES_PER_RADIAN * part for part in angular)]


def _cost(solution: InverseSolution) -> float:
    return solution.position_error ** 2 + (_METRES_PER_RADIAN * solution.rotation_error) ** 2


def _dot(a: Sequence[float], b: Sequence[float]) -> float:
    return sum(x * y for x, y in zip(a, b))


def _add(a: Vector, b: Vector) -> Vector:
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def _subtract(a: Vector, b: Vector) -> Vector:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def _cross(a: Vector, b: Vector) -> Vector:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def _multiply(a: Quaternion, b: Quaternion) -> Quaternion:
    (aw, ax, ay, az), (bw, bx, by, bz) = a, b
    return (aw * bw - ax * bx - ay * by - az * bz, aw * bx + ax * bw + ay * bz - az * by,
            aw * by - ax * bz + ay * bw + az * bx, aw * bz + ax * by - ay * bx + az * bw)


def _conjugate(q: Quaternion) -> Quaternion:
    return q[0], -q[1], -q[2], -q[3]


def _rotate(q: Quaternion, v: Vector) -> Vector:
    w, u = q[0], (q[1], q[2], q[3])
    x, y, z = _cross(u, v)
    t = (2.0 * x, 2.0 * y, 2.0 * z)
    return _add(_add(v, (w * t[0], w * t[1], w * t[2])), _cross(u, t))


def _rotation_between(start: Quaternion, end: Quaternion) -> Vector:
    """As a vector: its direction is the axis, its length the angle, at most pi."""
    w, x, y, z = _multiply(end, _conjugate(start))
    sine = math.hypot(x, y, z)
    if sine < 1e-12:
        return 0.0, 0.0, 0.0
    factor = math.copysign(2.0 * math.atan2(sine, abs(w)), w) / sine
    return factor * x, factor * y, factor * z


def _solve_positive(matrix: list[list[float]], right: list[float]) -> list[float]:
    """For a symmetric positive definite matrix, by Cholesky's method. Works in place."""
    n = len(right)
    for i, row in enumerate(matrix):
        for j in range(i + 1):
            other = matrix[j]
            total = row[j] - sum(row[k] * other[k] for k in range(j))
            row[j] = math.sqrt(max(total, 1e-300)) if i == j else total / other[j]
        right[i] = (right[i] - sum(row[k] * right[k] for k in range(i))) / row[i]
    for i in reversed(range(n)):
        right[i] = (right[i] - sum(matrix[k][i] * right[k] for k in range(i + 1, n))) / matrix[i][i]
    return right
