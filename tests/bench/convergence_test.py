"""Checks the order and the cost of a precision that tests/bench reports, with runs whose answer is known."""

import unittest

from convergence import convergence, cost, growth, order
from plots import numbers_of, plots_of
from report_page import page

STEPS_S = (1e-2, 5e-3, 4e-3, 2e-3, 1e-3, 5e-4, 2.5e-4)


def known_benchmarks():
    """Runs of order 2 with an error of 0.01 m at 10 ms, and four-bars whose cost grows with their number."""
    found = {f"Swing/arm7/e/{1e6 * h:.0f}us": {"cpu_us": 1e3 / h, "real_us": 1e3 / h, "tip_error_m": 100.0 * h**2}
             for h in STEPS_S}
    return found | {f"Step/fourbars{n}/e": {"cpu_us": 2.0 * n, "real_us": 2.0 * n} for n in (10, 20, 40)}


class Convergence(unittest.TestCase):
    def test_order_is_that_of_a_power_law(self):
        for power in (1, 2, 4):
            found = order([(h, 3e3 * h**power if power > 1 else h) for h in STEPS_S])
            self.assertAlmostEqual(found, power, places=9)

    def test_order_leaves_out_what_the_reference_does_not_know(self):
        points = [(h, max(1e6 * h**6, 2e-11)) for h in STEPS_S]
        self.assertLess(min(error for _, error in points), 1e-10)
        self.assertAlmostEqual(order(points), 6.0, places=9)
        self.assertAlmostEqual(order(points, finest=True), 6.0, places=9)

    def test_a_floor_of_gaps_shows_in_the_finest_decade_only(self):
        points = [(h, 4e4 * h**4 + 1e-8) for h in STEPS_S]
        self.assertAlmostEqual(order(points), 4.0, delta=0.1)
        self.assertLess(order(points, finest=True), 3.5)

    def test_what_does_not_converge_has_no_order(self):
        self.assertIsNone(order([(h, 0.6) for h in STEPS_S]))

    def test_cost_is_interpolated_between_two_steps(self):
        points = [(h, 1.0 / h, h**2) for h in STEPS_S]  # error = cost^-2
        seconds, at_most = cost(points, 3e-6)
        self.assertAlmostEqual(seconds, 3e-6**-0.5, places=6)
        self.assertFalse(at_most)

    def test_cost_is_a_bound_where_the_coarsest_step_is_better(self):
        self.assertEqual(cost([(h, 1.0 / h, h**2) for h in STEPS_S], 1e-2), (1.0 / 1e-2, True))

    def test_what_is_not_reached_has_no_cost(self):
        self.assertEqual(cost([(h, 1.0 / h, h**2) for h in STEPS_S], 1e-9), (None, False))

    def test_a_lucky_coarse_step_is_no_cost(self):
        points = [(4e-3, 1.0, 1e-9), (2e-3, 2.0, 1e-2), (1e-3, 4.0, 1e-4)]
        seconds, _ = cost(points, 1e-3)
        self.assertTrue(2.0 < seconds < 4.0)

    def test_growth_is_a_power_of_the_number(self):
        self.assertAlmostEqual(growth([("e", n, 7.0 * n**3) for n in (8, 64, 512)])["e"], 3.0, places=9)

    def test_report_and_legend_show_what_was_found(self):
        benchmarks = known_benchmarks()
        self.assertAlmostEqual(numbers_of(benchmarks)["convergence"]["e"]["order"], 2.0)
        pictures = dict(plots_of(benchmarks))
        self.assertIn("h^2.00", pictures["convergence"])
        self.assertIn("n^1.00", pictures["fourbars"])
        self.assertEqual(convergence([]), {})

    def test_page_shows_it_too_and_what_failed(self):
        benchmarks = known_benchmarks() | {"Step/chain512/f": {"error": "breaks"}}
        results = {"machine": {"cpu": "c", "cores": 2, "load_average": [0.5]}, "compiler": "g", "commit": "1", "date": "d",
                   "benchmarks": benchmarks} | numbers_of(benchmarks)
        text = page(results, {"convergence": "c.svg"})
        self.assertIn("| e | 2.00 | 2.00 | 316 | 1e+03 | not reached |", text)
        self.assertIn("| e | — | 1 |", text)
        self.assertIn("| Step/chain512/f | breaks |", text)
        self.assertIn("(c.svg)", text)


if __name__ == "__main__":
    unittest.main()
