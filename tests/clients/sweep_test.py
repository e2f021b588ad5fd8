"""visum run of a scenario that sweeps: real processes side by side, one report, what failed recorded, nothing left."""
import html.parser
import json
import pathlib
import re
import signal
import subprocess
import tempfile
import textwrap
import unittest
import xml.etree.ElementTree as xml

from programs import BIN, DEADLINE_S, processes_with, visum

WORLD = """
    visum: 1
    engine: impulse
    parameters: {friction: 0.5, speed: 1.0}
    surfaces: {default: {friction: "${friction}", restitution: 0}}
    bodies:
      - {name: floor, fixed: true, shapes: [{plane: true}]}
      - {name: box, mass: 1, pose: {xyz: [0, 0, 0.05]}, velocity: {linear: ["${speed}", 0, 0]}, shapes: [{box: [0.3, 0.3, 0.1]}]}
"""
# A box that slides on the floor comes v^2 / (2 mu g) far: 0.051 m for 1 m/s and 1, 0.408 m for 2 m/s and 0.5.
SLIDE = """
    until: {at_s: 0.5}
    sweep: {friction: [0.5, 1], speed: {from: 1, to: 2}}
    parameters: {friction: "${friction}", speed: "${speed}"}
    checks:
      - {name: near, that: {position: {body: box, axis: x}, below: 0.3}, when: always}
      - {name: as computed, that: {position: {body: box, axis: x}, equals: "${speed * speed / (2 * friction * 9.81)}", within: 0.003}}
"""


