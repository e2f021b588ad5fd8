"""Runs the real programs with and without kept meshes: the same bits, the same recorded files, and no second
conversion."""
import json
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
BIN = pathlib.Path(os.environ.get("VISUM_BIN", SOURCE / "build" / "dev" / "bin"))
BADGE = (SOURCE / "tests" / "scene" / "data" / "meshes" / "badge.dae").read_text()
PYRAMID = """<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema"
version="1.4.1"><asset><unit meter="1"/></asset><library_geometries><geometry id="g"><mesh><source id="s">
<float_array id="a" count="12">0 0 0 0.2 0 0 0 0.2 0 0 0 0.2</float_array><technique_common>
<accessor source="#a" count="4" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source><vertices id="v">
<input semantic="POSITION" source="#s"/></vertices><triangles count="4">
<input semantic="VERTEX" source="#v" offset="0"/><p>0 2 1 0 1 3 1 2 3 2 0 3</p></triangles></mesh>
</geometry></library_geometries><library_visual_scenes><visual_scene id="x"><node>
<rotate>0.3 0.4 1 33</rotate><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#x"/></scene></COLLADA>"""
ROBOT = """<robot name="robot"><link name="body"><inertial><mass value="1"/>
<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>
<visual><geometry><mesh filename="badge.dae"/></geometry></visual>
<collision><geometry><mesh filename="pyramid.dae"/></geometry></collision></link></robot>"""
SCENE = """visum: 1
models: [{name: robot, file: robot.urdf, fixed: false, pose: {xyz: [0, 0, 0.5]}}]
bodies: [{name: floor, fixed: true, shapes: [{plane: true}]}]
"""
SCENARIO = """visum_scenario: 1
name: falls
scene: scene.yaml
until: {at_s: 1.5}
checks:
- {name: it lies, that: {position: {body: robot/body, axis: z}, below: 0.3}}
"""


class Cache(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        for name, text in (("badge.dae", BADGE), ("pyramid.dae", PYRAMID), ("robot.urdf", ROBOT),
                           ("scene.yaml", SCENE), ("scenario.yaml", SCENARIO)):
            (self.folder / name).write_text(text)
        self.cache = self.folder / "cache"

    def do(self, *words, bin=BIN, **environment):
        kept = {name: value for name, value in os.environ.items()
                if name not in ("CACHE_DIRECTORY", "XDG_CACHE_HOME", "HOME")}
        return subprocess.run([bin / words[0], *words[1:]], cwd=self.folder, capture_output=True, text=True,
                              timeout=300, env={**kept, "XDG_CACHE_HOME": str(self.cache), **environment})

    def run_scenario(self, *words):
        done = self.do("visum", "run", "scenario.yaml", "--json", *words)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return json.loads(done.stdout.splitlines()[-1])["state_hash"]

    def entries(self):
        return sorted((self.cache / "visum").glob("*.answer"))

    def test_kept_meshes_give_the_same_run_and_recording(self):
        first = self.run_scenario("--no-cache", "--record", "a.mcap")
        self.assertFalse(self.cache.exists())
        self.assertEqual(self.run_scenario("--record", "b.mcap"), first)
        self.assertEqual(len(self.entries()), 2)
        self.assertEqual(self.run_scenario("--record", "c.mcap"), first)
        for other in ("b.mcap", "c.mcap"):
            same = self.do("visum", "compare", "a.mcap", other)
            self.assertEqual(same.returncode, 0, same.stdout + same.stderr)
            self.assertNotIn("file ", same.stdout, "files that differ are told, even if all ticks are equal")
            self.assertEqual(self.do("visum", "replay", other).returncode, 0)
        for entry in self.entries():
            entry.write_bytes(entry.read_bytes()[:-1])
        self.assertEqual(self.run_scenario(), first)
        pyramid = self.folder / "pyramid.dae"
        pyramid.write_text(PYRAMID.replace("0 0 0.2</float_array>", "0 0 0.3</float_array>"))
        self.assertNotEqual(self.run_scenario("--record", "d.mcap"), first)
        self.assertIn("file pyramid.dae", self.do("visum", "compare", "a.mcap", "d.mcap").stdout)

    def campaign(self, *words):
        done = self.do("visum", "campaign", "campaign.yaml", "--report", "results", "--jobs", "1", "--json", *words)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return json.loads(done.stdout.splitlines()[-1])

    def test_a_campaign_without_the_cache_makes_the_same_runs(self):
        (self.folder / "campaign.yaml").write_text(SCENARIO + "seed: ${seed}\nsweep: {seed: [1, 2]}\n")
        first = self.campaign("--no-cache")
        self.assertFalse(self.cache.exists())
        again = self.campaign("--fresh")
        self.assertEqual(len(self.entries()), 2)
        self.assertEqual(again["hash"], first["hash"])
        self.assertEqual(self.campaign("--no-cache")["reused"], 2, "the option does not make another campaign of it")

    def test_a_search_without_the_cache_finds_and_records_the_same_worst_case(self):
        (self.folder / "campaign.yaml").write_text(
            SCENARIO.replace("- {name: it lies", "- {name: lies") + "seed: ${seed}\nsweep: {seed: {integers: [1, 9]}}\n"
            "sampling: {method: random, runs: 2}\nsearch: {check: lies, runs: 2}\n")
        self.campaign("--no-cache", "--engine", "ode")
        self.assertFalse(self.cache.exists())
        self.assertIn('engine: "ode"', (self.folder / "results" / "worst.yaml").read_text())
        self.assertTrue((self.folder / "results" / "worst.mcap").exists())

    def test_the_program_for_real_modules_has_a_choice(self):
        words = ("visum-hwpart", "scene.yaml", "--bus", "tcp:127.0.0.1:1", "--port", "0")
        self.assertIn("part", self.do(*words, "--no-cache").stderr)  # the scene has none, but it was read
        self.assertFalse(self.cache.exists())
        self.do(*words)
        self.assertEqual(len(self.entries()), 2)

    def test_a_file_is_converted_once(self):
        programs = self.folder / "bin"
        programs.mkdir()
        for name in ("visumd", "visum-mesh"):
            shutil.copy(BIN / name, programs)
        reader = programs / "visum-mesh"

        def losses(*words, **environment):
            done = self.do("visumd", "check", "scene.yaml", "--json", *words, bin=programs, **environment)
            return done.returncode, json.loads(done.stdout).get("losses", [])
        first = losses()
        self.assertEqual(first[0], 0)
        self.assertIn("without the textures", first[1][0])
        os.truncate(reader, 8192)  # its build id is left, but it runs no more
        self.assertEqual(losses(), first)
        self.assertEqual(losses("--no-cache")[0], 3, "a collision needs its mesh")
        self.assertEqual(losses(XDG_CACHE_HOME="")[0], 3)
        self.assertEqual(losses(), first)

    def test_an_entry_names_the_code_that_made_it(self):
        self.run_scenario()
        lines = self.entries()[0].read_bytes().split(b"\n\n")[0].decode().splitlines()
        self.assertEqual(lines[0], "visum answer 1")
        files = dict(reversed(line.split(" ", 1)) for line in lines[1:])
        self.assertIn(str((BIN / "visum-mesh").resolve()), files)
        self.assertTrue(any("assimp" in file for file in files))
        for file, build in files.items():
            notes = subprocess.run(["readelf", "-n", file], capture_output=True, text=True).stdout
            self.assertEqual(re.search(r"Build ID: (\w+)", notes)[1], build)


if __name__ == "__main__":
    unittest.main()
