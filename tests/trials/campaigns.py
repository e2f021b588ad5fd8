#!/usr/bin/python3
"""Measures campaigns: how fast they are, what a run costs beside its ticks, what their results weigh.

    campaigns.py [--bin FOLDER] [--runs N] [--samples N] [--jobs N] [TRIAL...]

  rates   four scenarios, each as a campaign of N equal runs and as N calls of `visum run` one after another: runs per second of
          wall time, and processor time per run of all processes, which other programs on the machine disturb less
  parts   what a run of one tick costs beside it: without and with a controller that ends at once, as a call of `visum run`, and
          where it is only found again; and the start of each program
  cores   the same campaign with 1 and with --jobs runs at a time: equal hashes, and how much faster
  bytes   results.sqlite and results.csv per million runs
  memory  the largest memory of a process where a shard of ten million runs is made, and where many results are merged and judged
  defect  a corner of 1 in 10,000 of the space of a box that slides: how many runs random, Latin hypercube (at most --samples) and
          the search need to find it

Exit code 0: all went well; 1: something did not.
"""

from __future__ import annotations

import argparse
import csv
import json
import math
import os
import subprocess
import sys
import time
from pathlib import Path

import programs
from programs import SOURCE, expect

MODELS = SOURCE / "models/scenarios"
SCENARIOS = ("two_link_wave", "pick_and_place", "quadruped", "cart")
WORLD = """
visum: 1
engine: impulse
parameters: {friction: 0.5, speed: 1.0}
surfaces: {default: {friction: "${friction}", restitution: 0}}
bodies:
  - {name: floor, fixed: true, shapes: [{plane: true}]}
  - {name: box, mass: 1, pose: {xyz: [0, 0, 0.05]}, velocity: {linear: ["${speed}", 0, 0]}, shapes: [{box: [0.3, 0.3, 0.1]}]}
"""
SLIDE = """
visum_scenario: 1
name: slide
scene: world.yaml
until: {at_s: @UNTIL@}
check_every_ms: @EVERY@
sweep: {friction: {uniform: [0.2, 1]}, speed: {uniform: [0.5, 1.5]}}
sampling: {method: @METHOD@, runs: @RUNS@, seed: 1}
parameters: {friction: "${friction}", speed: "${speed}"}
checks:
  - {name: near, that: {position: {body: box, axis: x}, below: @BELOW@}}
@MORE@
"""
G = 9.81


def cpu_s() -> float:
    times = os.times()
    return times.children_user + times.children_system


def visum(options: argparse.Namespace, *words: object, codes: tuple[int, ...] = (0,)) -> tuple[str, float, float]:
    """Output, wall seconds and processor seconds, those of the processes below it included."""
    cpu, began = cpu_s(), time.monotonic()
    done = subprocess.run([options.bin / "visum", *map(str, words)], capture_output=True, text=True)
    expect(done.returncode in codes, f"{words}: {done.returncode} {done.stderr}")
    return done.stdout, time.monotonic() - began, cpu_s() - cpu


def write_slide(folder: Path, runs: int, below: float = 9.0, until_s: float = 1.0, more: str = "", method: str = "latin_hypercube") -> Path:
    (folder / "world.yaml").write_text(WORLD)
    file = folder / "slide.yaml"
    text = SLIDE
    every_ms = 1 if until_s < 0.1 else 100
    for name, value in (("UNTIL", until_s), ("EVERY", every_ms), ("RUNS", runs), ("BELOW", below), ("MORE", more), ("METHOD", method)):
        text = text.replace(f"@{name}@", str(value))
    file.write_text(text)
    return file


def repeated(name: str, folder: Path, runs: int) -> Path:
    """A shipped scenario, as a campaign of equal runs. It lies elsewhere, so its places become absolute."""
    text = (MODELS / f"{name}.yaml").read_text()
    text = text.replace("scene: ../", f"scene: {MODELS.parent}/").replace("{scenario_dir}", str(MODELS))
    file = folder / f"{name}.yaml"
    file.write_text(text + f"\nsweep: {{again: {{from: 1, to: {max(runs, 2)}}}}}\n")
    return file


