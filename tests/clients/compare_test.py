"""visum compare: recordings tick by tick, campaigns run by run."""
import json
import pathlib
import tempfile
import textwrap
import unittest

from programs import ARM, visum
from sweep_test import SLIDE, WORLD

STILL = "visum_scenario: 1\nname: still\nscene: {scene}\nuntil: {{at_s: 0.05}}\nseed: {seed}\ntimeline:\n  - {{at_s: 0.02, say: 'now'}}\n{more}"


class Compare(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory(prefix="visum_compare_test_")))

    def record(self, name, *options, seed=1, more=""):
        scenario = self.folder / "scenario.yaml"
        scenario.write_text(STILL.format(scene=ARM, seed=seed, more=more))
        visum("run", scenario, "--record", self.folder / name, *options)
        return self.folder / name

    def compare(self, a, b, *options, expect=0):
        done = visum("compare", a, b, "--json", *options, expect=expect)
        return json.loads(done.stdout)

    def test_equal_runs(self):
        result = self.compare(self.record("a.mcap"), self.record("b.mcap"))
        self.assertEqual((result["equal"], result["first_tick"], result["ports"], result["ticks_a"]), (True, None, [], 50))
        self.assertEqual(result["settings"], [])

    def test_another_text_of_the_scene_is_a_difference_though_all_ticks_are_equal(self):
        folders = [self.folder / name for name in ("one", "two")]
        recordings = [self.folder / name for name in ("a.mcap", "b.mcap")]
        for folder, recording in zip(folders, recordings):
            folder.mkdir()
            (folder / "world.yaml").write_text(f"visum: 1\ninclude: [{ARM}]\n")
            (folder / "still.yaml").write_text(STILL.format(scene="world.yaml", seed=1, more=""))
            visum("run", folder / "still.yaml", "--record", recording)
        self.assertTrue(self.compare(*recordings)["same_files"], "in another folder they are the same")
        with (folders[1] / "world.yaml").open("a") as world:
            world.write("# a remark\n")
        visum("run", folders[1] / "still.yaml", "--record", recordings[1])
        result = self.compare(*recordings, "--report", self.folder / "page.html", expect=5)
        self.assertEqual((result["equal"], result["same_files"], result["first_tick"], result["ports"]), (False, False, None, []))
        self.assertEqual(result["settings"], ["file world.yaml: not the same content"])
        words = "not the same files of the scene; all 50 ticks are equal"
        self.assertTrue(visum("compare", *recordings, expect=5).stdout.startswith(f"{words}\n  file world.yaml: not the same content\n"))
        self.assertIn(words, (self.folder / "page.html").read_text())

    def test_another_parameter_alone_is_told_and_makes_no_difference(self):
        world = self.folder / "world.yaml"
        world.write_text(f"visum: 1\ninclude: [{ARM}]\nparameters: {{unused: 1}}\n")
        recordings = []
        for number in (1, 2):
            scenario = self.folder / "still.yaml"
            scenario.write_text(STILL.format(scene=world, seed=1, more="") + f"parameters: {{unused: {number}}}\n")
            recordings.append(self.folder / f"{number}.mcap")
            visum("run", scenario, "--record", recordings[-1])
        result = self.compare(*recordings)
        self.assertEqual((result["equal"], len(result["settings"])), (True, 1))
        self.assertIn("parameters: ", result["settings"][0])

    def test_a_command_in_the_middle_is_found_at_its_tick(self):
        # Written at 0.02 s, so between the ticks 20 and 21; it is an input of tick 21.
        moved = '  - {at_s: 0.02, set: {part: arm, port: "Desired Angle 3", value: 0.25}}\n'
        result = self.compare(self.record("a.mcap"), self.record("b.mcap", more=moved), "--report", self.folder / "page.html", expect=5)
        self.assertFalse(result["equal"])
        port = next(port for port in result["ports"] if port["port"] == "arm/Desired Angle 3")
        self.assertEqual((port["tick"], port["a"], port["b"], port["max_abs"]), (21, 0, 0.25, 0.25))
        self.assertEqual(result["first_tick"], 21)
        page = (self.folder / "page.html").read_text()
        self.assertIn("arm/Desired Angle 3", page)
        self.assertIn('aria-label="arm/Desired Angle 3 in A and B"', page)
        self.assertIn("first difference: tick 21", page)
        self.assertNotRegex(page, r"https?:|src=|<link|<script")

    def test_another_engine_is_named(self):
        result = self.compare(self.record("a.mcap", "--engine", "impulse"), self.record("b.mcap", "--engine", "ode"), expect=5)
        self.assertIn("engine: impulse, ode", result["settings"])

    def test_one_that_ends_earlier(self):
        longer = self.record("b.mcap")
        (self.folder / "scenario.yaml").write_text((self.folder / "scenario.yaml").read_text().replace("0.05", "0.04"))
        visum("run", self.folder / "scenario.yaml", "--record", self.folder / "a.mcap")
        result = self.compare(self.folder / "a.mcap", longer, expect=5)
        self.assertEqual((result["first_tick"], result["ticks_a"], result["ticks_b"], result["ports"]), (41, 40, 50, []))

    def test_what_cannot_be_read(self):
        good = self.record("a.mcap")
        cut = self.folder / "cut.mcap"
        cut.write_bytes(good.read_bytes()[:-3000])
        self.assertIn("cut.mcap", visum("compare", good, cut, expect=3).stderr)
        self.assertIn("no MCAP file", visum("compare", good, self.folder / "scenario.yaml", expect=3).stderr)
        self.assertIn("cannot be opened", visum("compare", good, self.folder / "none.mcap", expect=3).stderr)
        self.assertIn("holds no results.sqlite", visum("compare", self.folder, self.folder, expect=3).stderr)
        for pair in ((self.folder, "missing"), ("missing", self.folder)):
            self.assertIn("missing cannot be opened", visum("compare", *pair, expect=3).stderr)
        self.assertIn("two of one kind", visum("compare", good, self.folder, expect=2).stderr)

    def campaign(self, name, world):
        (self.folder / "world.yaml").write_text(textwrap.dedent(world))
        file = self.folder / "slide.yaml"
        file.write_text("visum_scenario: 1\nname: slide\nscene: world.yaml\n" + textwrap.dedent(SLIDE))
        visum("campaign", file, "--report", self.folder / name, expect=1)
        return self.folder / name

    def test_tells_that_a_controllers_program_is_another(self):
        (self.folder / "world.yaml").write_text(textwrap.dedent(WORLD))
        program = self.folder / "controller"
        file = self.folder / "slide.yaml"
        file.write_text("visum_scenario: 1\nname: slide\nscene: world.yaml\ncontrollers:\n"
                        f"  - {{name: c, joins: false, exchanges: false, command: ['{program}']}}\n" + textwrap.dedent(SLIDE))
        for version in ("1", "2"):
            program.write_text(f"#!/bin/sh\n# version {version}\n")
            program.chmod(0o755)
            visum("campaign", file, "--report", self.folder / version, expect=1)
        result = self.compare(self.folder / "1", self.folder / "2")
        self.assertEqual(result["settings"], ["a controller's program, or a file that its command names"])

    def test_campaigns(self):
        one, same = self.campaign("one", WORLD), self.campaign("same", WORLD)
        result = self.compare(one, same)
        self.assertEqual((result["equal"], result["runs"], result["different"]), (True, 4, []))
        # On a slope the box comes further: by the same tenth of a metre or so in all four runs.
        sloping = self.campaign("sloping", WORLD.replace("engine: impulse", "engine: impulse\n    gravity: [1, 0, -9.81]"))
        result = self.compare(one, sloping, "--report", self.folder / "page.html", expect=5)
        self.assertEqual(sorted(result["different"]), [1, 2, 3, 4])
        # The run that passes in one of them only comes first.
        self.assertEqual((result["turned_count"], result["turned"][0]["a"]), (len(result["turned"]), "passed"))
        self.assertEqual(result["turned"][0]["run"], result["different"][0])
        self.assertEqual([check["check"] for check in result["checks"]], ["passed", "near", "as computed"], "as the scenario has them")
        self.assertEqual(result["settings"], [f"file: {self.folder / 'world.yaml'}"])
        page = (self.folder / "page.html").read_text()
        self.assertIn("friction=0.5, speed=2", page)
        self.assertIn(f"visum compare {one / 'run_2.mcap'} {sloping / 'run_2.mcap'}", page, "both have its recording")
        self.assertNotRegex(page, r"https?:|src=|<link|<script")
        near = next(check for check in result["checks"] if check["check"] == "near")
        self.assertGreater(near["mean_difference"], 0)
        self.assertLess(near["low"], near["mean_difference"])
        self.assertGreater(near["high"], near["mean_difference"])
        computed = next(check for check in result["checks"] if check["check"] == "as computed")
        self.assertEqual((computed["both"], computed["only_a"], computed["only_b"]), (0, 4, 0))
        self.assertAlmostEqual(computed["p"], 2 * 0.5 ** 4)


if __name__ == "__main__":
    unittest.main()
