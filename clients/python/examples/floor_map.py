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
from visum.trig import hypotenuse, sin_cos, sine

CELL = 0.05  # m
HALF_SIZE = 160  # cells: the map reaches 8 m each way
SIDE = 2 * HALF_SIZE
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


# The circles of a pose share its heading.
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
    way, (sin, cos) = chord(move), facing(pose.heading + turn / 2)
    return Pose(pose.x + way * cos, pose.y + way * sin, pose.heading + turn)


def cell_of(x: float, y: float) -> tuple[int, int]:
    return math.floor(x / CELL) + HALF_SIZE, math.floor(y / CELL) + HALF_SIZE


@lru_cache
def half_widths(radius: float) -> list[int]:
    """By rows from the middle of a disc: how many cells it has to each side."""
    reach = math.floor(radius / CELL)
    return [max(j for j in range(reach + 1) if hypotenuse(i, j) * CELL <= radius) for i in range(reach + 1)]


def disc(radius: float) -> list[tuple[int, int]]:
    """Offsets of the cells whose centres are within the radius."""
    widths = half_widths(radius)
    return [(i, j) for i in range(1 - len(widths), len(widths)) for j in range(-widths[abs(i)], widths[abs(i)] + 1)]


def sum_around(cells: np.ndarray, radius: float) -> np.ndarray:
    """For each cell the sum of all cells within the radius; of booleans, whether one of them is true."""
    widths = half_widths(radius)
    everywhere = np.zeros_like(cells)
    # Beyond the part where cells are not 0, and the radius, the sums are 0.
    where = [np.flatnonzero(cells.any(axis=axis)) for axis in (1, 0)]
    if not len(where[0]):
        return everywhere
    part = tuple(slice(max(0, some[0] - widths[0]), some[-1] + widths[0] + 1) for some in where)
    cells, result = cells[part], everywhere[part]
    rows = cells.copy()
    for width in range(widths[0] + 1):
        if width:  # each cell has the sum of its row, so far to both sides
            rows[:, width:] += cells[:, :-width]
            rows[:, :-width] += cells[:, width:]
        for i, wide in enumerate(widths):
            if wide == width:
                result[i:] += rows[:-i or None]
                if i:
                    result[:-i] += rows[i:]
    return everywhere


