"""The explorer's map and its search, without a world: scans are made here."""
import math
import pathlib
import resource
import subprocess
import sys
import unittest

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "clients" / "python" / "examples"))
from cart import Pose  # noqa: E402
from explorer import keep_memory  # noqa: E402
from floor_map import CELL, CENTRE_AT, HALF_SIZE, HIT, PASS, SIDE, FloorMap, Move, ahead, along  # noqa: E402
from floor_map import cell_of, circles, disc, find_way, fits, sum_around  # noqa: E402
from visum.trig import sin_cos  # noqa: E402

ANGLES = np.linspace(-math.pi, math.pi, 361)
REACH = 8.0


def distances_in_box(x: float, y: float, heading: float, half: tuple[float, float]) -> np.ndarray:
    """From a place inside a room of 2 `half` around the origin to its walls."""
    cos, sin = np.cos(ANGLES + heading), np.sin(ANGLES + heading)
    with np.errstate(divide="ignore"):
        to_x = np.where(cos > 0, half[0] - x, half[0] + x) / np.abs(cos)
        to_y = np.where(sin > 0, half[1] - y, half[1] + y) / np.abs(sin)
    return np.minimum(np.minimum(to_x, to_y), REACH)


def seen(floor: FloorMap, pose: Pose, half: tuple[float, float]) -> None:
    x, y = ahead(pose, CENTRE_AT)
    floor.see((x, y), ANGLES + pose.heading, distances_in_box(x, y, pose.heading, half), REACH)
    floor.cover(pose)


def fits_at(passable: np.ndarray, pose: Pose) -> bool:
    return fits(passable.tobytes(), pose.x, pose.y, circles(pose))


class Geometry(unittest.TestCase):
    def test_a_move_follows_its_arc(self):
        quarter = along(Pose(1, 2, 0), Move(math.pi / 2, 1.0))
        np.testing.assert_allclose(quarter, (2, 3, math.pi / 2), atol=1e-12)
        np.testing.assert_allclose(along(quarter, Move(-math.pi / 2, 1.0)), (1, 2, 0), atol=1e-12)
        np.testing.assert_allclose(along(Pose(0, 0, math.pi / 2), Move(2, 0)), (0, 2, math.pi / 2), atol=1e-12)

    def test_a_disc_has_the_cells_within_its_radius(self):
        for radius in (0.0, CELL, 0.1, 0.39, 0.4):
            around = [(i, j) for i in range(-9, 10) for j in range(-9, 10) if math.sqrt(i * i + j * j) * CELL <= radius]
            self.assertEqual(disc(radius), around)

    def test_sums_over_a_disc_around_each_cell(self):
        cells = np.random.default_rng(1).integers(0, 9, (30, 40))
        for radius in (0.0, CELL, 0.1, 0.39):
            padded = np.pad(cells, 8)
            expected = sum(padded[8 + i:38 + i, 8 + j:48 + j] for i, j in disc(radius))
            np.testing.assert_array_equal(sum_around(cells, radius), expected)
            np.testing.assert_array_equal(sum_around(cells == 8, radius), sum_around((cells == 8).astype(int), radius) > 0)

    def test_sums_where_few_cells_are_not_0(self):
        for places in ([], [(0, 0)], [(29, 39)], [(12, 20)], [(3, 39), (17, 5)]):
            cells = np.zeros((30, 40), dtype=np.int16)
            for place in places:
                cells[place] = 3
            padded = np.pad(cells, 8)
            expected = sum(padded[8 + i:38 + i, 8 + j:48 + j] for i, j in disc(0.39))
            np.testing.assert_array_equal(sum_around(cells, 0.39), expected)


class Memory(unittest.TestCase):
    def test_is_kept_for_the_next_scan(self):
        """In a process of its own: the C library also keeps memory once something else was large enough."""
        faults = subprocess.run([sys.executable, __file__, "faults"], capture_output=True, text=True, check=True).stdout
        self.assertLess(int(faults), 1000, "without keep_memory() more than ten thousand")


def faults_of_scans() -> int:
    """Page faults of twenty scans: memory that was given back costs some when it is taken again."""
    keep_memory()
    seen(FloorMap(0.4), Pose(), (2.5, 2.0))
    floor = FloorMap(0.4)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
    for _ in range(20):
        seen(floor, Pose(), (2.5, 2.0))
        floor.near_walls()
    return resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before


