"""`visum drives` writes drives with which an arm moves at once, and says clearly why it cannot."""
import json
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

import yaml

SOURCE = pathlib.Path(__file__).resolve().parents[2]
BIN = pathlib.Path(os.environ.get("VISUM_BIN", SOURCE / "build" / "dev" / "bin"))
ARM = SOURCE / "tests" / "scene" / "data" / "six_axis.urdf"
TARGETS = [1.5, -0.9, 1.2, -1.0, 0.8, 2.0]


def scenario() -> dict:
    def port(name: str, **bound: float) -> dict:
        return {"that": {"port": {"part": "six_axis", "name": name}, **bound}}

    return {"visum_scenario": 1, "name": "move", "scene": "arm.yaml", "clock": "lockstep", "max_sim_s": 20,
            "until": {"at_s": 8},
            "timeline": [{"at_s": 0.5, "set": {"part": "six_axis", "port": f"Desired Angle {i + 1}", "value": target}}
                         for i, target in enumerate(TARGETS)],
            "checks": [*(port(f"Actual Angle {i + 1}", equals=target, within=0.005) for i, target in enumerate(TARGETS)),
                       {"that": {"peak_following_error": {"part": "six_axis"}, "below": 0.1}, "when": "always"},
                       {**port("Part State", below=2), "when": "always"}]}


def limbs_of(counts: tuple[int, ...]) -> str:
    """A robot on a base whose limbs have so many joints each."""
    inertial = '<inertial><mass value="0.1"/><inertia ixx="1e-4" iyy="1e-4" izz="1e-4" ixy="0" ixz="0" iyz="0"/></inertial>'
    text = f'<robot name="many"><link name="base">{inertial}</link>'
    for limb, count in enumerate(counts):
        for i in range(count):
            parent = "base" if i == 0 else f"link_{limb}_{i - 1}"
            text += (f'<link name="link_{limb}_{i}">{inertial}</link><joint name="joint_{limb}_{i}" type="revolute">'
                     f'<parent link="{parent}"/><child link="link_{limb}_{i}"/><origin xyz="0.02 0 0"/><axis xyz="0 0 1"/>'
                     '<limit lower="-1" upper="1" effort="10" velocity="1"/></joint>')
    return text + "</robot>"


