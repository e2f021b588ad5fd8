"""Runs of a campaign share processes. Each must give what it gives alone, to the bit, whatever was before it."""
import json
import os
import pathlib
import sqlite3
import subprocess
import tempfile
import textwrap
import time
import unittest

from programs import BIN, DEADLINE_S, SOURCE, visum
from sweep_test import WORLD

ARM = f"""
    visum: 1
    parameters: {{mass: 0.2, push: 0}}
    models:
      - {{name: arm, file: {SOURCE}/models/amtec_arm/amtec_arm.urdf, joints: {{joint_2: -0.4, joint_4: 1.6, joint_6: 1.4}}}}
    bodies:
      - {{name: floor, fixed: true, shapes: [{{plane: true}}]}}
      - {{name: box, mass: "${{mass}}", pose: {{xyz: [0.5, 0.2, 0.3], rpy: [0.3, 0.2, 0]}}, velocity: {{linear: ["${{push}}", 0, 0]}}, shapes: [{{box: [0.1, 0.1, 0.1]}}]}}
    parts:
      - {{name: arm, kind: amtec_arm, model: arm, drives: {SOURCE}/models/amtec_arm/drives.yaml}}
    sensors:
      - {{name: imu, kind: imu, body: box, rate_hz: 200, gyro: {{range: 35, noise: 0.003, bias: 0.01}}, accelerometer: {{range: 160, noise: 0.05}}}}
      - {{name: scan, kind: scanner, pose: {{xyz: [0, 0, 0.3]}}, rays: 31, angle: [-1.5, 1.5], range: [0.05, 6], rate_hz: 10, noise: 0.01}}
"""
SCENARIO = """
    until: {at_s: 0.4}
    engine: "${engine}"
    seed: "${seed}"
    sweep: {engine: [impulse, ode], seed: [1, 7], mass: [0.2, 0.5], delay_ms: [0, 10]}
    parameters: {mass: "${mass}", push: "${seed / 10}"}
    timeline:
      - {at_s: 0, fault: {part: arm, kind: network_delay, numbers: {ms: "${delay_ms}"}}}
      - {at_s: 0.1, set: {part: arm, port: Desired Angle 2, value: -0.3}}
    checks:
      - {name: joint, that: {port: {part: arm, name: Actual Angle 2}, below: 9}}
      - {name: box, that: {position: {body: box, axis: z}, below: 9}, when: always}
"""
# Ends the world, the server that starts worlds, or the process that makes the runs, from within a run.
ENDS = """
import os, pathlib, signal, sys

def words(pid):
    return pathlib.Path(f"/proc/{pid}/cmdline").read_bytes()

def parent(pid):
    return int(pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(") ", 1)[1].split()[1])

def children(of):
    for folder in pathlib.Path("/proc").iterdir():
        try:
            if folder.name.isdigit() and parent(folder.name) == of:
                yield int(folder.name)
        except OSError:
            pass

what, worker = sys.argv[1], os.getppid()
if what in ("world", "server", "worker"):
    while b"--worker" not in words(worker):
        worker = parent(worker)
    server = next(pid for pid in children(worker) if b"fork-server" in words(pid))
    world = next(children(server))
    os.kill({"world": world, "server": server, "worker": worker}[what], signal.SIGKILL)
sys.exit(what == "itself")
"""


