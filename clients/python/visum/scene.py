"""Builds a scene in code and writes it as the YAML that visumd reads (server/scene/README.md explains every key).

    scene = Scene("towers", gravity=(0, 0, -1.62))
    scene.surface("rubber", friction=1.0)
    scene.body("floor", fixed=True, shapes=[plane()])
    for i in range(5):
        scene.body(f"block_{i}", mass=1, pose=pose(0, 0, 0.1 + 0.2 * i), shapes=[box(0.2, 0.2, 0.2, surface="rubber")])
    scene.write("towers.yaml")

Arguments that are not given are left out of the file; visumd's defaults count then. visumd checks the numbers when it reads
the file, as `visum check towers.yaml` does.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

Entry = dict[str, Any]
Vector = Sequence[float]
Repeat = int | Mapping[str, int]


def _plain(value: Any) -> Any:
    """Converts a value to what JSON can hold: tuples to lists, paths to texts. Drops None, and refuses NaN."""
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items() if item is not None}
    if isinstance(value, (str, bool, int)):
        return value
    if isinstance(value, float):
        if not math.isfinite(value):
            raise ValueError(f"a scene holds finite numbers, not {value}")
        return value
    if isinstance(value, Path):
        return str(value)
    if isinstance(value, Iterable):
        return [_plain(item) for item in value]
    if hasattr(value, "item"):
        return _plain(value.item())  # numpy's numbers
    raise TypeError(f"a scene cannot hold a {type(value).__name__}")


# Poses and shapes ------------------------------------------------------------------------------------


def pose(x: float = 0, y: float = 0, z: float = 0, *, rpy: Vector | None = None, wxyz: Vector | None = None,
         frame: str | None = None) -> Entry:
    """A pose in m and rad. `frame` is the frame of the scene in which it is given."""
    return _plain({"in": frame, "xyz": [x, y, z], "rpy": rpy, "wxyz": wxyz})


def _shape(kind: str, size: Any, *, name: str | None = None, pose: Entry | None = None, surface: str | None = None,
           color: Vector | None = None, material: str | None = None, collides: bool | None = None,
           scale: float | Vector | None = None, repeat: Repeat | None = None) -> Entry:
    return _plain({kind: size, "name": name, "pose": pose, "surface": surface, "color": color, "material": material,
                   "collides": collides, "scale": scale, "repeat": repeat})


def box(x: float, y: float, z: float, **more: Any) -> Entry:
    """A box with full edge lengths, m."""
    return _shape("box", [x, y, z], **more)


def sphere(radius: float, **more: Any) -> Entry:
    return _shape("sphere", radius, **more)


def cylinder(radius: float, length: float, **more: Any) -> Entry:
    return _shape("cylinder", {"radius": radius, "length": length}, **more)


def capsule(radius: float, length: float, **more: Any) -> Entry:
    """A capsule; the length does not count the caps."""
    return _shape("capsule", {"radius": radius, "length": length}, **more)


def plane(**more: Any) -> Entry:
    return _shape("plane", True, **more)


def mesh(file: str | Path, **more: Any) -> Entry:
    return _shape("mesh", file, **more)


def convex(file: str | Path, **more: Any) -> Entry:
    return _shape("convex", file, **more)


# The scene -------------------------------------------------------------------------------------------


class Scene:
    """A scene file. It holds keys and entries in the order in which they are added. A wrong value raises ValueError or
    TypeError."""

    def __init__(self, name: str | None = None, *, gravity: Vector | None = None, tick_ms: float | None = None,
                 clock: str | None = None, speed: float | None = None, seed: int | None = None,
                 lockstep_timeout_s: float | None = None, engine: str | Mapping[str, Any] | None = None,
                 collision: Mapping[str, bool | int] | None = None, parameters: Mapping[str, Any] | None = None) -> None:
        self.root: Entry = {"visum": 1}
        self.root.update(_plain({"name": name, "gravity": gravity, "tick_ms": tick_ms, "clock": clock, "speed": speed,
                                 "seed": seed, "lockstep_timeout_s": lockstep_timeout_s, "engine": engine,
                                 "collision": collision}))
        if parameters is not None:
            # A parameter of None has no default: the scene that includes this file must give it.
            self.root["parameters"] = {key: None if value is None else _plain(value) for key, value in parameters.items()}

    def _add(self, key: str, entry: Any) -> None:
        self.root.setdefault(key, []).append(_plain(entry))

    def _name(self, key: str, name: str, entry: Any) -> None:
        named = self.root.setdefault(key, {})
        if name in named:
            raise ValueError(f"there is already a '{name}' among the {key}")
        named[name] = _plain(entry)

    def include(self, file: str | Path, *, parameters: Mapping[str, Any] | None = None, pose: Entry | None = None,
                repeat: Repeat | None = None) -> None:
        entry = _plain({"file": file, "parameters": parameters, "pose": pose, "repeat": repeat})
        self._add("include", entry if len(entry) > 1 else str(file))

    def engine(self, name: str, kind: str, **settings: Any) -> None:
        self._name("engines", name, {"kind": kind, **settings} if settings else kind)

    def surface(self, name: str, *, friction: float | None = None, restitution: float | None = None,
                rolling_friction: float | None = None, torsional_friction: float | None = None) -> None:
        self._name("surfaces", name, {"friction": friction, "restitution": restitution,
                                      "rolling_friction": rolling_friction, "torsional_friction": torsional_friction})

    def material(self, name: str, *, color: Vector | None = None, roughness: float | None = None,
                 metalness: float | None = None, texture: str | Path | None = None,
                 texture_size: Vector | None = None) -> None:
        self._name("materials", name, {"color": color, "roughness": roughness, "metalness": metalness,
                                       "texture": texture, "texture_size": texture_size})

    def frame(self, name: str, pose: Entry, *, repeat: Repeat | None = None) -> None:
        self._add("frames", {"name": name, "pose": pose, "repeat": repeat})

    def model(self, name: str, file: str | Path, *, model: str | None = None, pose: Entry | None = None,
              fixed: bool | None = None, kinematic: bool | None = None, joints: Mapping[str, float] | None = None,
              surface: str | None = None, surfaces: Mapping[str, str] | None = None, self_collision: bool | None = None,
              no_collision: Iterable[Sequence[str]] | Mapping[str, Any] | None = None, density: float | None = None,
              repair: bool | None = None, collision_meshes: str | None = None, engine: str | None = None,
              repeat: Repeat | None = None) -> None:
        self._add("models", {"name": name, "file": file, "model": model, "pose": pose, "fixed": fixed,
                             "kinematic": kinematic, "joints": joints, "surface": surface, "surfaces": surfaces,
                             "self_collision": self_collision, "no_collision": no_collision, "density": density,
                             "repair": repair, "collision_meshes": collision_meshes, "engine": engine,
                             "repeat": repeat})

    def body(self, name: str, *, fixed: bool | None = None, kinematic: bool | None = None, pose: Entry | None = None,
             mass: float | None = None, density: float | None = None, inertia: Vector | None = None, com: Vector | None = None,
             velocity: Mapping[str, Vector] | None = None, shapes: Iterable[Entry] | None = None,
             engine: str | None = None, surface: str | None = None, color: Vector | None = None,
             material: str | None = None, repeat: Repeat | None = None) -> None:
        self._add("bodies", {"name": name, "fixed": fixed, "kinematic": kinematic, "pose": pose, "mass": mass,
                             "density": density, "inertia": inertia, "com": com, "velocity": velocity, "shapes": shapes, "engine": engine,
                             "surface": surface, "color": color, "material": material, "repeat": repeat})

    def joint(self, name: str, type: str, child: str, **keys: Any) -> None:
        """`keys` are those of the joint's type: parent, pose, axis, limits, ..."""
        self._add("joints", {"name": name, "type": type, "child": child, **keys})

    def no_collision(self, a: str, b: str) -> None:
        self._add("no_collision", [a, b])

    def part(self, name: str, kind: str, **keys: Any) -> None:
        """`keys` are those of the part's kind: model, joints, drives, ..."""
        self._add("parts", {"name": name, "kind": kind, **keys})

    def sensor(self, name: str, kind: str, **keys: Any) -> None:
        """`keys` are those of the sensor's kind: body, pose, range, rate_hz, ..."""
        self._add("sensors", {"name": name, "kind": kind, **keys})

    def plugin(self, name: str) -> None:
        """Loads a library with kinds of agents, sensors and parts, by its name without folder and ending."""
        self._add("plugins", name)

    def agent(self, name: str, kind: str, **keys: Any) -> None:
        """`keys` are those of the agent's kind: parts, period_ms, ..."""
        self._add("agents", {"name": name, "kind": kind, **keys})

    def light(self, kind: str, **keys: Any) -> None:
        self._add("lights", {"kind": kind, **keys})

    def viewpoint(self, name: str, position: Vector, target: Vector, *, fov_deg: float | None = None) -> None:
        self._add("viewpoints", {"name": name, "position": position, "target": target, "fov_deg": fov_deg})

    def panel(self, file: str | Path) -> None:
        self._add("panels", file)

    def yaml(self) -> str:
        """Returns the file's text: one line for each setting and entry, with values as JSON, which is YAML, too."""
        lines = []
        for key, value in self.root.items():
            if isinstance(value, list) and value and not isinstance(value[0], (int, float)):
                lines += [f"{key}:", *(f"  - {json.dumps(entry, ensure_ascii=False)}" for entry in value)]
            else:
                lines.append(f"{key}: {json.dumps(value, ensure_ascii=False)}")
        return "\n".join(lines) + "\n"

    def write(self, file: str | Path) -> None:
        Path(file).write_text(self.yaml(), encoding="utf-8")