def rates(options: argparse.Namespace, folder: Path) -> str:
    lines = []
    for name in SCENARIOS:
        file = repeated(name, folder, options.runs)
        alone_wall = alone_cpu = 0.0
        for run in range(1, options.runs + 1):
            _, wall, cpu = visum(options, "run", file, "--only", run)
            alone_wall += wall
            alone_cpu += cpu
        out, wall, cpu = visum(options, "campaign", file, "--report", folder / name, "--jobs", 1, "--no-recordings", "--json")
        expect(json.loads(out)["passed"] == options.runs, f"{name}: not all passed")
        lines.append(f"{name}: campaign {options.runs / wall:.2f} runs/s, {1e3 * cpu / options.runs:.0f} ms of the processor a run; "
                     f"visum run {options.runs / alone_wall:.2f} runs/s, {1e3 * alone_cpu / options.runs:.0f} ms; "
                     f"{alone_cpu / cpu:.2f} times the processor, {alone_wall / wall:.2f} times the time")
    return "\n  ".join(["", *lines])


def parts(options: argparse.Namespace, folder: Path) -> str:
    runs = options.runs
    file = write_slide(folder, runs, until_s=0.001)
    begin = visum(options, "campaign", write_slide(folder, 1, until_s=0.001), "--report", folder / "one", "--no-recordings")[1:]
    write_slide(folder, runs, until_s=0.001)

    def each(report: str, of: Path = file) -> str:
        """Per run, less what a campaign of one run takes."""
        _, wall, cpu = visum(options, "campaign", of, "--report", folder / report, "--jobs", 1, "--no-recordings")
        return f"{1e3 * (wall - begin[0]) / (runs - 1):.2f} ms ({1e3 * (cpu - begin[1]) / (runs - 1):.2f} of the processor)"

    empty = each("empty")
    again = each("empty")
    alone = [visum(options, "run", file, "--only", run)[1:] for run in range(1, runs + 1)]
    alone_ms = [1e3 * sum(one[i] for one in alone) / runs for i in (0, 1)]

    def controlled(report: str, kind: str) -> str:
        of = folder / f"{report}.yaml"
        controllers = f"settle_s: 0.001\ncontrollers: [{{name: c, {kind}, exchanges: false, command: [sleep, '0.001']}}]"
        of.write_text(file.read_text().replace("until: {at_s: 0.001}", controllers))
        return each(report, of)

    with_controller = controlled("controlled", "joins: false")
    in_step = controlled("in_step", "shim: true")

    def start(*words: object) -> float:
        cpu = cpu_s()
        for _ in range(runs):
            subprocess.run([str(word) for word in words], stdout=subprocess.DEVNULL, check=True)
        return cpu_s() - cpu
    programs_ms = {name: 1e3 * start(options.bin / name, "--version") / runs for name in ("visum", "visumd")}
    scene_ms = 1e3 * start(options.bin / "visumd", "check", folder / "world.yaml") / runs
    return (f"a run of one tick {empty}, with a controller that sleeps for 1 ms {with_controller}, under the time shim {in_step}, as `visum run` {alone_ms[0]:.1f} ms ({alone_ms[1]:.1f}), "
            f"found again {again}; a campaign of one run {1e3 * begin[0]:.0f} ms; start of visum {programs_ms['visum']:.1f} ms of the "
            f"processor, of visumd {programs_ms['visumd']:.1f}, of visumd with the scene {scene_ms:.1f}")


def cores(options: argparse.Namespace, folder: Path) -> str:
    file = write_slide(folder, options.runs)
    told = {}
    for jobs in (1, options.jobs):
        out, wall, cpu = visum(options, "campaign", file, "--report", folder / f"jobs{jobs}", "--jobs", jobs, "--no-recordings", "--json")
        told[jobs] = (json.loads(out)["hash"], wall, cpu)
    one, more = told[1], told[options.jobs]
    expect(one[0] == more[0], "the hashes differ")
    return f"{one[1] / more[1]:.2f} times as fast with {options.jobs} jobs, {more[2] / one[2]:.2f} times the processor; hash {one[0]}"


def most_memory(options: argparse.Namespace, *words: object, codes: tuple[int, ...] = (0,)) -> float:
    """MB of the largest process of the command."""
    measured = subprocess.run(["/usr/bin/python3", "-c", "import resource, subprocess, sys; code = subprocess.run(sys.argv[1:], "
                               "stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL).returncode; "
                               "print(code, resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)", options.bin / "visum", *map(str, words)],
                              capture_output=True, text=True, check=True)
    code, kilobytes = map(int, measured.stdout.split())
    expect(code in codes, f"{words}: {code}")
    return kilobytes / 1e3


