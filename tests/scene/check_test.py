"""Runs `visum check` on the scenes that ship, and on those of bad/. Each of those is wrong in one way, with its error beside it.

    python3 -m unittest check_test                    compares
    VISUM_WRITE_ERRORS=1 python3 -m unittest check_test    writes the errors of bad/ anew, to be read before they are kept
"""
import json
import os
import pathlib
import resource
import subprocess
import tempfile
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
BIN = pathlib.Path(os.environ.get("VISUM_BIN", SOURCE / "build" / "dev" / "bin"))
BAD = SOURCE / "tests" / "scene" / "bad"
SCENES = sorted((SOURCE / "models" / "scenes").glob("*.yaml"))
MANY_ERRORS = """\
visum: 1
name: many
bodies:
- {name: box, mass: -1, shapes: [{box: [1, 1, 1]}]}
- {name: ball, mass: 1, shapes: [{sphere: 1}]}
- {name: thing, fixed: true, shapes: [{bx: [1, 1, 1]}]}
joints:
- {name: a, type: fixed, child: box}
- {name: b, type: fixed, child: bll}
sensors:
- {name: eye, kind: distance, body: ball, range: [1]}
- {name: ear, kind: distance, body: ball}
"""
MEMORY = 2 << 30  # bytes of address space; a bomb that goes off would not fit
SECONDS = 60  # of processor time, on whatever machine
VISUMD = (BIN / "visumd").read_bytes()
SANITIZED = b"__asan_init" in VISUMD or b"__tsan_init" in VISUMD  # reserves terabytes of addresses


def limit():
    if not SANITIZED:
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS))


def check(*words, cwd=SOURCE):
    return subprocess.run([BIN / "visum", "check", *map(str, words)], cwd=cwd, capture_output=True, text=True,
                          errors="replace", preexec_fn=limit, timeout=600)


