"""The scenarios that ship end in the states that CHANGELOG.md names, so that a change of one needs an entry there."""

import re
import unittest
from pathlib import Path

import yaml
from programs import BIN, MODELS
from scenario_runs import run_scenario

CHANGELOG = MODELS.parent / "CHANGELOG.md"
TAKE_LONG = {"explorer", "explorer_agent", "explorer_ray"}  # minutes

# "`cart` 11760fa030a893a1 → 89f845910054887f", "`cart` is 89f845910054887f now"
BY_NAME = re.compile(r"`(\w+)` (?:is )?([0-9a-f]{16})(?: → ([0-9a-f]{16}))?")
# "`server/run cart` drives in circles (state hash 89f845910054887f)"
IN_ENTRY = re.compile(r"(?:server/run |models/scenarios/)(\w+)(?:(?!server/run |models/scenarios/).)*?state hash ([0-9a-f]{16})")


def hashes_of(changelog: str) -> dict[str, str]:
    """The newest hash for each name. The newest entries stand first."""
    newest: dict[str, str] = {}
    for entry in re.split(r"^(?:- |#)", changelog, flags=re.MULTILINE):
        entry = " ".join(entry.split())
        for name, before, after in BY_NAME.findall(entry):
            newest.setdefault(name, after or before)
        for name, state_hash in IN_ENTRY.findall(entry):
            newest.setdefault(name, state_hash)
    return newest


def single_runs() -> list[Path]:
    files = sorted((MODELS / "scenarios").glob("*.yaml"))
    return [file for file in files if "sweep" not in yaml.safe_load(file.read_text(encoding="utf-8"))]


class Hashes(unittest.TestCase):
    def test_the_changelog_is_understood(self):
        found = hashes_of("- `a` 1111111111111111 → 2222222222222222, `b` is\n  3333333333333333 now\n"
                          "- `server/run c`, not `server/run d`: drives (state hash\n  4444444444444444)\n"
                          "## [0.1.0]\n- `a` 0000000000000000 → 1111111111111111\n")
        self.assertEqual(found, {"a": "2" * 16, "b": "3" * 16, "d": "4" * 16})

    def test_every_scenario_ends_in_the_state_that_the_changelog_names(self):
        known = hashes_of(CHANGELOG.read_text(encoding="utf-8"))
        files = single_runs()
        self.assertGreater(len(files), len(TAKE_LONG))
        for file in files:
            name = file.stem
            with self.subTest(name):
                self.assertIn(name, known, "CHANGELOG.md names no state hash of this scenario: add what visum run prints")
                if name in TAKE_LONG:
                    continue
                # LeakSanitizer waits at the end of a program, and under the time shim time passes meanwhile.
                printed = run_scenario(str(BIN / "visum"), file, env={"ASAN_OPTIONS": "detect_leaks=0"})["state_hash"]
                self.assertEqual(printed, known[name],
                                 f"{name} ends with the state hash {printed}, CHANGELOG.md says {known[name]}. If that is "
                                 f"intended, let its section of the next version say `{name}` OLD → {printed}, with the "
                                 "reason; else find the change that did it")


if __name__ == "__main__":
    unittest.main()