class Map(unittest.TestCase):
    def setUp(self):
        self.floor = FloorMap(0.4)
        for _ in range(3):
            seen(self.floor, Pose(), (2.5, 2.0))

    def test_takes_in_a_scan_once_for_each_cell(self):
        """As simply as it can be said: ray by ray, and step by step."""
        random = np.random.default_rng(1)
        for eye in ((0.0, 0.0), (1.234, -0.777), (7.9, 7.95), (-8.3, 0.1), (30.0, 30.0)):
            for distances in (random.uniform(0.01, REACH, 61), np.full(61, REACH), np.full(61, REACH - 0.01), np.empty(0)):
                angles = np.linspace(0.3, 6.0, len(distances))
                floor, passed, hit = FloorMap(0.4), set(), set()
                sines, cosines = sin_cos(angles)
                for sin, cos, distance in zip(sines, cosines, distances):
                    ways = [step for step in np.arange(0.0, REACH, CELL / 2) if step < distance - CELL]
                    passed |= {cell_of(eye[0] + way * cos, eye[1] + way * sin) for way in [*ways, 0.0]}
                    if distance < REACH - CELL:
                        hit.add(cell_of(eye[0] + distance * cos, eye[1] + distance * sin))
                expected = np.zeros_like(floor._evidence)
                for cells, weight in ((passed, PASS), (hit, HIT)):
                    for i, j in cells:
                        if 0 <= i < SIDE and 0 <= j < SIDE:
                            expected[i, j] += weight
                floor.see(eye, angles, distances, REACH)
                np.testing.assert_array_equal(floor._evidence, expected)

    def test_keeps_away_from_walls_and_from_what_it_has_not_seen(self):
        roomy = self.floor.passable(0.1)
        self.assertTrue(fits_at(roomy, Pose()))
        self.assertTrue(fits_at(roomy, Pose(0, 1.5, 0)))
        self.assertFalse(fits_at(roomy, Pose(0, 1.75, 0)), "0.25 m from the wall")
        self.assertFalse(fits_at(roomy, Pose(0, 3.0, 0)), "behind the wall")

    def test_lays_a_scan_onto_what_it_has_seen(self):
        true = Pose(0.4, -0.3, 0.2)
        x, y = ahead(true, CENTRE_AT)
        distances = distances_in_box(x, y, true.heading, (2.5, 2.0))
        points = np.column_stack((CENTRE_AT + distances * np.cos(ANGLES), distances * np.sin(ANGLES)))
        found = self.floor.align(Pose(true.x + 0.05, true.y - 0.05, true.heading + 0.03), points)
        self.assertLess(math.hypot(found.x - true.x, found.y - true.y), CELL)
        self.assertLess(abs(found.heading - true.heading), 0.01)

    def test_knows_its_walls_after_each_scan(self):
        before = self.floor.near_walls()
        # The wall at x = 2.5 m lies in the cell behind it.
        row, column = 1 + HALF_SIZE + round(2.5 / CELL), 1 + HALF_SIZE
        self.assertEqual(before[row - 4:row + 1, column].tolist()[-4:], [0, 1, 2, 3])
        self.assertIs(self.floor.near_walls(), before, "found once for a map")
        self.assertEqual(before.max(), 3)
        for _ in range(2):
            self.floor.see((1.0, 0.0), ANGLES, distances_in_box(1.0, 0.0, 0.0, (2.8, 2.0)), REACH)
        self.assertTrue((self.floor.near_walls() != before).any())
        i, j = np.unravel_index(self.floor.near_walls().argmax(), before.shape)
        after = self.floor.near_walls()
        self.floor.cover(Pose((i - 1 - HALF_SIZE + 0.5) * CELL, (j - 1 - HALF_SIZE + 0.5) * CELL, 0.0))
        self.assertLess(self.floor.near_walls()[i, j], after[i, j], "where the cart stands, there is no wall")

    def test_finds_a_way_to_floor_that_it_has_not_been_near(self):
        roomy = self.floor.passable(0.05)
        pose = Pose()
        moves = find_way(self.floor, pose)
        self.assertTrue(moves)
        for move in moves:
            pose = along(pose, move)
            self.assertTrue(fits_at(roomy, pose))
        self.assertGreater(math.hypot(pose.x, pose.y), 0.25)

    def test_ends_where_all_has_been_covered(self):
        for x in np.arange(-2.6, 2.6, 0.2):
            for y in np.arange(-2.0, 2.1, 0.2):
                seen_before = self.floor._evidence.copy()
                self.floor.cover(Pose(x, y, 0))
                self.floor._evidence = seen_before
        self.assertEqual(find_way(self.floor, Pose()), [])

    def test_finds_no_way_out_of_a_box(self):
        floor = FloorMap(0.1)
        for _ in range(3):
            seen(floor, Pose(-CENTRE_AT, 0, 0), (0.45, 0.4))
        self.assertEqual(find_way(floor, Pose(-CENTRE_AT, 0, 0)), [])


if __name__ == "__main__":
    if sys.argv[1:] == ["faults"]:
        print(faults_of_scans())
    else:
        unittest.main()
