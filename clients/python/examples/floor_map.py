"""The explorer's map of the floor: cells with something, cells with nothing, and cells that it has covered.

The map is a grid in the frame of the cart's start. Each scan is aligned with what was seen before (align), so that errors of
the odometry do not add up.
"""

from __future__ import annotations

import heapq
import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from cart import Pose
from visum.trig import cosine, hypotenuse, sin_cos, sine

CELL = 0.05  # m
HALF_SIZE = 160  # cells: the map reaches 8 m each way
BORDER = 20  # cells
BETWEEN_RAYS = 0.1  # m: nothing hides so near to free floor
# The evidence that a ray adds to the cell at its end and to the cells on its path, and the limits of a
# cell's evidence. They keep one stray ray from erasing what was seen often.
HIT, PASS = 3, -1
LEAST, SOMETHING, MOST = -10, 4, 40

# Three circles along the cart's axis that cover it with its wheels steered (models/cart/cart.urdf). m, from
# the rear axle.
CIRCLES_AT = (0.0, 0.18, 0.36)
CIRCLE_RADIUS = 0.27
CENTRE_AT = 0.18  # the chassis' frame, from the rear axle


class Move(NamedTuple):
    """A piece of an arc, forwards or backwards."""

    way: float
    curvature: float


# A search turns by the same steps again and again.
facing = lru_cache(maxsize=4096)(sin_cos)


def ahead(pose: Pose, way: float) -> tuple[float, float]:
    sin, cos = facing(pose.heading)
    return pose.x + way * cos, pose.y + way * sin


@lru_cache(maxsize=64)
def chord(move: Move) -> float:
    turn = move.way * move.curvature
    return move.way * sine(turn / 2) / (turn / 2) if abs(turn) > 1e-9 else move.way


def along(pose: Pose, move: Move) -> Pose:
    """The pose at the end of a move."""
    turn = move.way * move.curvature
    # The chord of the arc lies midway between both headings.
    x, y = ahead(Pose(pose.x, pose.y, pose.heading + turn / 2), chord(move))
    return Pose(x, y, pose.heading + turn)


def cell_of(x: float, y: float) -> tuple[int, int]:
    return math.floor(x / CELL) + HALF_SIZE, math.floor(y / CELL) + HALF_SIZE


def disc(radius: float) -> list[tuple[int, int]]:
    """Offsets of the cells whose centres are within the radius."""
    reach = math.floor(radius / CELL)
    return [(i, j) for i in range(-reach, reach + 1) for j in range(-reach, reach + 1)
            if hypotenuse(i, j) * CELL <= radius]


def spread(cells: np.ndarray, radius: float) -> np.ndarray:
    """Marks all cells within the radius of a marked cell. Marks wrap around at the border, where no cell is asked for."""
    result = np.zeros_like(cells)
    for i, j in disc(radius):
        result |= np.roll(cells, (i, j), axis=(0, 1))
    return result


class FloorMap:
    def __init__(self, cover_radius: float) -> None:
        size = 2 * HALF_SIZE
        self._evidence = np.zeros((size, size), dtype=np.int16)
        self._covered = np.zeros((size, size), dtype=bool)
        self._cover = np.array(disc(cover_radius))
        self.worthwhile = len(self._cover) // 8  # cells to be covered anew, to go somewhere

    def see(self, eye: tuple[float, float], angles: np.ndarray, distances: np.ndarray, farthest: float) -> None:
        """Takes in a scan: free along each ray, something at its end unless that is the sensor's reach."""
        if not len(distances):
            return
        steps = np.arange(0.0, farthest, CELL / 2)
        ray, step = np.nonzero(steps[None, :] < distances[:, None] - CELL)
        # And the cell of the eye, from which all rays come.
        ray, ways = np.append(ray, 0), np.append(steps[step], 0.0)
        cos, sin = cosine(angles), sine(angles)
        self._weigh(eye, cos[ray], sin[ray], ways, PASS)
        hit = distances < farthest - CELL
        self._weigh(eye, cos[hit], sin[hit], distances[hit], HIT)

    def _weigh(self, eye: tuple[float, float], cos: np.ndarray, sin: np.ndarray, ways: np.ndarray, weight: int) -> None:
        """Once for each cell, however many rays have gone through it."""
        i = np.floor((eye[0] + ways * cos) / CELL).astype(int) + HALF_SIZE
        j = np.floor((eye[1] + ways * sin) / CELL).astype(int) + HALF_SIZE
        inside = (i >= 0) & (i < 2 * HALF_SIZE) & (j >= 0) & (j < 2 * HALF_SIZE)
        touched = np.zeros_like(self._evidence, dtype=bool)
        touched[i[inside], j[inside]] = True
        self._evidence[touched] = np.clip(self._evidence[touched] + weight, LEAST, MOST)

    def _free(self) -> np.ndarray:
        return self._evidence < 0

    def _occupied(self) -> np.ndarray:
        return self._evidence >= SOMETHING

    def align(self, pose: Pose, points: np.ndarray) -> Pose:
        """The pose near this one from which a scan's points, in the cart's frame, lie best on what has been seen before."""
        walls = self._occupied()
        near_walls = sum(spread(walls, radius).astype(np.int16) for radius in (0.0, CELL, 2 * CELL))

        def score(at: Pose) -> int:
            sin, cos = sin_cos(at.heading)
            i = np.floor((at.x + points[:, 0] * cos - points[:, 1] * sin) / CELL).astype(int) + HALF_SIZE
            j = np.floor((at.y + points[:, 0] * sin + points[:, 1] * cos) / CELL).astype(int) + HALF_SIZE
            inside = (i >= 0) & (i < 2 * HALF_SIZE) & (j >= 0) & (j < 2 * HALF_SIZE)
            return int(near_walls[i[inside], j[inside]].sum())

        best, most = pose, score(pose)
        for step in (0.03, 0.015, 0.0075):  # m, and rad
            tried = [Pose(best.x + a * step, best.y + b * step, best.heading + c * step)
                     for a in (-1, 0, 1) for b in (-1, 0, 1) for c in (-1, 0, 1)]
            scores = [score(at) for at in tried]
            if max(scores) > most:
                most = max(scores)
                best = tried[scores.index(most)]
        return best

    def cover(self, pose: Pose) -> None:
        """The cart was here: it has covered what is near, and stands on free floor."""
        centre = cell_of(*ahead(pose, CENTRE_AT))
        self._covered[self._cover[:, 0] + centre[0], self._cover[:, 1] + centre[1]] = True
        for way in CIRCLES_AT:
            self._evidence[cell_of(*ahead(pose, way))] = LEAST

    def passable(self, margin: float) -> np.ndarray:
        """The cells where a circle of the cart may be: seen free, and far enough from everything. Not at the map's border, so
        that no move leaves the map."""
        result = spread(self._free(), BETWEEN_RAYS) & ~spread(self._occupied(), CIRCLE_RADIUS + margin)
        for side in (result, result.T):
            side[:BORDER] = side[-BORDER:] = False
        return result

    def gain(self) -> np.ndarray:
        """For each cell, the amount of free floor that the cart would newly cover from there."""
        open_floor = (self._free() & ~self._covered).astype(np.int16)
        total = np.zeros_like(open_floor)
        for i, j in self._cover:
            total += np.roll(open_floor, (-i, -j), axis=(0, 1))
        return total


