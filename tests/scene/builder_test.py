"""The Python builder of scenes writes the same scenes as a person would by hand."""
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import yaml

SOURCE = pathlib.Path(__file__).resolve().parents[2]
BIN = pathlib.Path(os.environ.get("VISUM_BIN", SOURCE / "build" / "dev" / "bin"))
sys.path.insert(0, str(SOURCE / "clients" / "python" / "visum"))  # this one file needs no protobuf

import scene as builder  # noqa: E402
from scene import Scene, box, capsule, convex, cylinder, mesh, pose, sphere  # noqa: E402
from schema_test import Yaml, validator  # noqa: E402

DATA = SOURCE / "tests" / "scene" / "data"
HALF_PI = 1.5707963267948966


def complete() -> Scene:
    """Builds data/complete.yaml."""
    scene = Scene("cell", gravity=(0, 0, -9.81), tick_ms=1, clock="realtime", speed=1.0, seed=1, lockstep_timeout_s=10,
                  engine={"kind": "ode", "step": "world", "iterations": 20, "erp": 0.2, "cfm": 1e-9})
    scene.include("room.yaml")
    scene.engine("fast", "ode", step="quick")
    scene.surface("default", friction=0.8, restitution=0.0)
    scene.surface("rubber", friction=1.1)
    scene.model("arm", pathlib.Path("robot.urdf"), pose=pose(0, 0, 0.2, rpy=(0, 0, HALF_PI)), fixed=True,
                joints={"shoulder": 0.5}, surface="default", surfaces={"tool": "rubber"}, self_collision=True,
                no_collision=[("base", "lower_arm")])
    scene.body("table", fixed=True, pose=pose(0.6, 0, 0.1), color=(0.5, 0.4, 0.3), shapes=[box(0.5, 1.0, 0.2)])
    scene.body("ball", density=500, pose=pose(0.5, 0, 0.5, wxyz=(1, 0, 0, 0)),
               velocity={"linear": (0, 0, 1), "angular": (0, 0.5, 0)}, engine="fast",
               shapes=[sphere(0.05, surface="rubber")])
    scene.body("wedge", mass=0.3, pose=pose(0.6, 0.3, 0.3),
               shapes=[convex("wedge.obj", scale=0.1, name="body"),
                       cylinder(0.01, 0.2, pose=pose(0, 0, 0.1), collides=False)])
    scene.body("crate", mass=2, inertia=(0.02, 0.02, 0.03, 0, 0, 0), com=(0, 0, -0.05), pose=pose(1.5, 0, 0.2),
               shapes=[mesh("wedge.obj", scale=(0.2, 0.2, 0.2))])
    scene.body("lid", mass=0.1, pose=pose(1.5, 0, 0.5), shapes=[capsule(0.01, 0.1)])
    scene.joint("hinge", "hinge", "lid", parent="crate", pose=pose(0, 0.1, 0.3), axis=(1, 0, 0), limits=(0, 1.5),
                friction=0.01, damping=0.02, stop_restitution=0.1, position=0.2)
    scene.no_collision("ball", "arm/lower_arm")
    return scene


class Builder(unittest.TestCase):
    def test_a_complete_scene_is_the_one_that_a_hand_wrote(self):
        by_hand = yaml.load((DATA / "complete.yaml").read_text(), Yaml)
        scene = complete()
        for part in by_hand["parts"]:
            scene.part(**part)
        self.assertEqual(yaml.load(scene.yaml(), Yaml), by_hand)

    def test_what_it_writes_is_right(self):
        with tempfile.TemporaryDirectory() as folder:
            scene = Scene("fleet", parameters={"carts": 3})
            scene.frame("row", pose(1, 0, 0))
            scene.include(SOURCE / "models" / "scenes" / "hall.yaml")
            scene.include(SOURCE / "models" / "cart" / "cart.yaml", repeat="${carts}",
                          parameters={"name": "cart_${index}"}, pose=pose(0, "${index}", 0, frame="row"))
            scene.write(pathlib.Path(folder) / "fleet.yaml")
            self.assertTrue(validator().is_valid(yaml.load(scene.yaml(), Yaml)))
            done = subprocess.run([BIN / "visum", "check", "fleet.yaml", "--json"], cwd=folder, capture_output=True,
                                  text=True, timeout=300)
            self.assertEqual(json.loads(done.stdout)["parts"], 3, done.stderr)

    def test_knows_every_key_of_the_file(self):
        schema = json.loads((SOURCE / "server" / "scene" / "scene.schema.json").read_text())
        text = pathlib.Path(builder.__file__).read_text()
        known = set(re.findall(r'"(\w+)"', text))
        self.assertEqual(set(schema["properties"]) - known, set())
        for entry in ("model", "body", "shape", "material", "surface", "frame"):
            self.assertEqual(set(schema["$defs"][entry]["properties"]) - known
                             - {"box", "sphere", "cylinder", "capsule", "plane", "mesh", "convex"}, set(), entry)

    def test_refuses_what_no_scene_can_hold(self):
        with self.assertRaisesRegex(ValueError, "finite"):
            pose(float("nan"), 0, 0)
        with self.assertRaisesRegex(TypeError, "object"):
            Scene(gravity=object())
        scene = Scene()
        scene.surface("rubber", friction=1)
        with self.assertRaisesRegex(ValueError, "already"):
            scene.surface("rubber", friction=2)


if __name__ == "__main__":
    unittest.main()
