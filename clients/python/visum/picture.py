"""Draws the world as an SVG file, for a paper, a README or a CI report. It needs no GPU and no display.

`draw()` takes the messages WorldDescription and WorldSample as they come from the server, and returns the SVG's text.
Each shape becomes flat faces, shaded by one light. Faces are painted from the farthest to the nearest (the painter's
algorithm), so faces that pierce each other look wrong. Lengths are in metres, in the world frame, z up.
"""

from dataclasses import dataclass

import numpy as np

_ROUND = 24  # corners of a circle
_LIGHT = np.array([0.35, -0.5, 0.8]) / np.linalg.norm([0.35, -0.5, 0.8])


@dataclass(frozen=True)
class View:
    """The camera: its position, its target, and its angle of view."""

    eye: tuple = (1.9, -1.3, 1.15)
    target: tuple = (0.32, 0.0, 0.34)
    field_of_view: float = 0.5  # rad, vertical
    width: int = 960  # pixels
    height: int = 640


def draw(world, sample, view=View()):
    """Returns the SVG of the world of a WorldDescription, at the poses of a WorldSample."""
    faces = []
    for index, body in enumerate(world.bodies):
        pose = _matrix(sample.poses[7 * index : 7 * index + 7])
        for shape in body.shapes:
            if len(shape.color) < 4 or shape.color[3] > 0:  # alpha 0: it only collides
                faces += [(face, shape.color, shape.kind == "plane") for face in _faces(shape, pose)]
    return _svg(_painted(faces, view), view)


def _matrix(pose):
    x, y, z, qw, qx, qy, qz = pose
    return np.array(
        [
            [1 - 2 * (qy * qy + qz * qz), 2 * (qx * qy - qw * qz), 2 * (qx * qz + qw * qy), x],
            [2 * (qx * qy + qw * qz), 1 - 2 * (qx * qx + qz * qz), 2 * (qy * qz - qw * qx), y],
            [2 * (qx * qz - qw * qy), 2 * (qy * qz + qw * qx), 1 - 2 * (qx * qx + qy * qy), z],
            [0, 0, 0, 1],
        ]
    )


def _faces(shape, body_pose):
    """The faces of a shape as arrays of corners in the world frame, counter-clockwise as seen from outside."""
    pose = body_pose @ _matrix(shape.pose)
    makers = {"box": _box, "sphere": _sphere, "cylinder": _cylinder, "capsule": _capsule, "plane": _plane}
    if shape.kind not in makers:
        return []
    local = makers[shape.kind](*shape.size)
    return [face @ pose[:3, :3].T + pose[:3, 3] for face in local]


def _box(x, y, z):
    corners = np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)]) * np.array([x, y, z]) / 2
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return [piece for side in sides for piece in _divided(corners[list(side)])]


def _divided(quad, longest=0.12):
    """Cuts a large face into pieces, so that its far and near parts are painted in the right order."""
    a, b, c, d = quad
    columns = int(np.clip(np.linalg.norm(b - a) / longest, 1, 12))
    rows = int(np.clip(np.linalg.norm(d - a) / longest, 1, 12))

    def at(u, v):
        return a * (1 - u) * (1 - v) + b * u * (1 - v) + c * u * v + d * (1 - u) * v

    return [
        np.array(
            [
                at(i / columns, j / rows),
                at((i + 1) / columns, j / rows),
                at((i + 1) / columns, (j + 1) / rows),
                at(i / columns, (j + 1) / rows),
            ]
        )
        for i in range(columns)
        for j in range(rows)
    ]


def _ring(radius, z):
    angles = np.linspace(0, 2 * np.pi, _ROUND, endpoint=False)
    return np.stack([radius * np.cos(angles), radius * np.sin(angles), np.full(_ROUND, z)], axis=1)


def _lathe(rings):
    """The faces between consecutive rings, from the lowest to the highest."""
    return [
        np.array([low[i], low[(i + 1) % _ROUND], high[(i + 1) % _ROUND], high[i]])
        for low, high in zip(rings, rings[1:])
        for i in range(_ROUND)
    ]


def _cylinder(radius, length):
    low, high = _ring(radius, -length / 2), _ring(radius, length / 2)
    return _lathe([low, high]) + [low[::-1], high]


def _dome(radius, z, upwards):
    latitudes = np.linspace(0, np.pi / 2, 6)
    rings = [_ring(radius * np.cos(a), z + (1 if upwards else -1) * radius * np.sin(a)) for a in latitudes]
    return rings if upwards else rings[::-1]


def _capsule(radius, length):
    return _lathe(_dome(radius, -length / 2, False) + _dome(radius, length / 2, True))


def _sphere(radius):
    return _capsule(radius, 0.0)


def _plane():
    steps = np.arange(-1.5, 1.5, 0.25)
    return [np.array([[x, y, 0], [x + 0.25, y, 0], [x + 0.25, y + 0.25, 0], [x, y + 0.25, 0]]) for x in steps for y in steps]


def _painted(faces, view):
    """(order, screen corners, colour) of the faces that point at the eye: planes first, then the farthest."""
    eye = np.array(view.eye, dtype=float)
    forward = np.array(view.target, dtype=float) - eye
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, [0, 0, 1])
    right /= np.linalg.norm(right)
    up = np.cross(right, forward)
    scale = view.height / 2 / np.tan(view.field_of_view / 2)
    painted = []
    for face, colour, ground in faces:
        normal = np.cross(face[1] - face[0], face[2] - face[1])
        length = np.linalg.norm(normal)
        depths = (face - eye) @ forward
        if length < 1e-12 or depths.min() < 0.05 or normal @ (face[0] - eye) >= 0:
            continue
        screen = np.stack(
            [
                view.width / 2 + scale * ((face - eye) @ right) / depths,
                view.height / 2 - scale * ((face - eye) @ up) / depths,
            ],
            axis=1,
        )
        brightness = 0.55 + 0.45 * max(0.0, normal @ _LIGHT / length)
        painted.append((1e9 if ground else np.linalg.norm(face.mean(axis=0) - eye), screen, np.array(colour[:3]) * brightness))
    painted.sort(key=lambda entry: -entry[0])
    return painted


def _svg(painted, view):
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {view.width} {view.height}" '
        f'width="{view.width}" height="{view.height}">',
        '<rect width="100%" height="100%" fill="#eef1f5"/>',
    ]
    for _, screen, colour in painted:
        points = " ".join(f"{x:.1f},{y:.1f}" for x, y in screen)
        fill = "#" + "".join(f"{int(np.clip(channel, 0, 1) * 255 + 0.5):02x}" for channel in colour)
        lines.append(f'<polygon points="{points}" fill="{fill}" stroke="{fill}" stroke-width="0.6"/>')
    return "\n".join(lines + ["</svg>", ""])
