#!/usr/bin/env python3
"""Runs the explorer on several seeds, each checked as its scenario says, and prints what it has covered.

    explorer_seeds.py VISUM [--scenario NAME] [--engine KIND] [--seeds N] [--time S] [--covers SHARE] [--twice]

Ten seeds of 400 simulated seconds take a while; the suite runs one that is shorter, and asks for less.
"""

import argparse
import json
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import yaml

from scenario_runs import OLDER_PROCESSOR, run_scenario

MODELS = Path(__file__).resolve().parents[2] / "models"


def scenario_of(folder: Path, name: str, time_s: float, covers: float) -> Path:
    scenario = yaml.safe_load((MODELS / "scenarios" / f"{name}.yaml").read_text())
    scenario["scene"] = str(MODELS / "scenes" / f"{name}.yaml")
    scenario["max_sim_s"] = time_s + 20
    command = scenario["controllers"][0]["command"]
    command[command.index("--time") + 1] = str(time_s)
    command[:] = [word.replace("{scenario_dir}", str(MODELS / "scenarios")) for word in command]
    coverage = next(check for check in scenario["checks"] if "coverage" in check["that"])
    coverage["that"]["above"] = covers
    file = folder / "explorer.yaml"
    file.write_text(yaml.safe_dump(scenario))
    return file


def explore(visum: str, scenario: Path, seed: int, engine: str, twice: bool) -> bool:
    words = [visum, "run", str(scenario), "--seed", str(seed), "--json", *(["--engine", engine] if engine else [])]
    done = subprocess.run(words, capture_output=True, text=True, timeout=3000)
    lines = [json.loads(line) for line in done.stdout.splitlines() if line.startswith("{")]
    values = {line["check"]: line["value"] for line in lines if "check" in line}
    driven = re.search(r"has driven ([\d.]+) m", done.stdout + done.stderr)
    if not values or not driven:
        print(done.stdout + done.stderr)
        return False
    print(f"seed {seed:3}: covered {values['it has covered the free floor']:.3f}, driven {driven[1]} m, touched walls "
          f"{values['it touches no wall']:g} N and furniture {values['and no furniture']:g} N, {lines[-1]['sim_seconds']:.1f} s, "
          f"{'passed' if done.returncode == 0 else 'FAILED'}", flush=True)
    if done.returncode != 0 or not twice:
        return done.returncode == 0
    again = run_scenario(*words[:1], *words[2:], env=OLDER_PROCESSOR)
    same = again["state_hash"] == lines[-1]["state_hash"]
    print(f"state hash {lines[-1]['state_hash']}, on an older processor {again['state_hash']}")
    return same


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("visum")
    parser.add_argument("--scenario", default="explorer", choices=("explorer", "explorer_ray"))
    parser.add_argument("--engine", default="", help="instead of the scene's")
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--time", type=float, default=400.0)
    parser.add_argument("--covers", type=float, default=0.8)
    parser.add_argument("--twice", action="store_true", help="a second run, as on an older processor, must have the same bits")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        scenario = scenario_of(Path(folder), options.scenario, options.time, options.covers)
        passed = [explore(options.visum, scenario, seed, options.engine, options.twice) for seed in range(1, options.seeds + 1)]
    return 0 if all(passed) else 1


if __name__ == "__main__":
    sys.exit(main())