def multiply(report: Path, runs: int) -> None:
    """Writes the runs that are there under further numbers, until there are so many."""
    import sqlite3

    with sqlite3.connect(report / "results.sqlite") as results:
        columns = {table: [row[1] for row in results.execute(f"PRAGMA table_info({table})")] for table in ("runs", "checks", "times")}
        made = results.execute("SELECT COUNT(*) FROM runs").fetchone()[0]
        results.execute("UPDATE head SET runs = ?", (runs,))
        while made < runs:
            for table, names in columns.items():
                others = ", ".join(name for name in names if name != "run")
                results.execute(f"INSERT INTO {table} (run, {others}) SELECT run + {made}, {others} FROM {table} WHERE run <= {runs - made}")
            made = min(2 * made, runs)
    results.close()


def memory(options: argparse.Namespace, folder: Path) -> str:
    said = []
    for runs in (10_000, 10_000_000):
        file = write_slide(folder, runs, until_s=0.001)
        megabytes = most_memory(options, "run", file, "--shard", f"1/{runs // options.runs}", "--report", folder / f"shard{runs}",
                                "--recordings", "off")
        said.append(f"{options.runs} of {runs:,}: {megabytes:.0f} MB")
    for runs in (10_000, options.samples * 50):
        report = folder / f"many{runs}"
        visum(options, "campaign", write_slide(folder, 100, until_s=0.001), "--report", report, "--no-recordings")
        multiply(report, runs)
        megabytes = most_memory(options, "report", "merge", report, "-o", folder / f"merged{runs}")
        said.append(f"{runs:,} merged and judged: {megabytes:.0f} MB")
    return "; ".join(said)


def weight(options: argparse.Namespace, folder: Path) -> str:
    sizes = []
    for runs in (options.runs, 3 * options.runs):  # the difference: without what does not grow
        report = folder / str(runs)
        visum(options, "campaign", write_slide(folder, runs, until_s=0.001), "--report", report, "--no-recordings")
        sizes.append([(report / name).stat().st_size for name in ("results.sqlite", "results.csv")])
    database, table = ((many - few) / (2 * options.runs) for few, many in zip(*sizes))
    return f"{database:.0f} MB of results.sqlite and {table:.0f} MB of results.csv per million runs (2 parameters, 1 check)"


def share_beyond(distance: float) -> float:
    """The share of friction from 0.2 to 1 and speed from 0.5 to 1.5 where a box slides further: v^2 / (2 mu g)."""
    steps = 100_000
    return sum(max(0.0, 1.5 - math.sqrt(2 * (0.2 + 0.8 * (i + 0.5) / steps) * G * distance)) for i in range(steps)) / steps


def defect(options: argparse.Namespace, folder: Path) -> str:
    low, high = 0.4, 0.5734
    while high - low > 1e-7:
        middle = (low + high) / 2
        low, high = (middle, high) if share_beyond(middle) > 1e-4 else (low, middle)
    file = write_slide(folder, 50, below=round(low, 5), more="search: {runs: 500, until: broken}")
    out, _, _ = visum(options, "campaign", file, "--report", folder / "report", "--jobs", options.jobs, "--json", codes=(1,))
    result = json.loads(out)
    search = result["search"]
    expect(result["failed"] == 0 and search["broken"] > 0, f"not found: {search}")
    found = [f"search {result['runs'] + search['first_broken']} ({result['runs']} samples included; {search['values']})"]
    for method in ("random", "latin_hypercube"):
        file = write_slide(folder, options.samples, below=round(low, 5), method=method)
        out, _, _ = visum(options, "campaign", file, "--report", folder / method, "--jobs", options.jobs, "--no-recordings", "--json", codes=(0, 1))
        with (folder / method / "results.csv").open(newline="") as rows:
            first = next((row["run"] for row in csv.DictReader(rows) if row["result"] == "failed"), f"not in {options.samples}")
        found.append(f"{method} {first}")
    return f"beyond {low:.5f} m, {share_beyond(low):.1e} of the space, found by run: " + ", ".join(found)


TRIALS = {"rates": rates, "parts": parts, "cores": cores, "bytes": weight, "memory": memory, "defect": defect}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", type=Path, default=SOURCE / "build/release/bin")
    parser.add_argument("--runs", type=int, default=100)
    parser.add_argument("--samples", type=int, default=20_000)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("trial", nargs="*", help=", ".join(TRIALS))
    options = parser.parse_args()
    return programs.run_all(TRIALS, options.trial, options)


if __name__ == "__main__":
    sys.exit(main())