class Sweep(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory(prefix="visum_sweep_test_")))
        self.report = self.folder / "report"

    def write(self, text):
        (self.folder / "world.yaml").write_text(textwrap.dedent(WORLD))
        file = self.folder / "scenario.yaml"
        file.write_text("visum_scenario: 1\nname: slide\nscene: world.yaml\n" + textwrap.dedent(text))
        return file

    def sweep(self, text, *options, expect=0):
        """The lines of the runs, by run, and the last line."""
        done = visum("run", self.write(text), "--json", *options, expect=expect)
        lines = [json.loads(line) for line in done.stdout.splitlines()]
        self.assert_nothing_left()
        return {line["run"]: line for line in lines[:-1]}, lines[-1]

    def assert_nothing_left(self):
        self.assertEqual(processes_with(str(self.folder)), [])

    def test_runs_the_product_with_the_scenes_parameters(self):
        runs, result = self.sweep(SLIDE, expect=1)
        self.assertEqual([runs[i]["sweep"] for i in (1, 2, 3, 4)],
                         [{"friction": f, "speed": s} for f in ("0.5", "1") for s in ("1", "2")])
        self.assertEqual([runs[i]["passed"] for i in (1, 2, 3, 4)], [True, False, True, True])
        self.assertEqual((result["passed"], result["runs"], result["failed"]), (False, 4, 1))

    def test_processes_side_by_side_change_no_bits(self):
        one, _ = self.sweep(SLIDE, expect=1)
        three, _ = self.sweep(SLIDE, "--jobs", 3, expect=1)
        self.assertEqual({i: run["state_hash"] for i, run in one.items()}, {i: run["state_hash"] for i, run in three.items()})
        self.assertEqual(len({run["state_hash"] for run in one.values()}), 4)

    def test_one_of_the_runs_alone_is_the_same(self):
        runs, _ = self.sweep(SLIDE, expect=1)
        alone = visum("run", self.folder / "scenario.yaml", "--only", 2, "--json", expect=1)
        self.assertEqual(json.loads(alone.stdout.splitlines()[-1])["state_hash"], runs[2]["state_hash"])
        refused = visum("run", self.folder / "scenario.yaml", "--only", 5, expect=2)
        self.assertIn("--only: the scenario has 4 runs", refused.stderr)

    def test_a_name_that_nothing_uses_repeats_the_run(self):
        runs, result = self.sweep("until: {at_s: 0.1}\nsweep: {again: {from: 1, to: 6}}\n", "--jobs", 2)
        self.assertEqual((result["runs"], result["failed"]), (6, 0))
        self.assertEqual(len({run["state_hash"] for run in runs.values()}), 1)

    def test_the_report_holds_the_failures_first_and_their_recordings(self):
        self.sweep(SLIDE, "--jobs", 2, "--report", self.report, expect=1)
        self.assertEqual(sorted(file.name for file in self.report.iterdir()), ["junit.xml", "report.html", "run_2.mcap"])
        page = (self.report / "report.html").read_text()
        self.assertRegex(page, r"(?s)FAILED</b>: 1 of 4 runs failed.*id=\"run2\".*<svg.*id=\"run1\"")
        self.assertNotRegex(page, r"https?:|src=|<link|<script|url\(|@import")
        html.parser.HTMLParser().feed(page)
        command = re.search(r"visum run (\S+) --only 2&#10;visum replay (\S+)</pre>", page)
        replayed = visum("replay", command.group(2), "--json")
        self.assertTrue(json.loads(replayed.stdout)["equal"], "the recording knows the scene's parameters")
        suites = xml.parse(self.report / "junit.xml").getroot()
        self.assertEqual([suite.get("failures") for suite in suites], ["0", "1", "0", "0"])
        self.assertEqual(suites.get("tests"), "12")

    def test_a_report_of_one_run_needs_no_sweep(self):
        self.sweep("until: {at_s: 0.1}\nchecks: [{that: {speed: {body: box}, below: 0.1}}]\n", "--report", self.report,
                   expect=1)
        self.assertTrue((self.report / "run_1.mcap").exists())
        self.assertIn("speed of box", (self.report / "report.html").read_text())

    def test_what_is_wrong_is_said_before_the_first_run(self):
        junit = self.folder / "junit.xml"
        wrong = visum("run", self.write(SLIDE.replace("{body: box, axis: x}", "{body: box, axis: w}")), "--junit", junit, expect=3)
        self.assertFalse(junit.exists())
        self.assertRegex(wrong.stderr, r"scenario\.yaml:\d+: checks\[0\]")
        twice = visum("run", self.write(SLIDE + "    record: same.mcap\n"), expect=3)
        self.assertIn("two runs of the sweep would write 'same.mcap'", twice.stderr)
        for option in (["--record", "x.mcap"], ["--keep"], ["--progress"], ["--port", "7777"]):
            self.assertIn("are for one run", visum("run", self.write(SLIDE), *option, expect=2).stderr)

    def test_a_parameter_that_the_scene_does_not_have_is_refused(self):
        text = SLIDE.replace("speed: \"${speed}\"}", "sped: \"${speed}\"}")
        self.assertIn("unknown key 'sped'; did you mean 'speed'?", visum("run", self.write(text), expect=3).stdout)

    def test_a_run_that_is_lost_counts_as_such(self):
        text = """
            sweep: {seconds: [0, 1000]}
            controllers: [{name: c, joins: false, exchanges: false, command: [sh, -c, 'sleep ${seconds}']}]
            max_sim_s: 1e5
        """
        runs, result = self.sweep(text, "--timeout", 2, expect=124)
        self.assertEqual([runs[1]["code"], runs[2]["code"]], [0, 124])
        self.assertEqual(result["failed"], 1)

    def test_an_interrupt_ends_all_of_them(self):
        text = """
            until: {at_s: 1e5}
            max_sim_s: 1e5
            sweep: {n: [1, 2, 3, 4]}
            controllers: [{name: c, joins: false, exchanges: false, command: [touch, '{scenario_dir}/began_${n}']}]
        """
        self.interrupt(text, lambda: len(list(self.folder.glob("began_*"))) == 2, "--jobs", "2")

    def interrupt(self, text, when, *options):
        process = subprocess.Popen([BIN / "visum", "run", self.write(text), *options], stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, text=True)
        for _ in range(int(DEADLINE_S / 0.02)):
            if when():
                break
            subprocess.run(["sleep", "0.02"], check=True)
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=DEADLINE_S)
        self.assertEqual(process.returncode, 130, err)
        self.assert_nothing_left()

    def test_an_interrupted_sweep_reports_the_runs_that_ended(self):
        text = """
            until: {at_s: "${(n - 1) * 1e5 + 0.1}"}
            max_sim_s: 8e5
            sweep: {n: [1, 2, 3]}
            controllers: [{name: c, joins: false, exchanges: false, command: [touch, '{scenario_dir}/began_${n}']}]
            checks: [{that: {tilt: {body: box}, below: 1}}]
        """
        junit = self.folder / "junit.xml"
        junit.write_text("of an earlier sweep")
        self.interrupt(text, (self.folder / "began_2").exists, "--report", self.report, "--junit", junit)
        self.assertEqual((self.report / "junit.xml").read_text(), junit.read_text())
        suites = xml.parse(junit).getroot().findall("testsuite")
        self.assertEqual([suite.get("errors") for suite in suites], ["0", "1", "1"])
        self.assertEqual([error.get("message") for error in xml.parse(junit).iter("error")],
                         ["interrupted", "not started: interrupted"])
        self.assertIn("2 of 3 runs failed", (self.report / "report.html").read_text())


if __name__ == "__main__":
    unittest.main()
