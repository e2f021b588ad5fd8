"""The plots of the results, made from benchmarks by name, e.g. "Swing/arm7/impulse/1000us"."""

import re

from convergence import convergence, growth
from plot import Series, log_log

MAX_USEFUL_ERROR_M = 1.0  # with a larger error the arm points anywhere


def swings(benchmarks):
    """(engine, step in s, CPU s per simulated s, tip error in m) of every swing that stayed together."""
    for name, row in benchmarks.items():
        found = re.fullmatch(r"Swing/arm7/(.+)/(\d+)us", name)
        if found and 0.0 < row.get("tip_error_m", 0.0) < MAX_USEFUL_ERROR_M:
            yield found[1], 1e-6 * int(found[2]), 1e-6 * row["cpu_us"], row["tip_error_m"]


def steps(benchmarks, model):
    """(engine, count, µs per step) of models of several sizes: chains, rows of four-bars."""
    for name, row in benchmarks.items():
        found = re.fullmatch(rf"Step/{model}(\d+)/(.+)", name)
        if found and "cpu_us" in row:
            yield found[2], int(found[1]), row["cpu_us"]


def by_engine(rows, slopes, sign):
    """`sign` stands before an engine's slope in the legend."""
    series = {}
    for engine, x, y in rows:
        slope = slopes.get(engine)
        name = engine if slope is None else f"{engine}  {sign}{slope:.2f}"
        series.setdefault(engine, Series(name)).points.append((x, y))
    return list(series.values())


def numbers_of(benchmarks):
    """The plots in numbers: order and cost of precision of each engine, growth of a step's cost."""
    return {"convergence": convergence(swings(benchmarks)),
            "growth": {model: growth(steps(benchmarks, model)) for model in ("chain", "fourbars")}}


def plots_of(benchmarks):
    """(name, SVG) of every plot for which there are figures."""
    runs = list(swings(benchmarks))
    numbers = numbers_of(benchmarks)
    orders = {engine: found["order"] for engine, found in numbers["convergence"].items()}
    pictures = [
        ("work-precision", log_log("arm7: work against precision", "CPU seconds per simulated second",
                                   "tip error after 1 s, m", by_engine([(e, cpu, error) for e, _, cpu, error in runs],
                                                                       {}, ""))),
        ("convergence", log_log("arm7: convergence, with the order of each", "step, s", "tip error after 1 s, m",
                                by_engine([(e, h, error) for e, h, _, error in runs], orders, "h^"))),
        ("chain", log_log("chain: cost of a step", "links", "CPU µs per step",
                          by_engine(steps(benchmarks, "chain"), numbers["growth"]["chain"], "n^"))),
        ("fourbars", log_log("four-bars in a row: cost of a step", "four-bars", "CPU µs per step",
                             by_engine(steps(benchmarks, "fourbars"), numbers["growth"]["fourbars"], "n^"))),
    ]
    return [(name, picture) for name, picture in pictures if picture]
