"""Files and folders with names of 255 bytes, as many as a file system has, are written like others."""
import json
import unittest

from programs import ARM, visum
from run_test import Scenario

FAILS = "until: {at_s: 0.01}\nchecks: [{that: {tilt: {body: box}, above: 1}}]\n"


def name(ending="", size=255):
    return "n" * (size - len(ending)) + ending


class LongNames(Scenario):
    def names(self, folder=None):
        return sorted(path.name for path in (folder or self.folder).iterdir())

    def test_of_what_a_run_writes(self):
        report, recording = name(".xml"), name(".mcap")
        self.run_it(FAILS, "--junit", self.folder / report, "--record", self.folder / recording, expect=1)
        self.assertEqual(self.names(), sorted(["scenario.yaml", "world.yaml", report, recording]))
        visum("export", self.folder / recording, "--output", self.folder / name(".csv"))
        self.assertIn(name(".csv"), self.names())

    def test_of_a_scenario_name_the_recording_of_a_run_that_fails(self):
        for size in (251, 300):  # with .mcap it is 256 bytes, and more
            file = self.write(FAILS)
            file.write_text(file.read_text().replace("name: scenario", f"name: {name(size=size)}"))
            folder = self.folder / str(size)
            for number in (1, 2):
                done = visum("run", file, "--recordings", folder, expect=1)
                self.assertNotIn("leaves no recording", done.stderr)
                self.assertEqual(len(self.names(folder)), number)
            for recording in folder.iterdir():
                self.assertEqual((len(recording.name), recording.suffix), (255, ".mcap"))
                self.assertTrue(json.loads(visum("replay", recording, "--json").stdout)["equal"])

    def test_of_a_folder_that_is_merged(self):
        sweep = self.write("sweep: {seed: [1, 2]}\n" + FAILS)
        visum("run", sweep, "--shard", "1/1", "--report", self.folder / name("s"), expect=1)
        visum("report", "merge", self.folder / name("s"), "-o", self.folder / name("m"))
        self.assertIn("summary.json", self.names(self.folder / name("m")))

    def test_longer_ones_are_refused_with_the_reason(self):
        model = ARM.parents[1] / "two_link" / "two_link.urdf"
        done = visum("drives", model, "-o", self.folder / name(".yaml", 256), expect=2)
        self.assertIn(f"cannot write '{self.folder / name('.yaml', 256)}': File name too long", done.stderr)
        visum("drives", model, "-o", self.folder / name(".yaml"))
        self.assertEqual(self.names(), [name(".yaml")])


if __name__ == "__main__":
    unittest.main()
