#!/usr/bin/python3
"""Computes the centre of mass and the inertia tensor of each link of a URDF from its visual solids.

A link's mass (its <mass>) is spread over its boxes, cylinders and spheres in proportion to volume times the relative
density of the solid's material. Where solids overlap, the overlap counts twice.

    make_inertias.py ROBOT.urdf            prints one line per link
    make_inertias.py ROBOT.urdf --write    puts the figures into the URDF's <inertial> elements
    make_inertias.py ROBOT.urdf --check    exits 1 and says where if the URDF holds other figures
"""

from __future__ import annotations

import argparse
import math
import re
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import NamedTuple

import numpy as np

# Mass per volume by material, relative to a full motor module (1.0, also for other materials): aluminium
# transitions are hollow, coloured bands are paint.
RELATIVE_DENSITY = {"module": 1.0, "metal": 0.6, "accent": 0.0, "rubber": 0.3}

INERTIAL = re.compile(r"<inertial>.*?</inertial>", re.DOTALL)


class Solid(NamedTuple):
    """A piece of a link: its share of the mass, where its centre is and how it is turned, in the link's frame."""

    weight: float  # volume times relative density
    center: np.ndarray
    rotation: np.ndarray
    unit_inertia: np.ndarray  # about its own centre and axes, for 1 kg


def rotation_from_rpy(rpy: list[float]) -> np.ndarray:
    """URDF's fixed-axis roll, pitch, yaw."""
    (sr, cr), (sp, cp), (sy, cy) = ((math.sin(a), math.cos(a)) for a in rpy)
    return np.array([[cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
                     [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
                     [-sp, cp * sr, cp * cr]])


def numbers(element: ElementTree.Element | None, key: str) -> list[float]:
    """The attribute as numbers; three zeros where it is missing."""
    text = element.get(key) if element is not None else None
    return [float(word) for word in text.split()] if text else [0.0, 0.0, 0.0]


def volume_and_unit_inertia(geometry: ElementTree.Element) -> tuple[float, np.ndarray]:
    """Volume, and principal moments for 1 kg."""
    shape = geometry[0]
    if shape.tag == "box":
        x, y, z = numbers(shape, "size")
        return x * y * z, np.diag([y * y + z * z, x * x + z * z, x * x + y * y]) / 12.0
    radius = float(shape.get("radius", "nan"))
    if shape.tag == "sphere":
        return 4.0 / 3.0 * math.pi * radius**3, np.eye(3) * 0.4 * radius**2
    if shape.tag == "cylinder":
        length = float(shape.get("length", "nan"))
        across = (3.0 * radius**2 + length**2) / 12.0
        return math.pi * radius**2 * length, np.diag([across, across, 0.5 * radius**2])
    raise ValueError(f"no inertia for a {shape.tag}")


def solid_of(visual: ElementTree.Element) -> Solid:
    volume, unit_inertia = volume_and_unit_inertia(visual.find("geometry"))
    material = visual.find("material").get("name")
    origin = visual.find("origin")
    return Solid(volume * RELATIVE_DENSITY.get(material, 1.0), np.array(numbers(origin, "xyz")),
                 rotation_from_rpy(numbers(origin, "rpy")), unit_inertia)


def center_and_inertia(mass: float, solids: list[Solid]) -> tuple[np.ndarray, np.ndarray]:
    """The centre of mass of a link of that mass, and inertia about it, in the link's axes."""
    total = sum(solid.weight for solid in solids)
    center = sum(solid.weight * solid.center for solid in solids) / total
    inertia = np.zeros((3, 3))
    for solid in solids:
        share = mass * solid.weight / total
        arm = solid.center - center
        inertia += share * (solid.rotation @ solid.unit_inertia @ solid.rotation.T)
        inertia += share * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    return center, inertia


def rounded(value: float) -> str:
    """Five digits; what is only rounding of a sum is zero."""
    return "0" if abs(value) < 1e-9 else f"{value:.5g}"


def inertial_element(link: ElementTree.Element) -> str:
    """The <inertial> that belongs to the link's solids."""
    mass_text = link.find("inertial/mass").get("value")
    center, inertia = center_and_inertia(float(mass_text), [solid_of(v) for v in link.findall("visual")])
    xyz = " ".join(rounded(value) for value in center)
    entries = {"ixx": (0, 0), "ixy": (0, 1), "ixz": (0, 2), "iyy": (1, 1), "iyz": (1, 2), "izz": (2, 2)}
    tensor = " ".join(f'{name}="{rounded(inertia[place])}"' for name, place in entries.items())
    return f'<inertial><origin xyz="{xyz}"/><mass value="{mass_text}"/><inertia {tensor}/></inertial>'


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("urdf", type=Path)
    mode = parser.add_mutually_exclusive_group()
    mode.add_argument("--write", action="store_true")
    mode.add_argument("--check", action="store_true")
    options = parser.parse_args()

    text = options.urdf.read_text()
    links = [link for link in ElementTree.fromstring(text).findall("link") if link.find("inertial") is not None]
    elements = [inertial_element(link) for link in links]
    found = INERTIAL.findall(text)
    if options.check:
        wrong = [link.get("name") for link, is_, should in zip(links, found, elements, strict=True) if is_ != should]
        for name in wrong:
            print(f"{options.urdf}: the inertial of {name} is not that of its solids; run make_inertias.py --write")
        return 1 if wrong else 0
    if options.write:
        remaining = iter(elements)
        options.urdf.write_text(INERTIAL.sub(lambda _: next(remaining), text))
        return 0
    for link, element in zip(links, elements, strict=True):
        print(f"{link.get('name')}: {element}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