LENGTH = 0.3  # m, of a move
MOVES = [Move(sign * LENGTH, curvature) for sign in (1, -1) for curvature in (0.0, 1.2, -1.2, 0.6, -0.6)]
HALVES = [Move(move.way / 2, move.curvature) for move in MOVES]
BACKWARDS = 1.5  # times the cost of driving forwards
CUSP = 0.5  # m of driving that a change of direction costs
TIGHT = 3.0  # m of driving that a move costs where there is no margin
MARGIN, LEAST_MARGIN = 0.12, 0.05  # m: to be kept; to be left where the cart stands nearer already
HEADINGS = 24  # of the search
MOST_POSES = 20000

Key = tuple[int, int, int]


def key_of(pose: Pose) -> Key:
    return *cell_of(pose.x, pose.y), round(pose.heading / (2 * math.pi) * HEADINGS) % HEADINGS


def fits(passable: np.ndarray, pose: Pose) -> bool:
    sin, cos = facing(pose.heading)
    return all(passable[cell_of(pose.x + way * cos, pose.y + way * sin)] for way in CIRCLES_AT)


def swerves(last: Move, move: Move) -> bool:
    """True if the wheels would have to be turned too far on the way."""
    return last.way * move.way > 0 and abs(last.curvature - move.curvature) > 1.3


def find_way(floor: FloorMap, start: Pose) -> list[Move]:
    """The cheapest moves to a place that covers much new floor (Dijkstra's algorithm over places and headings). None if there
    is no such place."""
    roomy, tight, gain = floor.passable(MARGIN), floor.passable(LEAST_MARGIN), floor.gain()
    open_list: list[tuple[float, int, Pose, Key | None, Move | None]] = [(0.0, 0, start, None, None)]
    came: dict[Key, tuple[Key | None, Move | None]] = {}
    count = 0
    while open_list and len(came) < MOST_POSES:
        cost, _, pose, before, last = heapq.heappop(open_list)
        here = key_of(pose)
        if here in came:
            continue
        came[here] = before, last
        has_room = fits(roomy, pose)
        if last and has_room and gain[cell_of(*ahead(pose, CENTRE_AT))] >= floor.worthwhile:
            return way_to(came, here)
        for move, half in zip(MOVES, HALVES):
            if last and swerves(last, move):
                continue
            end = along(pose, move)
            if key_of(end) in came:
                continue
            middle = along(pose, half)
            more = abs(move.way) * (BACKWARDS if move.way < 0 else 1.0)
            if last and last.way * move.way < 0:
                more += CUSP
            if not (fits(roomy, middle) and fits(roomy, end)):
                if has_room or not (fits(tight, middle) and fits(tight, end)):
                    continue
                more += TIGHT
            count += 1  # equal costs: the first found
            heapq.heappush(open_list, (cost + more, count, end, here, move))
    return []


def way_to(came: dict[Key, tuple[Key | None, Move | None]], last: Key) -> list[Move]:
    moves = []
    before, move = came[last]
    while before is not None and move is not None:
        moves.append(move)
        before, move = came[before]
    return moves[::-1]
