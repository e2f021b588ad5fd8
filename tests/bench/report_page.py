"""The results as a page of Markdown, with the plots beside it."""

import textwrap

TIMES = ("cpu_us", "real_us")


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|" + " --- |" * len(head)]
    lines += ["| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |" for row in rows]
    return lines + [""]


def wrapped(text):
    """Prose, wrapped as in all pages."""
    return textwrap.fill(text, 100, break_long_words=False, break_on_hyphens=False)


def shown(value):
    return "—" if value is None else f"{value:.4g}"


def seconds_at(found):
    if found is None:
        return "not reached"
    return ("≤ " if found["at_most"] else "") + f'{1e3 * found["cpu_s"]:.3g}'


def convergence_lines(convergence):
    """Order of each engine, and the cost of precision."""
    if not convergence:
        return []
    errors = list(next(iter(convergence.values()))["cpu_s_at"])
    rows = [[engine, *("—" if found[of] is None else f"{found[of]:.2f}" for of in ("order", "order_finest")),
             *(seconds_at(found["cpu_s_at"][error]) for error in errors)] for engine, found in convergence.items()]
    return ["## Convergence and the cost of precision", "",
            wrapped("arm7 swings free for 1 s. Order: slope of the tip's error over the step, in the coarsest decade "
                    "of steps with errors from 0.1 m to 1e-10 m, and in the finest, where gaps that joints may have "
                    "(`d_max`) weigh more; — if there are fewer than three such errors. The other columns: CPU ms per "
                    "simulated second for the given error of the tip, interpolated."), "",
            *table(["engine", "order", "in the finest decade", *(f"ms at {error} m" for error in errors)], rows)]


def growth_lines(growth):
    """The power of the count with which a step's cost grows."""
    engines = list(dict.fromkeys(engine for found in growth.values() for engine in found))
    if not engines:
        return []
    rows = [[engine, *(shown(found.get(engine)) for found in growth.values())] for engine in engines]
    return ["## Growth of a step's cost", "", "Power of the number of links, or of four-bars in a row.", "",
            *table(["engine", *growth], rows)]


def benchmark_lines(benchmarks):
    """A table for each family, with the counters that its members have."""
    lines = ["## All benchmarks", ""]
    families = {}
    for name, row in benchmarks.items():
        families.setdefault(name.split("/", 1)[0], []).append((name, row))
    for members in families.values():
        counters = list(dict.fromkeys(key for _, row in members for key in row if key not in (*TIMES, "error")))
        rows = [[name, row["error"], *[""] * (1 + len(counters))] if "error" in row else
                [name, *(shown(row[key]) for key in TIMES), *(shown(row.get(key)) for key in counters)]
                for name, row in members]
        lines += table(["name", "CPU µs", "µs", *counters], rows)
    return lines


def page(results, plot_files):
    """`plot_files` by name of the plot, relative to the page."""
    machine = results["machine"]
    lines = [f'# {machine["cpu"]}, {machine["cores"]} cores', "",
             wrapped(f'{results["compiler"]}; commit {results["commit"]}; {results["date"]}; load average at the start '
                     f'{", ".join(f"{load:.2f}" for load in machine["load_average"])}. Written by `tests/bench/run`; '
                     "how to read it: [Benchmarks](../README.md)."), ""]
    lines += convergence_lines(results["convergence"]) + growth_lines(results["growth"])
    lines += [f"![{name}]({file})\n" for name, file in plot_files.items()]
    if "load" in results:
        rows = [[name, f"{value:g}"] for name, value in results["load"].items()]
        lines += ["## Load", "", *table(["figure", "value"], rows)]
    return "\n".join(lines + benchmark_lines(results["benchmarks"]))