class Check(unittest.TestCase):
    def test_the_scenes_that_ship_are_right(self):
        self.assertGreater(len(SCENES), 4)
        for scene in SCENES:
            done = check(scene.relative_to(SOURCE))
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn(f"{scene.relative_to(SOURCE)} is right: ", done.stdout)

    def test_takes_a_bare_model(self):
        found = json.loads(check("models/two_link/two_link.urdf", "--json").stdout)
        self.assertEqual((found["right"], found["bodies"], found["joints"], found["parts"]), (True, 4, 2, 1))
        self.assertEqual(found["actuated"], ["two_link/shoulder", "two_link/elbow"])
        self.assertEqual((found["warnings"], found["repairs"], found["overlaps"]), ([], [], []))

    def test_tells_what_overlaps_at_the_start(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "s.yaml"
            boxes = "".join(f"- {{name: b{i}, mass: 1, pose: {{xyz: [0, 0, {0.9 * i}]}}, shapes: [{{box: [1, 1, 1]}}]}}\n"
                            for i in range(13))
            file.write_text("visum: 1\nbodies:\n" + boxes)
            found = json.loads(check(file, "--json").stdout)["overlaps"]
            self.assertEqual(sorted((one["a"], one["b"]) for one in found),
                             sorted((f"b{i}", f"b{i + 1}") for i in range(12)))
            for one in found:
                self.assertAlmostEqual(one["depth_m"], 0.1, 9)
            done = check(file)
            self.assertEqual(done.stdout.count("overlap at the start by 0."), 10)
            self.assertIn("and 2 further pairs overlap at the start", done.stdout)

    def test_tells_warnings_and_repairs_with_file_and_line(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "r.urdf"
            file.write_text("<robot name='r'>\n<link name='a'><visual><geometry><mesh filename='package://p/gone.stl'/>"
                            "</geometry></visual></link>\n<link name='b'/><joint name='j' type='continuous'>"
                            "<parent link='a'/><child link='b'/></joint></robot>")
            done = check(file, "--json", "--package", f"p={folder}")
            found = json.loads(done.stdout)
            self.assertEqual([(one["file"], one["line"]) for one in found["warnings"]], [(str(file), 2)])
            self.assertIn("package://p/gone.stl", found["warnings"][0]["message"])
            self.assertEqual([(one["file"], one["line"]) for one in found["repairs"]], [(str(file), 3)])
            self.assertEqual(done.returncode, 0)
            (pathlib.Path(folder) / "gone.stl").write_text(
                "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n")
            found = json.loads(check(file, "--json", "--package", f"p={folder}").stdout)
            self.assertEqual(found["warnings"], [])
            wrong = check(file, "--package", "p")
            self.assertEqual(wrong.returncode, 2)
            self.assertIn("must be NAME=PATH, is 'p'", wrong.stderr)

    def test_takes_bare_x3d(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "box.wrl"
            file.write_text("#VRML V2.0 utf8\nShape { geometry Box { size 1 1 1 } }\n")
            done = check(file)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("1 body", done.stdout)

    def test_counts_what_is_in_a_scene(self):
        line = check("models/scenes/cart.yaml").stdout.splitlines()[-1]
        self.assertEqual(line, "models/scenes/cart.yaml is right: 8 bodies, 6 joints, 1 part")
        found = json.loads(check("models/scenes/cart.yaml", "--json").stdout)
        self.assertEqual((found["right"], found["bodies"], found["parts"], found["losses"]), (True, 8, 1, []))

    def test_json_tells_the_place_of_an_error_apart(self):
        done = check("misspelt_key.yaml", "--json", cwd=BAD)
        self.assertEqual(done.returncode, 3)
        self.assertEqual(json.loads(done.stdout), {
            "right": False, **(error := {
                "file": "misspelt_key.yaml", "line": 2, "key": "",
                "message": "unknown key 'gravtiy'; did you mean 'gravity'?"}), "errors": [error]})

    def test_tells_all_that_is_wrong_and_nothing_that_only_follows(self):
        with tempfile.TemporaryDirectory() as folder:
            scene = pathlib.Path(folder) / "s.yaml"
            scene.write_text(MANY_ERRORS)
            done = check("s.yaml", cwd=folder)
            self.assertEqual(done.returncode, 3)
            self.assertEqual([line.removeprefix("visumd: error: ") for line in done.stderr.splitlines()], [
                "s.yaml:4: bodies[0].mass: must be greater than 0, is -1",
                "s.yaml:6: bodies[2].shapes[0]: unknown key 'bx'; did you mean 'box'?",
                "s.yaml:9: joints[1].child: there is no body 'bll'; did you mean 'ball'?"])
            # Keys of parts and sensors are checked later, when the world is made.
            scene.write_text(MANY_ERRORS.replace("mass: -1", "mass: 1").replace("bx:", "box:").replace("bll", "ball"))
            self.assertEqual([line.removeprefix("visumd: error: ") for line in check("s.yaml", cwd=folder).stderr.splitlines()], [
                "s.yaml:11: sensors[0].range: must be a list of 2 numbers, has 1",
                "s.yaml:12: sensors[1]: key 'range' is missing"])

    def test_an_engine_can_be_asked_about(self):
        self.assertEqual(check("models/scenes/cart.yaml", "--engine", "impulse").returncode, 0)
        self.assertEqual(check("models/scenes/cart.yaml", "--engine", "odd").returncode, 2)

    def test_wrong_usage_is_no_wrong_scene(self):
        self.assertEqual(check().returncode, 2)
        self.assertEqual(check("a.yaml", "--nonsense").returncode, 2)
        self.assertEqual(check("--help").returncode, 0)


class BadScenes(unittest.TestCase):
    """Each ends with exit code 3 and its error: no crash, no hang, no excessive memory."""

    def test_there_are_many(self):
        self.assertGreaterEqual(len(list(BAD.glob("*.yaml"))), 60)
        stems = {file.stem for file in BAD.glob("*.yaml")}
        self.assertEqual(stems, {file.stem for file in BAD.glob("*.error")})

    def test_each_says_what_is_wrong_where_and_what_was_meant(self):
        for scene in sorted(BAD.glob("*.yaml")):
            with self.subTest(scene.stem):
                done = check(scene.name, cwd=BAD)
                self.assertEqual(done.returncode, 3, done.stdout + done.stderr)
                self.assertEqual(done.stdout, "")
                expected = scene.with_suffix(".error")
                if os.environ.get("VISUM_WRITE_ERRORS"):
                    expected.write_text(done.stderr)
                self.assertEqual(done.stderr, expected.read_text())


if __name__ == "__main__":
    unittest.main()
