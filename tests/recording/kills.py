#!/usr/bin/python3
"""Kills a recording daemon (SIGKILL) again and again, each time at another moment, and goes through what it has left.

    kills.py VISUM [--kills N] [--seed S]

Each file must be readable up to its last whole chunk, with the same bits as the run had; one that was cut before its first
chunk must say so. Exit code 0: all did.
"""

import argparse
import json
import random
import subprocess
import sys
import tempfile
import time
from pathlib import Path

SCENE = Path(__file__).resolve().parents[2] / "models/scenes/two_link.yaml"
MOST_BYTES = 3_000_000  # written before the kill: from nothing to several chunks


def kill_one(visum: Path, file: Path, after_bytes: int) -> int:
    """The ticks that can be gone through again; -1: the file was cut before its first chunk."""
    file.unlink(missing_ok=True)
    words = [visum, "record", file, SCENE, "--clock", "free", "--run", "--port", "0", "--http", "off", "-v", "0"]
    with subprocess.Popen(words) as daemon:
        while not file.exists() or file.stat().st_size < after_bytes:
            assert daemon.poll() is None, "visumd ended by itself"
            time.sleep(0.001)
        daemon.kill()
    done = subprocess.run([visum, "replay", file, "--json"], capture_output=True, text=True, timeout=600)
    if done.returncode == 3 and str(file) in done.stderr:
        return -1
    assert done.returncode in (0, 1), f"killed after {after_bytes} bytes: replay ended with {done.returncode}: {done.stderr}"
    again = json.loads(done.stdout.splitlines()[-1])
    assert again["equal"], f"killed after {after_bytes} bytes: {again}"
    assert again["ticks"] - again["ticks_to_hash"] < 50, f"killed after {after_bytes} bytes: {again}"
    return again["ticks"]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("visum", type=Path)
    parser.add_argument("--kills", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    dice = random.Random(options.seed)
    with tempfile.TemporaryDirectory() as folder:
        ticks = [kill_one(options.visum, Path(folder) / "killed.mcap", dice.randrange(MOST_BYTES)) for _ in range(options.kills)]
    read = [count for count in ticks if count > 0]
    print(f"{options.kills} kills: {len(read)} files with {sum(read)} ticks went through again with the same bits, "
          f"{len(ticks) - len(read)} were cut before the first tick")
    assert read, "no kill came after the first chunk"
    return 0


if __name__ == "__main__":
    sys.exit(main())