class Drives(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        shutil.copy(ARM, self.folder)

    def visum(self, *words: str) -> subprocess.CompletedProcess:
        return subprocess.run([BIN / "visum", *words], cwd=self.folder, capture_output=True, text=True, timeout=300)

    def test_the_arm_moves_with_what_it_wrote(self):
        done = self.visum("drives", "six_axis.urdf", "-o", "drives.yaml", "--scene", "arm.yaml", "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        said = json.loads(done.stdout)
        self.assertEqual(said["written"], "drives.yaml")
        self.assertEqual([joint["name"] for joint in said["joints"]], ["pan", "lift", "elbow", "roll", "pitch", "yaw"])
        for joint in said["joints"]:
            self.assertEqual(set(joint), {"name", "class", "kp", "kd", "source"})
            self.assertGreater(joint["kp"], joint["kd"])
            self.assertGreater(joint["kd"], 0)
            self.assertIn("maxon", joint["source"])
        self.assertEqual(len(said["missing"]), 1)
        self.assertIn("yaw: the model's <limit> has no velocity", said["missing"][0])
        (self.folder / "move.yaml").write_text(yaml.safe_dump(scenario()))
        ran = self.visum("run", "move.yaml")
        self.assertEqual(ran.returncode, 0, ran.stdout + ran.stderr)

    def test_strength_follows_the_load(self):
        self.visum("drives", "six_axis.urdf", "-o", "drives.yaml")
        drives = {drive["joints"][0]: drive for drive in yaml.safe_load((self.folder / "drives.yaml").read_text())["drives"]}
        self.assertEqual(drives["lift"]["servo"], "250W")
        self.assertEqual(drives["yaw"]["servo"], "60W")
        # Outstretched, 7 kg at 0.2 m, 3 at 0.58, 1.2 at 0.81, 1.2 at 0.91 and 0.3 at 0.98 m: 5.5 kg m.
        comment = (self.folder / "drives.yaml").read_text().split("['lift']")[0].rsplit("# Behind it", 1)[1]
        self.assertIn("and 53.9 N·m of gravity", comment)

    def test_more_joints_than_a_bus_has_modules_are_several_parts(self):
        for limbs, counts in (((20, 15, 5), [20, 20]), ((40,), [31, 9]), ((31,), [31])):
            (self.folder / "many.urdf").write_text(limbs_of(limbs))
            done = self.visum("drives", "many.urdf", "-o", "drives.yaml", "--scene", "many.yaml", "--json", "--force")
            self.assertEqual(done.returncode, 0, done.stderr)
            said = json.loads(done.stdout)
            self.assertEqual(said["files"], ["drives.yaml", "drives_2.yaml"][:len(counts)])
            self.assertEqual(said["written"], "drives.yaml")
            self.assertEqual(len(said["joints"]), sum(counts))
            files = [yaml.safe_load((self.folder / file).read_text())["drives"] for file in said["files"]]
            self.assertEqual([len(drives) for drives in files], counts)
            parts = yaml.safe_load((self.folder / "many.yaml").read_text())["parts"]
            self.assertEqual([part["name"] for part in parts], ["many", "many_2"][:len(counts)])
            if len(parts) > 1:
                self.assertEqual([part["joints"] for part in parts],
                                 [[drive["joints"][0] for drive in drives] for drives in files])
            (self.folder / "move.yaml").write_text(yaml.safe_dump(
                {"visum_scenario": 1, "name": "move", "scene": "many.yaml", "clock": "lockstep", "max_sim_s": 5,
                 "until": {"at_s": 2},
                 "timeline": [{"at_s": 0.1, "set": {"part": parts[-1]["name"], "port": f"Desired Angle {counts[-1]}",
                                                    "value": 0.2}}],
                 "checks": [{"that": {"port": {"part": parts[-1]["name"], "name": f"Actual Angle {counts[-1]}"},
                                      "equals": 0.2, "within": 0.005}}]}))
            ran = self.visum("run", "move.yaml")
            self.assertEqual(ran.returncode, 0, ran.stdout + ran.stderr)

    def test_no_file_is_written_where_one_of_them_exists(self):
        (self.folder / "many.urdf").write_text(limbs_of((40,)))
        (self.folder / "drives_2.yaml").write_text("mine")
        done = self.visum("drives", "many.urdf", "-o", "drives.yaml", "--scene", "many.yaml")
        self.assertEqual(done.returncode, 2)
        self.assertIn("'drives_2.yaml' exists already", done.stderr)
        self.assertFalse((self.folder / "drives.yaml").exists() or (self.folder / "many.yaml").exists())
        self.assertEqual((self.folder / "drives_2.yaml").read_text(), "mine")

    def test_a_file_that_exists_stays(self):
        (self.folder / "drives.yaml").write_text("mine")
        done = self.visum("drives", "six_axis.urdf", "-o", "drives.yaml")
        self.assertEqual(done.returncode, 2)
        self.assertIn("'drives.yaml' exists already", done.stderr)
        self.assertIn("--force", done.stderr)
        self.assertEqual((self.folder / "drives.yaml").read_text(), "mine")
        self.assertEqual(self.visum("drives", "six_axis.urdf", "-o", "drives.yaml", "--force").returncode, 0)
        self.assertIn("servo: 250W", (self.folder / "drives.yaml").read_text())

    def test_bad_ends_are_clear(self):
        (self.folder / "stone.urdf").write_text("<robot name='stone'><link name='a'/></robot>")
        for words, code, says in [
                (("six_axis.urdf", "-o", "none/drives.yaml"), 2, "cannot write 'none/drives.yaml'"),
                (("nowhere.urdf", "-o", "d.yaml"), 3, "nowhere.urdf"),
                (("stone.urdf", "-o", "d.yaml"), 3, "has no joint that a drive could move"),
                (("six_axis.urdf",), 2, "--output is required")]:
            done = self.visum("drives", *words)
            self.assertEqual(done.returncode, code, words)
            self.assertIn(says, done.stderr, words)
            self.assertFalse((self.folder / "d.yaml").exists(), words)
        done = self.visum("drives", "stone.urdf", "-o", "d.yaml", "--json")
        self.assertIn("no joint", json.loads(done.stdout)["message"])

    def test_an_arm_too_heavy_is_geared_down_and_told(self):
        heavy = ARM.read_text().replace('<mass value="7"/>', '<mass value="60"/>')
        (self.folder / "heavy.urdf").write_text(heavy)
        done = self.visum("drives", "heavy.urdf", "-o", "drives.yaml", "--json")
        missing = json.loads(done.stdout)["missing"]
        self.assertTrue(any("lift: no class of the catalogue is strong enough" in one for one in missing), missing)

    def test_its_help_has_an_example(self):
        done = self.visum("drives", "--help")
        self.assertEqual(done.returncode, 0)
        self.assertIn("visum drives robot.urdf -o drives.yaml", done.stdout)
