"""Orders and costs from runs that differ in their step: the plots, as numbers."""

import math
from collections import defaultdict

CONVERGES_BELOW_M = 0.1  # a larger error says nothing about the order
REFERENCE_KNOWN_TO_M = 1e-10  # below it one sees rounding and the reference's own error (1e-11)
DECADE = 10.0 * (1.0 + 1e-9)
ASKED_ERRORS_M = (1e-3, 1e-4, 1e-6)


def slope(points):
    """The slope of log y over log x, by least squares; None if there are fewer than three points."""
    if len(points) < 3:
        return None
    logs = [(math.log(x), math.log(y)) for x, y in points]
    mean_x = sum(x for x, _ in logs) / len(logs)
    mean_y = sum(y for _, y in logs) / len(logs)
    spread = sum((x - mean_x) ** 2 for x, _ in logs)
    return sum((x - mean_x) * (y - mean_y) for x, y in logs) / spread if spread > 0.0 else None


def order(points, finest=False):
    """From points (step, error): the slope over the coarsest decade of steps with usable errors. There the step's own
    error shows. Over the finest decade the slope may be smaller, because gaps that joints may have weigh more."""
    telling = [(h, error) for h, error in points if REFERENCE_KNOWN_TO_M < error < CONVERGES_BELOW_M]
    if not telling:
        return None
    if finest:
        least = min(h for h, _ in telling)
        return slope([(h, error) for h, error in telling if h <= DECADE * least])
    most = max(h for h, _ in telling)
    return slope([(h, error) for h, error in telling if DECADE * h >= most])


def cost(points, wanted):
    """From points (step, cost, error): the cost at which the error is `wanted`. It interpolates the logarithms between
    the coarsest step from which on all finer steps reach it, and the next one. (None, False) if no step reaches it.
    The second value says that even the coarsest step is more accurate, so that the cost is an upper bound."""
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
    `order_finest` over the finest decade of steps (None if unknown), and `cpu_s_at`, by tip error."""
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
    """By engine, from (engine, count, µs): the power of the count with which a step's cost grows."""
    by_engine = defaultdict(list)
    for engine, count, cpu_us in rows:
        by_engine[engine].append((count, cpu_us))
    return {engine: slope(points) for engine, points in by_engine.items()}
