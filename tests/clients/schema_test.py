"""The schema, the page, the shipped scenarios and the program say the same."""
import json
import pathlib
import re
import tempfile
import unittest

import jsonschema
import yaml

from programs import SOURCE, visum

FOLDER = SOURCE / "clients" / "visum"
SCHEMA = json.loads((FOLDER / "scenario.schema.json").read_text())
PAGE = (FOLDER / "SCENARIOS.md").read_text()
EXAMPLES = [text for text in re.findall(r"```yaml\n(.*?)```", PAGE, re.S) if "visum_scenario" in text]
SHIPPED = sorted((SOURCE / "models" / "scenarios").glob("*.yaml"))
HEAD = {"visum_scenario": 1, "name": "n", "scene": str(SOURCE / "models/scenes/amtec_arm.yaml"), "until": {"at_s": 0.01}}

# Wrong for the program and for the schema. Additions to HEAD.
WRONG = [
    {"nonsense": 1}, {"visum_scenario": 2}, {"name": ""}, {"clock": "fast"}, {"seed": -1}, {"seed": 1.5},
    {"max_sim_s": 0}, {"max_wall_s": "long"}, {"settle_s": -1}, {"check_every_ms": 0}, {"check_every_ms": 4001},
    {"until": "never"}, {"until": {"at_s": -1}}, {"until": {"at_s": 1, "below": 1}}, {"until": {"below": 1}},
    {"controllers": {}}, {"controllers": [{}]}, {"controllers": [{"name": "a"}]},
    {"controllers": [{"name": "a", "command": []}]}, {"controllers": [{"name": "a", "command": ["a"], "joins": "no"}]},
    {"controllers": [{"name": "a", "command": ["a"], "shim": True, "gate": "bus:arm"}]},
    {"controllers": [{"name": "a", "command": ["a"], "period_ms": 10}]},
    {"controllers": [{"name": "a", "command": ["a"], "shim": False, "wait_s": 1}]},
    {"controllers": [{"name": "a", "command": ["a"], "gate": "", "on_timeout": "end"}]},
    {"timeline": [{}]}, {"timeline": [{"at_s": 1}]}, {"timeline": [{"say": "x"}]},
    {"timeline": [{"at_s": 1, "say": "x", "kill": "y"}]}, {"timeline": [{"at_s": 1, "when": {}, "say": "x"}]},
    {"timeline": [{"at_s": 1, "set": {"part": "arm", "port": "Halt"}}]},
    {"timeline": [{"at_s": 1, "push": {"body": "box", "force_n": [1, 2]}}]},
    {"timeline": [{"at_s": 1, "push": {"body": "box", "force_n": [1, 2, 3], "duration_s": 0}}]},
    {"timeline": [{"at_s": 1, "fault": {"part": "arm"}}]},
    {"timeline": [{"at_s": 1, "fault": {"part": "arm", "kind": "encoder_stuck", "numbers": {"joint": "x"}}}]},
    {"timeline": [{"at_s": 1, "fault": {"part": "arm", "kind": "emergency_stop", "for_s": 0}}]},
    {"timeline": [{"at_s": 1, "clear_fault": {"part": "arm", "joint": 0}}]},
    {"timeline": [{"at_s": 1, "clear_fault": {"part": "arm", "joint": 1001}}]},
    {"timeline": [{"at_s": 1, "signal": {"controller": "a", "signal": "STOP"}}]},
    {"checks": [{}]}, {"checks": [{"that": {}}]}, {"checks": [{"that": {"below": 1}}]},
    {"checks": [{"that": {"speed": {"body": "box"}}}]},
    {"checks": [{"that": {"speed": {"body": "box"}, "below": "x"}}]},
    {"checks": [{"that": {"speed": {"body": "box"}, "tilt": {"body": "box"}, "below": 1}}]},
    {"checks": [{"that": {"speed": {"body": "box", "axis": "z"}, "below": 1}}]},
    {"checks": [{"that": {"distance": {"body": "box", "to": [1, 2]}, "below": 1}}]},
    {"checks": [{"that": {"position": {"body": "box"}, "below": 1}}]},
    {"checks": [{"that": {"coverage": {"body": "box", "within": 0, "from": [0, 0], "to": [1, 1]}, "below": 1}}]},
    {"checks": [{"that": {"coverage": {"body": "box", "within": 1, "cell": 10001, "from": [0, 0], "to": [1, 1]}, "below": 1}}]},
    {"checks": [{"that": {"speed": {"body": "box"}, "below": 1, "within": 1}}]},
    {"checks": [{"that": {"peak_following_error": {"part": "arm", "joint": "j"}, "below": 1}}]},
    {"checks": [{"that": {"port": {"part": "arm", "name": "Part State", "mask": 0}, "below": 1}}]},
    {"checks": [{"that": {"speed": {"body": "box"}, "below": 1}, "when": "sometimes"}]},
    {"checks": [{"that": {"speed": {"body": "box"}, "below": 1}, "when": {"by_s": 1, "to_s": 2}}]},
    {"sampling": {"method": "sobol", "runs": 3}}, {"sweep": {"a": [1]}, "sampling": {"method": "dice", "runs": 3}},
    {"sweep": {"a": [1]}, "sampling": {"method": "sobol", "runs": 0}}, {"sweep": {"a": [1]}, "sampling": {"method": "sobol"}},
    {"sweep": {"a": {"uniform": [1]}}, "sampling": {"method": "sobol", "runs": 3}},
    {"sweep": {"a": {"normal": [0, 1], "betwen": [0, 1]}}, "sampling": {"method": "sobol", "runs": 3}},
    {"sweep": {"a": [1]}, "search": {"runs": 5}}, {"search": {"runs": 5}},
    {"sweep": {"a": [1]}, "checks": [{"that": {"time": {}, "above": 1}}], "search": {"runs": 0}},
    {"sweep": {"a": [1]}, "checks": [{"that": {"time": {}, "above": 1}}], "search": {"runs": 5, "population": 3}},
    {"sweep": {"a": [1]}, "checks": [{"that": {"time": {}, "above": 1}}], "search": {"runs": 5, "until": "found"}},
    {"decide": {"at_least": 0.9}}, {"decide": {"at_least": 1, "reject_below": 0.5}},
    {"decide": {"at_least": 0.9, "reject_below": 0.5, "false_accept": 0.6}},
]