class FloorMap:
    def __init__(self, cover_radius: float) -> None:
        self._evidence = np.zeros((SIDE, SIDE), dtype=np.int16)
        self._covered = np.zeros((SIDE, SIDE), dtype=bool)
        self._near_walls: np.ndarray | None = None
        self._cover_radius, self._cover = cover_radius, np.array(disc(cover_radius))
        self.worthwhile = len(self._cover) // 8  # cells to be covered anew, to go somewhere

    def see(self, eye: tuple[float, float], angles: np.ndarray, distances: np.ndarray, farthest: float) -> None:
        """Takes in a scan: free along each ray, something at its end unless that is the sensor's reach."""
        if not len(distances):
            return
        steps = np.arange(0.0, farthest, CELL / 2)
        counts = np.searchsorted(steps, distances - CELL)  # of each ray's steps before its end
        passed = np.flatnonzero(np.arange(len(steps)) < counts[:, None])  # by ray and step
        sin, cos = sin_cos(angles)
        hit = distances < farthest - CELL
        # And the cell of the eye, from which all rays come.
        x, y = (np.append(np.multiply.outer(part, steps).take(passed), 0.0) for part in (cos, sin))
        self._weigh(eye[0] + x, eye[1] + y, PASS)
        self._weigh(eye[0] + (distances * cos)[hit], eye[1] + (distances * sin)[hit], HIT)

    def _weigh(self, x: np.ndarray, y: np.ndarray, weight: int) -> None:
        """Adds to the evidence of the places' cells: once for each cell, however many rays have gone through it."""
        # In place, since a scan has ten thousand steps
        x, y = (np.floor(place, out=place) for place in (np.divide(x, CELL, out=x), np.divide(y, CELL, out=y)))
        x += HALF_SIZE
        y += HALF_SIZE
        inside = (x >= 0) & (x < SIDE) & (y >= 0) & (y < SIDE)
        x *= SIDE
        x += y
        marks = np.zeros(self._evidence.size, dtype=bool)
        marks[x[inside].astype(np.intp)] = True
        touched = np.flatnonzero(marks)
        self._near_walls = None
        self._evidence.put(touched, np.minimum(np.maximum(self._evidence.take(touched) + weight, LEAST), MOST))

    def _free(self) -> np.ndarray:
        return self._evidence < 0

    def _occupied(self) -> np.ndarray:
        return self._evidence >= SOMETHING

    def near_walls(self) -> np.ndarray:
        """The more, the nearer a cell is to a wall. With a border of 0, for what lies beyond the map. It is found once for a map,
        so whoever has time before align() may call it then."""
        if self._near_walls is None:
            walls = self._occupied()
            self._near_walls = np.zeros((SIDE + 2, SIDE + 2), dtype=np.int16)
            for radius in (0.0, CELL, 2 * CELL):
                self._near_walls[1:-1, 1:-1] += sum_around(walls, radius)
            self._near_walls.flags.writeable = False
        return self._near_walls

    def align(self, pose: Pose, points: np.ndarray) -> Pose:
        """The pose near this one from which a scan's points, in the cart's frame, lie best on what has been seen before."""
        near_walls = self.near_walls()
        forward, aside = points.T.copy()

        def cells(places: list[float], first: np.ndarray, second: np.ndarray) -> np.ndarray:
            """The row or column in near_walls, by place, heading and point: of a place plus both parts of a turned point."""
            found = np.floor((np.array(places)[:, None, None] + first + second) / CELL) + (HALF_SIZE + 1)
            return np.minimum(np.maximum(found, 0.0), SIDE + 1.0).astype(np.intp)

        def scores(x: list[float], y: list[float], headings: list[float]) -> np.ndarray:
            """By x, y and heading: how well the points lie on walls."""
            sin, cos = np.array([sin_cos(heading) for heading in headings]).T[:, :, None]
            i, j = cells(x, forward * cos, -aside * sin), cells(y, forward * sin, aside * cos)
            return near_walls.take(i[:, None] * (SIDE + 2) + j).sum(axis=3)

        best, most = pose, scores(*([value] for value in pose)).item()
        for step in (0.03, 0.015, 0.0075):  # m, and rad
            tried = [[value - step, value, value + step] for value in best]
            reached = scores(*tried)
            if reached.max() > most:
                most = reached.max()
                best = Pose(*(values[k] for values, k in zip(tried, np.unravel_index(reached.argmax(), reached.shape))))
        return best

    def cover(self, pose: Pose) -> None:
        """The cart was here: it has covered what is near, and stands on free floor."""
        centre = cell_of(*ahead(pose, CENTRE_AT))
        self._covered[self._cover[:, 0] + centre[0], self._cover[:, 1] + centre[1]] = True
        self._near_walls = None
        for way in CIRCLES_AT:
            self._evidence[cell_of(*ahead(pose, way))] = LEAST

    def passable(self, margin: float) -> np.ndarray:
        """The cells where a circle of the cart may be: seen free, and far enough from everything. Not at the map's border, so
        that no move leaves the map."""
        result = sum_around(self._free(), BETWEEN_RAYS) & ~sum_around(self._occupied(), CIRCLE_RADIUS + margin)
        for side in (result, result.T):
            side[:BORDER] = side[-BORDER:] = False
        return result

    def gain(self) -> np.ndarray:
        """For each cell, the amount of free floor that the cart would newly cover from there."""
        return sum_around((self._free() & ~self._covered).astype(np.int16), self._cover_radius)


LENGTH = 0.3  # m, of a move
MOVES = [Move(sign * LENGTH, curvature) for sign in (1, -1) for curvature in (0.0, 1.2, -1.2, 0.6, -0.6)]
HALVES = [Move(move.way / 2, move.curvature) for move in MOVES]
BACKWARDS = 1.5  # times the cost of driving forwards
CUSP = 0.5  # m of driving that a change of direction costs
TIGHT = 3.0  # m of driving that a move costs where there is no margin
MARGIN, LEAST_MARGIN = 0.12, 0.05  # m: to be kept; to be left where the cart stands nearer already
HEADINGS = 24  # of the search
MOST_POSES = 20000


def direction_of(heading: float) -> int:
    return round(heading / (2 * math.pi) * HEADINGS) % HEADINGS


def cell_number(x: float, y: float) -> int:
    """Counts the cells of cell_of() row by row."""
    return (math.floor(x / CELL) + HALF_SIZE) * SIDE + math.floor(y / CELL) + HALF_SIZE


