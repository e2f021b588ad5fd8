"""The real programs for the Python tests: where they stand (environment VISUM_BIN), and a running daemon."""

from __future__ import annotations

import json
import os
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

BIN = Path(os.environ["VISUM_BIN"])
MODELS = Path(__file__).resolve().parents[2] / "models"


@contextmanager
def running_daemon(scene: str, *options: str) -> Iterator[str]:
    """visumd with that scene on a free port; gives its address, and ends it in good order."""
    command = [str(BIN / "visumd"), str(MODELS / "scenes" / scene), "--port", "0", "--json", *options]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as daemon:
        try:
            assert daemon.stdout is not None
            yield f"127.0.0.1:{json.loads(daemon.stdout.readline())['port']}"
        finally:
            daemon.terminate()
            assert daemon.wait(20) == 0, f"visumd ended with {daemon.returncode}"


def pick_and_place(address: str, *options: str) -> list[str]:
    urdf = MODELS / "amtec_arm" / "amtec_arm.urdf"
    return [str(BIN / "visum-pick-and-place"), "--connect", address, "--urdf", str(urdf), *options]
