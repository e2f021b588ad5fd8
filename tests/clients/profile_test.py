"""visum run --profile: the table adds up, the trace is one that Perfetto opens, and the result stays the same."""
import json
import pathlib
import re
import tempfile
import unittest

from programs import ARM, visum

RUNNER, DAEMON = "visum run", "visumd"


class Profiles(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory(prefix="visum_profile_test_")))
        self.scenario = self.folder / "scenario.yaml"
        self.scenario.write_text(f"visum_scenario: 1\nname: profile\nscene: {ARM}\nuntil: {{at_s: 0.5}}\n"
                                 "checks:\n  - that: {port: {part: arm, name: Part State}, below: 2}\n")
        self.trace = self.folder / "trace.json"

    def rows(self, text):
        """Each row of the table: milliseconds of the run, microseconds of a tick or None."""
        found = re.findall(r"^  (\S.*?)  +([0-9.]+) +([0-9.]+|-)? +([0-9.]+) %", text, re.MULTILINE)
        return {name: (float(ms), None if us in ("-", "") else float(us)) for name, ms, us, _ in found}

    def test_the_phases_add_up_to_the_wall_time(self):
        done = visum("run", self.scenario, "--profile", expect=0)
        rows = self.rows(done.stdout)
        total = rows.pop("total")[0]
        self.assertGreater(total, 0)
        self.assertLessEqual({"load", "start", "end", "gateway", "physics", "drives", "parts", "collision"},
                             set(rows))
        rounding = 0.05 * len(rows) + 0.05
        self.assertAlmostEqual(sum(ms for ms, _ in rows.values()), total, delta=rounding)
        self.assertIsNone(rows["load"][1])
        self.assertAlmostEqual(rows["physics"][1] * 500 * 1e-3, rows["physics"][0], delta=0.06)

    def test_the_trace_is_in_chromes_format(self):
        visum("run", self.scenario, "--profile", self.trace, expect=0)
        events = json.loads(self.trace.read_text())["traceEvents"]
        names = {event["args"]["name"]: event["pid"] for event in events if event["name"] == "process_name"}
        self.assertEqual(set(names), {RUNNER, DAEMON})
        threads = {event["pid"]: event["args"]["name"] for event in events if event["name"] == "thread_name"}
        self.assertEqual(threads, {names[RUNNER]: "main", names[DAEMON]: "tick"})
        for event in events:
            self.assertIn(event["ph"], "MX")
            self.assertTrue({"name", "pid", "tid"} <= set(event))
        for process in names.values():
            end = 0.0
            spans = [event for event in events if event["ph"] == "X" and event["pid"] == process]
            self.assertGreater(len(spans), 2)
            for span in spans:  # one phase at a time, without a gap
                self.assertGreaterEqual(span["dur"], 0)
                if end:
                    self.assertAlmostEqual(span["ts"], end, delta=0.002)
                end = span["ts"] + span["dur"]
        steps = [event for event in events if event["ph"] == "X" and event["name"] == "physics"]
        self.assertGreaterEqual(len(steps), 500)

    def test_chromes_trace_viewer_keeps_the_nanoseconds(self):
        # Otherwise it rounds to microseconds, and draws a short span as a part of the one before.
        visum("run", self.scenario, "--profile", self.trace, expect=0)
        self.assertEqual(json.loads(self.trace.read_text()).get("displayTimeUnit"), "ns")

    def test_the_runner_loads_nothing_after_the_run(self):
        visum("run", self.scenario, "--profile", self.trace, expect=0)
        events = json.loads(self.trace.read_text())["traceEvents"]
        runner = next(event["pid"] for event in events if event.get("args") == {"name": RUNNER})
        spans = [event["name"] for event in events if event["ph"] == "X" and event["pid"] == runner]
        self.assertEqual(spans[-1], "end")
        self.assertNotIn("load", set(spans[spans.index("waits for the world"):]))

    def test_the_trace_and_the_table_say_the_same(self):
        done = visum("run", "--profile", self.trace, self.scenario, expect=0)
        spans = [event for event in json.loads(self.trace.read_text())["traceEvents"] if event["name"] == "physics"]
        self.assertAlmostEqual(sum(span["dur"] for span in spans) * 1e-3, self.rows(done.stdout)["physics"][0],
                               delta=0.06)

    def test_a_trace_changes_nothing_else_in_the_table(self):
        plain = visum("run", self.scenario, "--profile", expect=0).stdout
        traced = visum("run", self.scenario, "--profile", self.trace, expect=0).stdout
        self.assertEqual(set(self.rows(traced)) - set(self.rows(plain)), {"trace"})
        written = json.loads(self.trace.read_text())["written"]
        self.assertAlmostEqual(self.rows(traced)["trace"][0], written["ns"] * 1e-6, delta=0.06)
        rows = self.rows(traced)
        total = rows.pop("total")[0]
        self.assertAlmostEqual(sum(ms for ms, _ in rows.values()), total, delta=0.05 * len(rows) + 0.05)
        for said in (plain, traced):  # this scenario has no controller
            self.assertIn("s, controllers 0.000 s, visum run", said)

    def test_the_result_stays_the_same(self):
        plain = visum("run", self.scenario, "--json", expect=0)
        measured = visum("run", self.scenario, "--json", "--profile", expect=0)
        hashes = [json.loads(done.stdout.splitlines()[-1])["state_hash"] for done in (plain, measured)]
        self.assertEqual(*hashes)
        self.assertIn("physics", measured.stderr)
        self.assertNotIn("physics", plain.stdout + plain.stderr)

    def test_the_word_behind_the_option_is_never_a_scenario_to_overwrite(self):
        before = self.scenario.read_text()
        visum("run", "--profile", self.scenario, expect=0)
        done = visum("run", self.scenario, "--profile", self.scenario, expect=2)
        self.assertIn("overwrite", done.stderr)
        self.assertEqual(self.scenario.read_text(), before)
        self.assertIn("SCENARIO is required", visum("run", "--profile", expect=2).stderr)

    def test_a_trace_that_cannot_be_written_is_refused_before_the_run(self):
        done = visum("run", self.scenario, "--profile", self.folder / "nowhere" / "trace.json", expect=2)
        self.assertIn("nowhere", done.stderr)

    def test_many_runs_have_no_profile(self):
        done = visum("run", self.scenario, "--profile", "--report", self.folder / "report", expect=2)
        self.assertIn("--profile", done.stderr)


if __name__ == "__main__":
    unittest.main()