def swerves(last: Move, move: Move) -> bool:
    """True if the wheels would have to be turned too far on the way."""
    return last.way * move.way > 0 and abs(last.curvature - move.curvature) > 1.3


def cost_of(last: Move | None, move: Move) -> float:
    cost = abs(move.way) * (BACKWARDS if move.way < 0 else 1.0)
    return cost + CUSP if last and last.way * move.way < 0 else cost


# The moves that may follow each move, with their costs.
NEXT = {last: [(k, cost_of(last, move)) for k, move in enumerate(MOVES) if not (last and swerves(last, move))]
        for last in [None, *MOVES]}


def circles(pose: Pose) -> list[tuple[float, float]]:
    """The circles that cover the cart, from its place."""
    sin, cos = facing(pose.heading)
    return [(way * cos, way * sin) for way in CIRCLES_AT]


class Steps:
    """Where each of MOVES leads from a heading: from (0, 0), so that a search finds it once for all places."""

    def __init__(self, heading: float) -> None:
        start = Pose(0.0, 0.0, heading)
        ends = [along(start, move) for move in MOVES]
        self.to = [(end.x, end.y, end.heading, direction_of(end.heading)) for end in ends]
        self.centre = ahead(start, CENTRE_AT)
        self.circles_at_end = [circles(end) for end in ends]
        self.halfway = [(half.x, half.y, circles(half)) for half in (along(start, half) for half in HALVES)]


def fits(passable: bytes, x: float, y: float, covering: list[tuple[float, float]]) -> bool:
    """True if the cart may be at a place: what is `passable` row by row, and its circles from that place."""
    for i, j in covering:
        if not passable[cell_number(x + i, y + j)]:
            return False
    return True


def find_way(floor: FloorMap, start: Pose) -> list[Move]:
    """The cheapest moves to a place that covers much new floor (Dijkstra's algorithm over places and headings). None if there
    is no such place."""
    roomy, tight = floor.passable(MARGIN).tobytes(), floor.passable(LEAST_MARGIN).tobytes()
    worthwhile = (floor.gain() >= floor.worthwhile).tobytes()
    # A node is a cell with a direction.
    first = cell_number(start.x, start.y) * HEADINGS + direction_of(start.heading)
    room_at_start = fits(roomy, start.x, start.y, circles(start))
    open_list: list[tuple[float, int, float, float, float, int, bool, int | None, Move | None]] = [
        (0.0, 0, *start, first, room_at_start, None, None)]
    came: dict[int, tuple[int | None, Move | None]] = {}
    cheapest: dict[int, float] = {first: 0.0}
    steps_from: dict[float, Steps] = {}
    count = 0
    while open_list and len(came) < MOST_POSES:
        cost, _, x, y, heading, here, has_room, before, last = heapq.heappop(open_list)
        if here in came:
            continue
        came[here] = before, last
        if heading not in steps_from:
            steps_from[heading] = Steps(heading)
        steps = steps_from[heading]
        if last and has_room and worthwhile[cell_number(x + steps.centre[0], y + steps.centre[1])]:
            return way_to(came, here)
        for k, more in NEXT[last]:
            by_x, by_y, turned, headed = steps.to[k]
            end_x, end_y = x + by_x, y + by_y
            end = cell_number(end_x, end_y) * HEADINGS + headed
            # Equal costs: the first found
            if cheapest.get(end, math.inf) <= cost + more:
                continue
            half_x, half_y, halfway = steps.halfway[k]
            half_x, half_y, at_end = x + half_x, y + half_y, steps.circles_at_end[k]
            room_at_end = fits(roomy, end_x, end_y, at_end)
            if not (room_at_end and fits(roomy, half_x, half_y, halfway)):
                if has_room or not (fits(tight, half_x, half_y, halfway) and fits(tight, end_x, end_y, at_end)):
                    continue
                more += TIGHT
                if cheapest.get(end, math.inf) <= cost + more:
                    continue
            cheapest[end] = cost + more
            count += 1
            heapq.heappush(open_list, (cost + more, count, end_x, end_y, turned, end, room_at_end, here, MOVES[k]))
    return []


def way_to(came: dict[int, tuple[int | None, Move | None]], last: int) -> list[Move]:
    moves = []
    before, move = came[last]
    while before is not None and move is not None:
        moves.append(move)
        before, move = came[before]
    return moves[::-1]
