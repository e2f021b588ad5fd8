"""Agents as a user sees them: inside the daemon, as a client in front of it, and when they fail."""
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest
import urllib.error
import urllib.request

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "clients"))
from programs import BIN, DEADLINE_S, SOURCE, Daemon, visum  # noqa: E402

sys.path.insert(0, str(BIN.parent / "python"))
import visum as visum_client  # noqa: E402

SCENES = SOURCE / "models" / "scenes"
TEST_PLUGINS = BIN.parent / "test_plugins"
CULPRIT = f"""\
visum: 1
include: ["{SCENES / 'amtec_arm.yaml'}"]
plugins: [kinds]
agents: [{{name: hand, kind: culprit, parts: {{arm: arm}}, does: DOES}}]
"""
STEPPER = """\
visum: 1
plugins: [kinds]
agents: [{name: hand, kind: stepper, parts: {arm: arm}, step: 0.001}]
"""
SCENARIO = """\
visum_scenario: 1
name: hangs
scene: culprit.yaml
clock: lockstep
until: {at_s: 1}
checks:
  - name: the arm stands
    that: {speed: {body: arm/link_7}, below: 1}
"""


def culprit(folder, does):
    """The scene of an agent that misbehaves."""
    scene = pathlib.Path(folder) / "culprit.yaml"
    scene.write_text(CULPRIT.replace("DOES", does))
    return scene


def run_agent(*words):
    return subprocess.run([BIN / "visum-agent", *map(str, words)], capture_output=True, text=True, timeout=DEADLINE_S)


class Inside(unittest.TestCase):
    def test_it_drives_and_what_it_commands_is_its_own(self):
        with Daemon("--clock", "free", scene=SCENES / "explorer_agent.yaml") as daemon:
            self.assertIn("explorer", daemon.ready["parts"])
            refusal = daemon.visum("set", "cart", "Desired Speed 1", 1, expect=1).stderr
            self.assertIn("'agent explorer'", refusal)
            daemon.visum("pause")
            daemon.visum("step", 4000)
            self.assertGreater(float(daemon.visum("get", "explorer", "Way").stdout), 0.2)
            self.assertEqual(float(daemon.visum("get", "explorer", "Turns").stdout), 80)

    def test_one_that_fails_is_told_of_and_the_world_goes_on(self):
        with tempfile.TemporaryDirectory() as folder:
            scene = culprit(folder, "throws")
            done = subprocess.run([BIN / "visumd", scene, "--plugins", TEST_PLUGINS, "--port", "0", "--clock", "free", "-r",
                                   "--iterations", "100"], capture_output=True, text=True, timeout=DEADLINE_S)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(done.stderr.count("error: 'hand' is in fault: lost its head"), 1, done.stderr)
        self.assertIn("ended at tick 100", done.stderr)


class Hanging(unittest.TestCase):
    """An agent that never returns is reported by name, and the daemon ends after the limit."""

    def test_status_and_health_tell_who_is_waited_for(self):
        with tempfile.TemporaryDirectory() as folder:
            command = ("--plugins", TEST_PLUGINS, "--node-timeout", 4, "-r", "--http", 0)
            with Daemon(*command, scene=culprit(folder, "hangs")) as daemon:
                status = daemon.json("status")
                while not status["stuck_node"]:
                    status = daemon.json("status")
                self.assertEqual(status["stuck_node"], "agent 'hand'")
                self.assertGreaterEqual(status["stuck_ns"], 1e9)
                self.assertIn("STUCK: agent 'hand' has not come back for", daemon.visum("status").stdout)
                with self.assertRaises(urllib.error.HTTPError) as health:
                    urllib.request.urlopen(f"http://127.0.0.1:{daemon.ready['http']}/healthz")
                self.assertEqual(health.exception.code, 503)
                self.assertIn(b"stuck: a plug-in's node has not come back", health.exception.read())
                health.exception.close()
                self.assertEqual(daemon.process.wait(timeout=DEADLINE_S), 124)

    def test_a_run_ends_with_the_reason_and_its_exit_code(self):
        with tempfile.TemporaryDirectory() as folder:
            culprit(folder, "hangs")
            scenario = pathlib.Path(folder) / "scenario.yaml"
            scenario.write_text(SCENARIO)
            done = visum("run", scenario, "--plugins", TEST_PLUGINS, "--node-timeout", 0.5, expect=124)
        self.assertRegex(done.stdout + done.stderr, r"agent 'hand' has not come back for 0\.[5-9] s and is given up")


class Recorded(unittest.TestCase):
    def test_a_world_with_plugins_is_replayed_with_the_same_bits(self):
        with tempfile.TemporaryDirectory() as folder:
            recording = pathlib.Path(folder) / "run.mcap"
            subprocess.run([BIN / "visumd", culprit(folder, "nothing"), "--plugins", TEST_PLUGINS, "--port", "0", "--clock",
                            "free", "-r", "--iterations", "200", "--record", recording], check=True, timeout=DEADLINE_S,
                           capture_output=True)
            self.assertIn("there is no plug-in 'kinds'", visum("replay", recording, expect=3).stderr)
            visum("replay", recording, "--plugins", TEST_PLUGINS)


class Outside(unittest.TestCase):
    def test_the_same_library_drives_the_parts_of_a_daemon_without_it(self):
        with Daemon("--clock", "lockstep", scene=SCENES / "explorer.yaml") as daemon:
            done = run_agent(SCENES / "explorer_agent.yaml", "--connect", daemon.connect, "--time", 4)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertGreater(float(re.search(r"done: Way ([\d.]+) m", done.stdout)[1]), 0.2)
            self.assertRegex(daemon.visum("parts").stdout, r"cart +servo_group +free")

    def test_it_begins_anew_when_the_world_does(self):
        with tempfile.TemporaryDirectory() as folder:
            scene = pathlib.Path(folder) / "agent.yaml"
            scene.write_text(STEPPER)
            with Daemon("--clock", "lockstep") as daemon, visum_client.Client(daemon.connect, role="admin") as admin:
                admin.join()
                words = [BIN / "visum-agent", scene, "--plugins", TEST_PLUGINS, "--connect", daemon.connect, "--time", "1"]
                with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as agent:
                    while len(admin.status().lockstep) < 2:
                        pass
                    admin.advance_ms(500)
                    admin.reset()
                    admin.advance_ms(100)
                    admin.leave()
                    said, _ = agent.communicate(timeout=DEADLINE_S)
                ticks = admin.status().tick
        self.assertEqual(agent.returncode, 0)
        self.assertAlmostEqual(ticks, 500, delta=20, msg="a second in all")
        desired = float(re.search(r"Desired ([\d.]+) rad", said)[1])
        self.assertAlmostEqual(desired, 0.001 * ticks / 10, delta=0.002, msg="a step each 10 ms since the reset")

    def test_what_is_wrong_has_its_exit_code(self):
        with Daemon("--clock", "lockstep", scene=SCENES / "cart.yaml") as daemon:
            done = run_agent(SCENES / "explorer_agent.yaml", "--connect", daemon.connect, "--time", 1)
            self.assertEqual(done.returncode, 3)
            self.assertIn("explorer_agent.yaml:8: agents[0]: explorer: there is no part 'eye'; there is only 'cart'", done.stderr)
        self.assertEqual(run_agent(SCENES / "cart.yaml", "--time", 1).returncode, 3)
        self.assertEqual(run_agent("--time", 1).returncode, 2)


if __name__ == "__main__":
    unittest.main()