class Reuse(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory(prefix="visum_reuse_test_")))
        self.report = self.folder / "report"

    def write(self, text, world):
        (self.folder / "world.yaml").write_text(textwrap.dedent(world))
        file = self.folder / "scenario.yaml"
        file.write_text("visum_scenario: 1\nname: reuse\nscene: world.yaml\n" + textwrap.dedent(text))
        return file

    def rows(self, query):
        with sqlite3.connect(self.report / "results.sqlite") as results:
            return results.execute(query).fetchall()

    def alone(self, file, run, *options, expect=0):
        """The result of the run in a process of its own, which starts a visumd of its own."""
        result = self.folder / "alone.json"
        visum("run", file, "--only", run, "--result", result, *options, expect=expect)
        return json.loads(result.read_text())

    def test_every_run_is_as_it_is_alone(self):
        file = self.write(SCENARIO, ARM)
        visum("campaign", file, "--report", self.report, "--jobs", 1, "--all-recordings")
        runs = self.rows("SELECT run, state_hash, ticks FROM runs ORDER BY run")
        self.assertEqual(len(runs), 16)
        self.assertEqual(len({state_hash for _, state_hash, _ in runs}), 16, "each has something of its own")
        for run, state_hash, ticks in runs:
            recording = self.folder / f"alone_{run}.mcap"
            alone = self.alone(file, run, "--record", recording)
            self.assertEqual((alone["state_hash"], alone["ticks"]), (state_hash, ticks), f"run {run}")
            values = self.rows(f"SELECT name, value FROM checks WHERE run = {run} ORDER BY number")
            self.assertEqual([(check["check"], check["value"]) for check in alone["checks"]], values)
            # Every port in every tick, and the state: also what the sensors felt.
            visum("compare", self.report / f"run_{run:02}.mcap", recording)

    def test_the_order_and_the_number_of_jobs_change_nothing(self):
        file = self.write(SCENARIO, ARM)
        one = json.loads(visum("campaign", file, "--report", self.report, "--jobs", 1, "--json").stdout)
        three = json.loads(visum("campaign", file, "--report", self.folder / "other", "--jobs", 3, "--json").stdout)
        self.assertEqual(one["hash"], three["hash"])

    def test_what_ends_one_run_leaves_the_next_as_it_is(self):
        (self.folder / "ends.py").write_text(ENDS)
        file = self.write("""
            sweep: {speed: [1, 2], what: [none, itself, none, world, none, server, none, worker, none]}
            parameters: {speed: "${speed}", friction: 0.5}
            settle_s: 0.3
            controllers: [{name: c, shim: true, exchanges: false, command: [/usr/bin/python3, "{scenario_dir}/ends.py", "${what}"]}]
            checks: [{that: {position: {body: box, axis: x}, above: 0}}]
            """, WORLD)
        visum("campaign", file, "--report", self.report, "--jobs", 1, expect=1)
        codes = [code for code, in self.rows("SELECT code FROM runs ORDER BY run")]
        self.assertEqual(codes, 2 * [0, 1, 0, 6, 0, 6, 0, 6, 0])
        hashes = self.rows("SELECT run, state_hash FROM runs WHERE code = 0 ORDER BY run")
        self.assertEqual(len({state_hash for _, state_hash in hashes}), 2)
        for run, state_hash in (hashes[1], hashes[-1]):
            self.assertEqual(self.alone(file, run, expect=0)["state_hash"], state_hash)

    def test_a_wrong_scene_is_told_and_the_next_run_is_made(self):
        file = self.write("""
            until: {at_s: 0.1}
            sweep: {friction: [0.5, -1, 0.7]}
            parameters: {friction: "${friction}", speed: 1}
            """, WORLD)
        visum("campaign", file, "--report", self.report, "--jobs", 1, expect=6)
        rows = self.rows("SELECT code, error FROM runs ORDER BY run")
        self.assertEqual([code for code, _ in rows], [0, 3, 0])
        self.assertIn("world.yaml", rows[1][1])

    def test_nothing_is_left_of_a_campaign_that_is_killed(self):
        file = self.write("until: {at_s: 20}\nsweep: {speed: [1, 2]}\nparameters: {speed: \"${speed}\", friction: 0.5}\n", WORLD)
        mark = f"VISUM_REUSE_TEST={self.folder}"
        killed = subprocess.Popen([BIN / "visum", "campaign", file, "--report", self.report, "--jobs", "2"], stdout=subprocess.DEVNULL,
                                  stderr=subprocess.DEVNULL, env={**os.environ, "VISUM_REUSE_TEST": str(self.folder)})
        until = time.monotonic() + DEADLINE_S
        # The campaign, two workers, two servers, two worlds.
        while len(marked(mark)) < 7 and killed.poll() is None and time.monotonic() < until:
            time.sleep(0.01)
        killed.kill()
        killed.wait()
        while marked(mark) and time.monotonic() < until:
            time.sleep(0.01)
        self.assertEqual(marked(mark), [])


def marked(variable):
    """The ids of the processes whose environment holds it."""
    found = []
    for folder in pathlib.Path("/proc").iterdir():
        try:
            if folder.name.isdigit() and variable.encode() in (folder / "environ").read_bytes():
                found.append(int(folder.name))
        except OSError:
            pass  # it ended meanwhile
    return found


if __name__ == "__main__":
    unittest.main()
