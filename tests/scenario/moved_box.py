"""The pick-and-place follows its arguments: boxes and goals elsewhere on the table, a box that is turned.

    moved_box.py VISUM
"""

import sys
import tempfile
from pathlib import Path

from scenario_runs import moved_box, run_scenario

JOBS = [  # box, goal, yaw of the box
    ((0.42, 0.15), (0.55, -0.10), 0.0),
    ((0.58, 0.00), (0.42, -0.25), 0.0),
    ((0.45, -0.22), (0.52, 0.24), 0.0),
    ((0.50, 0.10), (0.45, -0.05), 0.4),
]


def main() -> None:
    for box, goal, yaw in JOBS:
        with tempfile.TemporaryDirectory() as folder:
            result = run_scenario(sys.argv[1], moved_box(Path(folder), box, goal, yaw))
            print(f"{box} turned by {yaw} to {goal}: passed after {result['sim_seconds']} s")


if __name__ == "__main__":
    main()