# Right for the program and for the schema: a text may look like a number or a truth value, as in YAML.
RIGHT = [
    {"name": 7}, {"description": True}, {"checks": [{"name": 1, "that": {"speed": {"body": "box"}, "above": -1}}]},
    {"controllers": [{"name": 1, "command": ["sleep", 9], "joins": False, "exchanges": False}],
     "timeline": [{"at_s": 0, "say": 5}, {"at_s": 0, "kill": 1}]},
    {"controllers": [{"name": "a", "command": ["sleep", 0], "shim": True, "wait_s": 10, "exchanges": False}]},
    {"sweep": {"a": {"normal": [0, 1], "between": [-1, 2]}, "b": {"integers": [1, 5]}, "c": {"log_uniform": [1, 10]}, "d": [1]},
     "sampling": {"method": "latin_hypercube", "runs": 3, "seed": 7}, "decide": {"at_least": 0.9, "reject_below": 0.5}},
]


def validator():
    jsonschema.Draft202012Validator.check_schema(SCHEMA)
    return jsonschema.Draft202012Validator(SCHEMA)


class Schema(unittest.TestCase):
    def test_takes_the_shipped_scenarios(self):
        self.assertTrue(SHIPPED)
        for file in SHIPPED:
            validator().validate(yaml.safe_load(file.read_text()))

    def test_takes_the_examples_of_the_page(self):
        self.assertGreaterEqual(len(EXAMPLES), 2)
        for example in EXAMPLES:
            validator().validate(yaml.safe_load(example))

    def test_refuses_what_the_program_refuses(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "wrong.yaml"
            for addition in WRONG:
                scenario = {**HEAD, **addition}
                self.assertFalse(validator().is_valid(scenario), addition)
                file.write_text(yaml.safe_dump(scenario, sort_keys=False))
                error = visum("run", file, expect=3).stderr
                self.assertRegex(error, rf"^visum: {re.escape(str(file))}:\d+: ", addition)

    def test_takes_what_the_program_takes(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "right.yaml"
            for addition in RIGHT:
                scenario = {**HEAD, **addition}
                validator().validate(scenario)
                file.write_text(yaml.safe_dump(scenario, sort_keys=False))
                visum("run", file)

    def test_names_every_quantity_and_action_of_the_page(self):
        condition = SCHEMA["$defs"]["condition"]["properties"]
        bounds = {"below", "above", "between", "equals", "within"}
        for quantity in set(condition) - bounds:
            self.assertIn(f"`{quantity}: {{", PAGE, quantity)
        for action in set(SCHEMA["$defs"]["timeline_entry"]["properties"]) - {"at_s", "when", "repeat"}:
            self.assertRegex(PAGE, rf"(?m)^\| `{action}: ", action)
        for key in SCHEMA["properties"]:
            self.assertRegex(PAGE, rf"(?m)^\| .*`{key}`", key)

    def test_names_every_quantity_of_the_program(self):
        table = (FOLDER / "run" / "quantity.cc").read_text().split("kKinds[] = {")[1]
        kinds = set(re.findall(r'\{"(\w+)",\s*"', table)) - {"body", "part", "joint"}
        condition = set(SCHEMA["$defs"]["condition"]["properties"]) - {"below", "above", "between", "equals", "within"}
        self.assertEqual(kinds, condition)


if __name__ == "__main__":
    unittest.main()
