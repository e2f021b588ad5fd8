"""Helpers of the scenario tests: run `visum run`, and vary the scenarios that ship."""

import json
import os
import subprocess
from pathlib import Path

import yaml

MODELS = Path(__file__).resolve().parents[2] / "models"

# The environment of a run as on an older processor: neither the C library nor numpy may use fused
# multiply-add.
OLDER_PROCESSOR = {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-FMA,-AVX2,-AVX2_Usable,-FMA_Usable,-FMA4",
                   "NPY_DISABLE_CPU_FEATURES": "FMA3 AVX2 AVX512F AVX512CD AVX512_SKX", "PYTHONWARNINGS": "ignore"}


def run_scenario(visum: str, scenario: str | Path, *options: str, expect: int = 0, env: dict | None = None) -> dict:
    """The last line of `visum run --json`, as a dict. Fails with everything that was printed."""
    command = [visum, "run", str(scenario), "--json", *options]
    result = subprocess.run(command, capture_output=True, text=True, timeout=300, env={**os.environ, **(env or {})})
    assert result.returncode == expect, f"{command}: exit code {result.returncode}\n{result.stdout}{result.stderr}"
    return json.loads(result.stdout.strip().splitlines()[-1])


def moved_box(folder: Path, box: tuple[float, float], goal: tuple[float, float], yaw: float = 0.0) -> Path:
    """The pick-and-place scenario with the box and the spot elsewhere, in files of its own in `folder`."""
    scene = yaml.safe_load((MODELS / "scenes" / "amtec_arm.yaml").read_text())
    scene["models"][0]["file"] = str(MODELS / "amtec_arm" / "amtec_arm.urdf")
    scene["parts"][0]["drives"] = str(MODELS / "amtec_arm" / "drives.yaml")
    scene["panels"] = [str(MODELS / "scenes" / panel) for panel in scene["panels"]]
    bodies = {body["name"]: body for body in scene["bodies"]}
    bodies["box"]["pose"] = {"xyz": [*box, 0.24], "rpy": [0.0, 0.0, yaw]}
    bodies["target"]["pose"]["xyz"][:2] = goal
    (folder / "scene.yaml").write_text(yaml.safe_dump(scene))

    scenario = yaml.safe_load((MODELS / "scenarios" / "pick_and_place.yaml").read_text())
    scenario["scene"] = "scene.yaml"
    command = scenario["controllers"][0]["command"]
    command[command.index("--from") + 1] = f"{box[0]},{box[1]}"
    command[command.index("--to") + 1] = f"{goal[0]},{goal[1]}"
    command[command.index("--urdf") + 1] = str(MODELS / "amtec_arm" / "amtec_arm.urdf")
    command += ["--yaw", str(yaw)]
    (folder / "scenario.yaml").write_text(yaml.safe_dump(scenario))
    return folder / "scenario.yaml"
