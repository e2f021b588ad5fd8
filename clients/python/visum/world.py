"""The true state of the world, for checkers and viewers. Controllers do not get it: no port of a part shows it."""

from __future__ import annotations

from typing import NamedTuple

from visum.connection import pb
from visum.errors import unknown_name


class Body(NamedTuple):
    """A body at one tick: the pose of its link frame in the world frame (m), the quaternion as (w, x, y, z)."""

    name: str
    position: tuple[float, float, float]
    quaternion: tuple[float, float, float, float]
    velocity: tuple[float, float, float]
    angular_velocity: tuple[float, float, float]
    peak_contact_force: float  # N, the largest sum of normal forces since this session's previous sample


class Joint(NamedTuple):
    """A joint at one tick, in rad, rad/s and N·m, or in m, m/s and N."""

    name: str
    position: float
    velocity: float
    effort: float
    following_error: float
    peak_following_error: float  # since this session's previous sample


class Contact(NamedTuple):
    """A contact point at one tick, in the world frame (m, N). The normal points from body_b to body_a."""

    body_a: str
    body_b: str
    position: tuple[float, float, float]
    normal: tuple[float, float, float]
    depth: float
    normal_force: float


class World:
    """The bodies and joints of a world. `description` is the message WorldDescription, with shapes, colours and limits."""

    def __init__(self, description: pb.WorldDescription) -> None:
        self.description = description
        self.scene: str = description.scene
        self.body_names = [body.name for body in description.bodies]
        self.joint_names = [joint.name for joint in description.joints]


class WorldView:
    """The world at one tick. `sample` is the message WorldSample."""

    def __init__(self, world: World, sample: pb.WorldSample) -> None:
        self.world = world
        self.sample = sample
        self.tick: int = sample.tick
        self.time_ns: int = sample.sim_time_ns
        self.era: int = sample.era
        self.state_hash: int = sample.state_hash

    def body(self, name: str) -> Body:
        i = _index(self.world.body_names, name, "body")
        pose, velocity = self.sample.poses[7 * i:7 * i + 7], self.sample.velocities[6 * i:6 * i + 6]
        return Body(name, tuple(pose[:3]), tuple(pose[3:]), tuple(velocity[:3]), tuple(velocity[3:]),
                    self.sample.peak_contact_forces[i])

    def joint(self, name: str) -> Joint:
        i = _index(self.world.joint_names, name, "joint")
        s = self.sample
        return Joint(name, s.joint_positions[i], s.joint_velocities[i], s.joint_efforts[i], s.following_errors[i],
                     s.peak_following_errors[i])

    def contacts(self) -> list[Contact]:
        names = self.world.body_names
        return [Contact(names[c.body_a], names[c.body_b], tuple(c.position), tuple(c.normal), c.depth,
                        c.normal_force_n) for c in self.sample.contacts]


def _index(names: list[str], name: str, what: str) -> int:
    if name not in names:
        raise unknown_name(what, name, names)
    return names.index(name)
