"""The schema of scenes agrees with the loader, the page and the scenes that ship."""
import json
import pathlib
import re
import unittest

import jsonschema
import yaml

SOURCE = pathlib.Path(__file__).resolve().parents[2]
SCHEMA = json.loads((SOURCE / "server" / "scene" / "scene.schema.json").read_text())
README = (SOURCE / "server" / "scene" / "README.md").read_text()
BAD = SOURCE / "tests" / "scene" / "bad"

# The functions of the loader that list known keys, and the place of the same list in the schema.
LOADER = {
    "server/scene/scene_loader.cc check_header": "",
    "server/scene/includes.cc read_include": "$defs/include/anyOf/1",
    "server/scene/frames.cc read_frame": "$defs/frame",
    "server/scene/settings.cc engine_keys": "$defs/engine_settings",
    "server/scene/settings.cc read_surface": "$defs/surface",
    "server/scene/settings.cc read_collision": "$defs/collision",
    "server/scene/read_looks.cc read_material": "$defs/material",
    "server/scene/read_looks.cc read_light": "$defs/light",
    "server/scene/read_looks.cc read_viewpoint": "$defs/viewpoint",
    "server/scene/models.cc read_model": "$defs/model",
    "server/scene/models.cc read_pairs": "$defs/no_collision_rules",
    "server/scene/bodies.cc read_body": "$defs/body",
    "server/scene/bodies.cc read_motion": "$defs/velocity",
    "server/scene/shapes.cc read_shape": "$defs/shape",
    "server/scene/shapes.cc read_sphere": "$defs/sphere",
    "server/scene/shapes.cc read_round": "$defs/round",
    "server/scene/joints.cc read_joint": "$defs/joint",
    "server/scene/values.cc read_pose_in": "$defs/world_pose",
    "hwparts/servo_group/part_options.cc read_options": "$defs/part",
    "hwparts/powercube/settings.cc allow_keys": "$defs/module",
    "hwparts/ideal_joints/actuator.cc read_actuator": "$defs/actuator",
}

# Scenes that the schema alone must refuse, without other files and without knowing names.
WRONG = ["body_too_far", "body_with_a_slash", "camera_bent", "camera_too_large", "clock_misspelt", "engine_key_unknown", "engine_order", "engine_unknown",
         "frame_of_a_shape", "gravity_of_two", "include_key_misspelt", "joint_type_misspelt", "light_kind_misspelt",
         "list_at_the_top", "misspelt_key", "no_version", "part_key_misspelt", "part_kind_unknown", "repeat_endless",
         "repeat_negative", "scanner_of_two_turns", "seed_with_a_point", "sensor_range_too_far", "shape_color", "shape_flat_box", "shape_with_two_forms",
         "shape_without_form", "surface_negative", "tick_of_zero", "version_of_tomorrow"]


class Yaml(yaml.SafeLoader):
    """Reads 1e-9 as a number, as YAML 1.2 and editors do."""


Yaml.add_implicit_resolver("tag:yaml.org,2002:float", re.compile(r"^[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?$"),
                           list("-+.0123456789"))


def validator():
    jsonschema.Draft202012Validator.check_schema(SCHEMA)
    return jsonschema.Draft202012Validator(SCHEMA)


def at(pointer):
    node = SCHEMA
    for word in filter(None, pointer.split("/")):
        node = node[int(word) if isinstance(node, list) else word]
    return node


def known_keys(file, function, start=r"allow_only\(\s*\{|known\{"):
    """The texts of the first list of keys after the function's head."""
    text = (SOURCE / file).read_text()
    body = text[re.search(rf"(?m)^[\w:<>&\[\] ]*\b{function}\(", text).start():]
    first = re.search(start, body).end()
    return set(re.findall(r'"(\w+)"', body[first:body.index("}", first)]))


def scenes():
    for file in sorted([*SOURCE.glob("models/**/*.yaml"), *SOURCE.glob("tests/scene/data/*.yaml")]):
        text = yaml.load(file.read_text(), Yaml)
        if isinstance(text, dict) and "visum" in text:
            yield file, text


class Schema(unittest.TestCase):
    def test_takes_the_scenes_that_ship(self):
        found = list(scenes())
        self.assertGreater(len(found), 8)
        for file, scene in found:
            self.assertEqual([f"{list(e.absolute_path)}: {e.message}" for e in validator().iter_errors(scene)], [], file)

    def test_takes_the_examples_of_the_page(self):
        examples = [yaml.load(text, Yaml) for text in re.findall(r"```yaml\n(.*?)```", README, re.S)]
        whole = [example for example in examples if isinstance(example, dict) and "visum" in example]
        self.assertGreaterEqual(len(whole), 3)
        for example in whole:
            validator().validate(example)

    def test_refuses_what_is_wrong_by_itself(self):
        for name in WRONG:
            scene = yaml.load((BAD / f"{name}.yaml").read_text(), Yaml)
            self.assertFalse(validator().is_valid(scene), name)

    def test_knows_every_key_that_the_loader_knows_and_no_other(self):
        for place, pointer in LOADER.items():
            keys = known_keys(*place.split())
            self.assertTrue(keys, place)
            schema = set(at(pointer)["properties"]) - {"repeat"}
            if place.startswith("hwparts/servo_group/"):  # the entry of a part has the keys of all kinds
                schema -= known_keys("hwparts/ideal_joints/ideal_joints.cc", "IdealJoints::IdealJoints") - keys
            self.assertEqual(keys, schema, place)

    def test_knows_every_key_of_every_kind_of_sensor(self):
        common = known_keys("hwparts/sensors/sensor.cc", "allow_keys", r"keys\{")
        folder = SOURCE / "hwparts" / "sensors"
        kinds = re.findall(r'\{"(\w+)", "', (folder / "sensor_kinds.cc").read_text())
        self.assertEqual([one["$ref"] for one in at("$defs/sensor")["oneOf"]], [f"#/$defs/sensor_{kind}" for kind in kinds])
        for kind in kinds:
            own = re.search(r"allow_keys\(\s*[\w.]+,\s*\{(.*?)\}\)", (folder / f"{kind}.cc").read_text(), re.S)[1]
            keys = common | set(re.findall(r'"(\w+)"', own))
            self.assertEqual(keys, set(at(f"$defs/sensor_{kind}")["properties"]) - {"repeat"}, kind)
        self.assertEqual(known_keys("hwparts/sensors/accuracy.cc", "read_symmetric"), set(at("$defs/accuracy")["properties"]))

    def test_no_list_of_keys_of_the_loader_is_forgotten(self):
        files = [*SOURCE.glob("server/scene/*.cc"), SOURCE / "hwparts/servo_group/part_options.cc",
                 SOURCE / "hwparts/powercube/settings.cc", SOURCE / "hwparts/ideal_joints/actuator.cc"]
        lists = {str(file.relative_to(SOURCE)): len(re.findall(r'allow_only\(\s*\{"|known\{"', file.read_text()))
                 for file in files}
        compared = [place.split()[0] for place in LOADER]
        self.assertEqual({file: number for file, number in lists.items() if number},
                         {file: compared.count(file) for file in compared})

    def test_every_entry_of_a_list_can_be_repeated(self):
        for name in ("frame", "model", "body", "shape", "joint", "part", "light", "viewpoint"):
            self.assertIn("repeat", at(f"$defs/{name}")["properties"], name)

    def test_the_page_explains_every_key(self):
        for key in SCHEMA["properties"]:
            self.assertIn(key, README, key)


if __name__ == "__main__":
    unittest.main()
