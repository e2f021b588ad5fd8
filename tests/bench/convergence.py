"""Orders and costs from runs that differ in their step: what the plots show, as numbers."""

import math
from collections import defaultdict

CONVERGES_BELOW_M = 0.1  # beyond, an error says nothing of the order
REFERENCE_KNOWN_TO_M = 1e-10  # below, it is the reference's own error (1e-11) that is seen, and rounding
DECADE = 10.0 * (1.0 + 1e-9)
ASKED_ERRORS_M = (1e-3, 1e-4, 1e-6)


def slope(points):
    """Of log y over log x, by least squares; None where there are fewer than three points."""
    if len(points) < 3:
        return None
    logs = [(math.log(x), math.log(y)) for x, y in points]
    mean_x = sum(x for x, _ in logs) / len(logs)
    mean_y = sum(y for _, y in logs) / len(logs)
    spread = sum((x - mean_x) ** 2 for x, _ in logs)
    return sum((x - mean_x) * (y - mean_y) for x, y in logs) / spread if spread > 0.0 else None


def order(points, finest=False):
    """Of (step, error): the slope over the coarsest decade of steps whose errors tell of it, where the step's own error
    is seen; over the finest decade it may be less, where what is left of gaps is."""
    telling = [(h, error) for h, error in points if REFERENCE_KNOWN_TO_M < error < CONVERGES_BELOW_M]
    if not telling:
        return None
    if finest:
        least = min(h for h, _ in telling)
        return slope([(h, error) for h, error in telling if h <= DECADE * least])
    most = max(h for h, _ in telling)
    return slope([(h, error) for h, error in telling if DECADE * h >= most])


def cost(points, wanted):
    """Of (step, cost, error): the cost at which the error is `wanted`, by interpolation of the logarithms between
    the coarsest step from which on all finer ones reach it and the next; (None, False) where none does. The second
    says that even the coarsest step is more accurate, and the cost an upper bound."""
    coarser = None
    reached = None
    for point in sorted(points):
        if point[2] > wanted:
            coarser = point
            break
        reached = point
    if reached is None:
        return None, False
    if coarser is None:
        return reached[1], True
    share = math.log(wanted / reached[2]) / math.log(coarser[2] / reached[2])
    return math.exp(math.log(reached[1]) + share * math.log(coarser[1] / reached[1])), False


def convergence(runs):
    """By engine, from (engine, step in s, CPU s per simulated s, tip error in m): `order` over the coarsest and
    `order_finest` over the finest decade of steps, None where it cannot be told, and `cpu_s_at`, by tip error."""
    by_engine = defaultdict(list)
    for engine, h, cpu, error in runs:
        by_engine[engine].append((h, cpu, error))
    found = {}
    for engine, points in by_engine.items():
        costs = {}
        for wanted in ASKED_ERRORS_M:
            seconds, at_most = cost(points, wanted)
            costs[f"{wanted:.0e}"] = None if seconds is None else {"cpu_s": seconds, "at_most": at_most}
        errors = [(h, error) for h, _, error in points]
        found[engine] = {"order": order(errors), "order_finest": order(errors, finest=True), "cpu_s_at": costs}
    return found


def growth(rows):
    """By engine, from (engine, how many, µs): the power of their number with which a step's cost grows."""
    by_engine = defaultdict(list)
    for engine, count, cpu_us in rows:
        by_engine[engine].append((count, cpu_us))
    return {engine: slope(points) for engine, points in by_engine.items()}
