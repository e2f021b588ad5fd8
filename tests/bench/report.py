#!/usr/bin/env python3
"""Writes the measurements of tests/bench/run as a file of results, tables and plots.

usage: report.py SCRATCH OUT --compiler-from BUILD
SCRATCH holds bench.json (Google Benchmark's) and perhaps load.json (visum-load's). Writes OUT/<machine>.json,
OUT/<machine>-*.svg and a page OUT/<machine>.md with all of it; prints tables. Where a benchmark was
repeated, the fastest time and the median of each counter are taken.
"""

import argparse
import json
import os
import re
import subprocess
from datetime import datetime, timezone
from pathlib import Path
from statistics import median

from plots import numbers_of, plots_of
from report_page import convergence_lines, growth_lines, page

ROOT = Path(__file__).resolve().parents[2]
NO_COUNTERS = {"name", "run_name", "run_type", "repetitions", "repetition_index", "threads", "iterations", "real_time",
               "cpu_time", "time_unit", "family_index", "per_family_instance_index", "label"}
UNIT_US = {"ns": 1e-3, "us": 1.0, "ms": 1e3, "s": 1e6}


def cpu_model():
    for row in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
        if row.startswith("model name"):
            return row.split(":", 1)[1].strip()
    return os.uname().machine


def machine_name():
    """The machine's name in the names of files of results."""
    return re.sub(r"[^a-z0-9]+", "-", f"{cpu_model()} {os.cpu_count()}".lower()).strip("-")


def compiler(build):
    for path in build.glob("CMakeFiles/*/CMakeCXXCompiler.cmake"):
        facts = dict(re.findall(r'set\((\w+) "([^"]*)"\)', path.read_text(encoding="utf-8")))
        return f'{facts["CMAKE_CXX_COMPILER_ID"]} {facts["CMAKE_CXX_COMPILER_VERSION"]}'
    raise SystemExit(f"report.py: cannot tell the compiler of '{build}'; configure it with CMake first")


def git(*arguments):
    result = subprocess.run(["git", "-C", ROOT, *arguments], capture_output=True, text=True, check=False)
    return result.stdout.strip()


def commit():
    changed = git("status", "--porcelain", "--untracked-files=no", "--", ".", ":!tests/bench/results")
    return (git("rev-parse", "--short=12", "HEAD") or "unknown") + ("+changes" if changed else "")


def name_of(run):
    """Takes away the settings of time and iterations that Google Benchmark adds to a name."""
    name = re.sub(r"/(min_time|iterations|repeats|min_warmup_time):[^/]*", "", run["run_name"])
    return re.sub(r"/(real_time|process_time|manual_time)$", "", name)


def benchmarks(raw):
    """By name: the fastest time of the repetitions in µs, and the median of each counter."""
    runs = {}
    for run in raw["benchmarks"]:
        if run["run_type"] == "iteration":
            runs.setdefault(name_of(run), []).append(run)
    rows = {}
    for name, repeated in runs.items():
        failed = [run["error_message"] for run in repeated if run.get("error_occurred")]
        if failed:
            rows[name] = {"error": failed[0]}
            continue
        scale = UNIT_US[repeated[0]["time_unit"]]
        rows[name] = {"cpu_us": min(run["cpu_time"] for run in repeated) * scale,
                      "real_us": min(run["real_time"] for run in repeated) * scale}
        for counter in sorted(repeated[0].keys() - NO_COUNTERS):
            rows[name][counter] = median(run[counter] for run in repeated)
    return rows


def collect(scratch, build):
    raw = json.loads((scratch / "bench.json").read_text(encoding="utf-8"))
    results = {"machine": {"cpu": cpu_model(), "cores": os.cpu_count(), "kernel": os.uname().release,
                           "load_average": raw["context"].get("load_avg", [])},
               "compiler": compiler(build), "commit": commit(),
               "date": datetime.now(timezone.utc).isoformat(timespec="seconds"), "benchmarks": benchmarks(raw)}
    results |= numbers_of(results["benchmarks"])
    if (scratch / "load.json").exists():
        results["load"] = json.loads((scratch / "load.json").read_text(encoding="utf-8"))
    return results


def print_tables(results):
    machine = results["machine"]
    print(f'\n{machine["cpu"]}, {machine["cores"]} cores; {results["compiler"]}; commit {results["commit"]}\n')
    family = None
    for name, row in results["benchmarks"].items():
        if name.rsplit("/", 1)[0] != family:
            family = name.rsplit("/", 1)[0]
            print()
        if "error" in row:
            print(f'{name:44} {row["error"]}')
            continue
        counters = "  ".join(f"{key} {value:.4g}" for key, value in row.items() if key not in ("cpu_us", "real_us"))
        print(f'{name:44} {row["cpu_us"]:12.3f} us CPU {row["real_us"]:12.3f} us  {counters}')
    for name, value in results.get("load", {}).items():
        print(f"Load: {name:28} {value:g}")
    print()
    print("\n".join(convergence_lines(results["convergence"]) + growth_lines(results["growth"])))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scratch", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--compiler-from", type=Path, required=True, metavar="BUILD")
    options = parser.parse_args()
    results = collect(options.scratch, options.compiler_from)
    machine = machine_name()
    options.out.mkdir(parents=True, exist_ok=True)
    path = options.out / f"{machine}.json"
    path.write_text(json.dumps(results, indent=1) + "\n", encoding="utf-8")
    plot_files = {}
    for name, picture in plots_of(results["benchmarks"]):
        plot_files[name] = f"{machine}-{name}.svg"
        (options.out / plot_files[name]).write_text(picture, encoding="utf-8")
    (options.out / f"{machine}.md").write_text(page(results, plot_files), encoding="utf-8")
    print_tables(results)
    print(f"\nwritten: {path}, and beside it the page and the plots")


if __name__ == "__main__":
    main()
