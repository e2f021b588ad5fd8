"""visum.trig has the bits of the daemon's own functions, number for number and for arrays."""
import math
import random
import struct
import subprocess
import sys
import unittest

import numpy as np

from programs import BIN, DEADLINE_S

sys.path.insert(0, str(BIN.parent / "python"))
from visum import trig  # noqa: E402

EDGES = [0.0, -0.0, 5e-324, 1e-300, 1e-9, 0.4375, 0.6875, 1.1875, 2.4375, math.pi / 4, math.nextafter(math.pi / 4, 1), math.pi / 2, math.pi,
         1.5, 3.0, 1e5, 999_999.5, 1e6, math.nextafter(1e6, 2e6), 1e300]


def bits_of(number):
    return 0x7FF8000000000000 if math.isnan(number) else struct.unpack("<Q", struct.pack("<d", number))[0]


def arguments():
    """Edges in all combinations and signs, then numbers of all sizes that occur, the same in each run."""
    edges = [sign * edge for edge in EDGES for sign in (1, -1)]
    pairs = [(y, x) for y in edges for x in edges]
    numbers = random.Random(7)
    pairs += [(numbers.uniform(-4, 4), numbers.uniform(-4, 4)) for _ in range(20_000)]
    pairs += [tuple(math.copysign(10 ** numbers.uniform(-12, 6), numbers.uniform(-1, 1)) for _ in range(2)) for _ in range(20_000)]
    return pairs


class Trig(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.pairs = arguments()
        lines = "".join(f"{y.hex()} {x.hex()}\n" for y, x in cls.pairs)
        done = subprocess.run([BIN / "visum-test-trig"], input=lines, capture_output=True, text=True, timeout=DEADLINE_S, check=True)
        cls.wanted = [tuple(int(word, 16) for word in line.split()) for line in done.stdout.splitlines()]
        assert len(cls.wanted) == len(cls.pairs)

    def test_each_number_has_the_bits_of_the_daemon(self):
        for (y, x), wanted in zip(self.pairs, self.wanted, strict=True):
            s, c = trig.sin_cos(y)
            self.assertEqual((bits_of(s), bits_of(c), bits_of(trig.tangent(y)), bits_of(trig.arc_tangent(y, x))), wanted, (y, x))
            self.assertEqual((bits_of(trig.sine(y)), bits_of(trig.cosine(y))), wanted[:2])

    def test_so_has_each_number_of_an_array(self):
        s, c = trig.sin_cos(np.array([[y for y, _ in self.pairs]]))
        self.assertEqual([(bits_of(a), bits_of(b)) for a, b in zip(s[0], c[0], strict=True)], [wanted[:2] for wanted in self.wanted])

    def test_a_hypotenuse_agrees_with_the_library(self):
        for i in range(-1000, 1001):
            self.assertAlmostEqual(trig.hypotenuse(i / 7, 2.0), math.hypot(i / 7, 2.0), delta=1e-13)
        self.assertEqual(list(trig.hypotenuse(np.array([3.0, 5.0]), np.array([4.0, 12.0]))), [5.0, 13.0])


if __name__ == "__main__":
    unittest.main()
