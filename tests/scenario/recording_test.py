"""Records runs of the real programs, goes through them again, and lets MCAP's own library read them.

    recording_test.py VISUM [NODE READER.mjs]
"""

from __future__ import annotations

import csv
import json
import subprocess
import sys
import tempfile
from pathlib import Path

from programs import BIN, MODELS
from scenario_runs import run_scenario


def replay(visum: str, file: Path, expect: int = 0) -> dict:
    result = subprocess.run([visum, "replay", str(file), "--json"], capture_output=True, text=True, timeout=300)
    assert result.returncode == expect, f"exit code {result.returncode}\n{result.stdout}{result.stderr}"
    return json.loads(result.stdout)


def check_run(visum: str, scenario: str, file: Path, *options: str) -> dict:
    """The scenario's run is written down, and its replay has the same bits to the last tick."""
    run = run_scenario(visum, MODELS / "scenarios" / f"{scenario}.yaml", "--record", str(file), *options)
    again = replay(visum, file)
    assert again["equal"] and not again["damage"], again
    assert again["ticks"] == run["ticks"] == again["ticks_to_hash"], (run, again)
    assert again["state_hash"] == run["state_hash"], (run, again)
    print(f"{scenario} {' '.join(options)}: {again['ticks']} ticks, {again['inputs']} inputs, {file.stat().st_size} bytes")
    return again


def check_bus(visum: str, file: Path) -> None:
    """Telegrams of a field bus come in real time, whenever they come: they come back at the same ticks. How well the
    program kept its own times is not the question here."""
    subprocess.run([visum, "run", str(MODELS / "scenarios" / "serial_arm.yaml"), "--record", str(file)],
                   capture_output=True, timeout=120)
    again = replay(visum, file)
    assert again["equal"] and not again["damage"] and again["inputs"] > 0, again
    assert again["ticks_to_hash"] == again["ticks"], again
    print(f"serial_arm: {again['ticks']} ticks, {again['inputs']} inputs")


def check_export(visum: str, file: Path, ticks: int) -> None:
    table = file.with_suffix(".csv")
    subprocess.run([visum, "export", str(file), "-o", str(table), "--ports", "robot/Actual Angle"], check=True, timeout=60)
    rows = list(csv.reader(table.open(newline="")))
    assert rows[0] == ["tick", "era", "time_s", "robot/Actual Angle 1", "robot/Actual Angle 2"], rows[0]
    assert [int(row[0]) for row in rows[1:]] == list(range(1, ticks + 1))
    wrong = subprocess.run([visum, "export", str(file), "--ports", "nobody"], capture_output=True, text=True, timeout=60)
    assert wrong.returncode == 2 and "no ports 'nobody'" in wrong.stderr, wrong


def check_reader(node: str, reader: str, file: Path, again: dict) -> None:
    result = subprocess.run([node, reader, str(file)], capture_output=True, text=True, timeout=120)
    assert result.returncode == 0, result.stdout + result.stderr
    seen = json.loads(result.stdout)
    assert seen["ticks"] == again["ticks"] == seen["messages"]["/ticks"] == seen["messages"]["/parts/robot"], seen
    assert seen["messages"]["/inputs"] == again["inputs"], seen
    # The last tick has its hash, as it completes a simulated second.
    assert seen["state_hash"] == again["state_hash"] != "0" * 16, seen
    assert str(MODELS / "two_link" / "two_link.urdf") in seen["attachments"], seen
    assert "zstd" in seen["compressions"], seen
    print(f"read by MCAP's own library: {seen['chunks']} chunks, {seen['messages']}")


def check_rewind(visum: str, file: Path, at_s: float, *options: str) -> None:
    """A daemon goes on from a moment of the run."""
    command = [visum, "rewind", str(file), "--at", str(at_s), "--clock", "lockstep", "--port", "0", "--http", "off", "--json", *options]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as daemon:
        try:
            assert daemon.stdout is not None
            address = f"127.0.0.1:{json.loads(daemon.stdout.readline())['port']}"
            subprocess.run([visum, "step", "10", "--connect", address], check=True, capture_output=True, timeout=60)
            status = subprocess.run([visum, "status", "--json", "--connect", address], check=True, capture_output=True, timeout=60)
            assert json.loads(status.stdout)["tick"] == round(at_s * 1000) + 10, status.stdout
        finally:
            daemon.terminate()
            assert daemon.wait(20) == 0


def check_killed_daemon(visum: str, file: Path) -> None:
    """A daemon dies: all that was on the disk half a second before can be replayed."""
    scene = str(MODELS / "scenes" / "two_link.yaml")
    command = [visum, "record", str(file), scene, "--clock", "free", "--run", "--port", "0", "--http", "off", "-v", "0"]
    with subprocess.Popen(command) as daemon:
        while not file.exists() or file.stat().st_size < 4_000_000:
            assert daemon.poll() is None, "visumd ended by itself"
        daemon.kill()
    again = replay(visum, file, expect=1)
    assert again["equal"] and again["ticks"] > 1000 and again["damage"], again
    print(f"killed: {again['ticks']} ticks can be read; {again['damage']}")


def main() -> int:
    visum, *reader = sys.argv[1:]
    assert Path(visum).parent == BIN
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        again = check_run(visum, "two_link_wave", folder / "wave.mcap")
        check_export(visum, folder / "wave.mcap", again["ticks"])
        if reader:
            check_reader(*reader, folder / "wave.mcap", again)
        check_rewind(visum, folder / "wave.mcap", 0.5)
        check_rewind(visum, folder / "wave.mcap", 0.5, "--engine", "impulse")
        check_run(visum, "pick_and_place", folder / "pick.mcap")
        check_bus(visum, folder / "serial.mcap")
        check_killed_daemon(visum, folder / "killed.mcap")
    return 0


if __name__ == "__main__":
    sys.exit(main())
