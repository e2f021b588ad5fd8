"""Runs a scenario twice with the real programs over real TCP. Both runs must pass, with the same bits at the end. The second
run is that of an older processor.

    run_twice.py VISUM SCENARIO.yaml [OPTIONS OF visum run...]
"""

import os
import pathlib
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ElementTree

from scenario_runs import OLDER_PROCESSOR, run_scenario


def main() -> int:
    program, scenario, *options = sys.argv[1:]
    if "shim: true" in pathlib.Path(scenario).read_text(encoding="utf-8"):
        # LeakSanitizer waits at the end of a program. Time passes meanwhile: some ticks in one run, none in
        # the next.
        os.environ["ASAN_OPTIONS"] = "detect_leaks=0"
    with tempfile.NamedTemporaryFile(suffix=".xml") as report:
        first = run_scenario(program, scenario, *options, "--junit", report.name)
        suite = ElementTree.parse(report.name).getroot()
    second = run_scenario(program, scenario, *options, env=OLDER_PROCESSOR)
    assert first["passed"] and second["passed"]
    assert first["state_hash"] == second["state_hash"], (first, second)
    assert first["ticks"] == second["ticks"] > 0, (first, second)
    assert list(suite.iter("testcase")), "the report has no test cases"
    assert not list(suite.iter("failure")), "the report has failures"
    print(f"state_hash {first['state_hash']} twice, {first['sim_seconds']} s in {first['wall_seconds']} s of wall time")
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except subprocess.SubprocessError as error:
        sys.exit(str(error))
