"""A cycle of a run costs one message each way between its controller and visumd, and visum run has one for every eighth step."""
import json
import os
import shutil
import subprocess
import sys
import unittest

from programs import BIN, DEADLINE_S, SOURCE
from run_test import Scenario

CYCLES = 240  # of 10 ms, as a step of the run
FIRST, LAST = 40, 200  # the Advances between which messages are counted
COUNTED = LAST - FIRST
AHEAD = 8  # steps for which visum run sends one message
SLACK = 2  # how far visum run may be from the controller's cycle, in its messages
ATTEMPTS = 6

BOARD = "Trajectory"  # that a controller reads in each cycle, if it is told

# As cycles.cc, in Python.
CONTROLLER = """import sys, visum
with visum.Client(sys.argv[1], name='cycles') as client:
    arm = client.part('arm')
    desired = arm.inputs('Desired Angle')
    arm.acquire()
    client.join()
    for cycle in range(int(sys.argv[2])):
        desired[0] = 1e-3 * (cycle % 7)
        arm.write()
        client.advance_ms(10)
        arm.read()
        for board in sys.argv[3:]:
            arm.read_blackboard(board)
    client.leave()
    arm.release()
"""


class MessageCount(Scenario):
    def setUp(self):
        super().setUp()
        # visum run takes the visumd beside it.
        self.bin = self.folder / "bin"
        self.bin.mkdir()
        shutil.copy(BIN / "visum", self.bin)
        relay = self.bin / "visumd"
        relay.write_text(f"#!/bin/sh\nexec '{sys.executable}' '{SOURCE}/tests/clients/counting_relay.py' \"$@\"\n")
        relay.chmod(0o755)
        self.python = self.folder / "cycles.py"
        self.python.write_text(CONTROLLER)

    def counts_of(self, command, more="", code=0, boards=()):
        """The messages of each client between two Advances of the controller: [to the server, to the client]."""
        command = [str(word) for word in (*command, "{connect}", CYCLES, *boards)]
        scenario = self.write(f"settle_s: 0.1\ncontrollers:\n  - {{name: cycles, command: {json.dumps(command)}}}\n"
                              "checks:\n  - {that: {port: {part: arm, name: Part State}, below: 2}, when: always}\n" + more)
        file = self.folder / "counts"
        python = str(BIN.parent / "python")
        env = {**os.environ, "PYTHONPATH": python, "VISUM_PYTHON": python, "VISUM_REAL_VISUMD": str(BIN / "visumd"),
               "VISUM_COUNTS": str(file), "VISUM_COUNTED": "cycles"}
        done = subprocess.run([self.bin / "visum", "run", scenario], env=env, capture_output=True, text=True, timeout=DEADLINE_S)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        lines = file.read_text().splitlines()
        self.assertEqual(len(lines), CYCLES)
        first, last = json.loads(lines[FIRST]), json.loads(lines[LAST])
        return {name: [b - a for a, b in zip(first[name], last[name])] for name in last}

    def assert_one_each_way(self, command, *boards):
        """A client sends its exact number each time. visumd keeps no answer back any longer where the machine stalls for a
        millisecond, and then it sends more often than it has to: the least of some runs counts."""
        least = {}
        for _ in range(ATTEMPTS):
            for name, counts in self.counts_of(command, boards=boards).items():
                least[name] = [min(pair) for pair in zip(counts, least.get(name, counts))]
            self.assertEqual(least["cycles"][0], COUNTED)
            self.assertAlmostEqual(least["scenario"][0], COUNTED // AHEAD, delta=SLACK)
            if least["cycles"][1] == COUNTED and least["scenario"][1] <= COUNTED // 2:
                break
        self.assertEqual(least["cycles"][1], COUNTED)
        self.assertLessEqual(least["scenario"][1], COUNTED // 2, "visum run is woken for many steps at once")
        self.assertGreater(least["scenario"][1], 0)
        self.assertEqual(least["scenario-waits"], [0, 0])

    def test_a_cycle_of_a_controller_in_cpp_is_one_message_each_way(self):
        self.assert_one_each_way([BIN / "visum-test-cycles"])

    def test_a_cycle_of_a_controller_in_python_is_one_message_each_way(self):
        self.assert_one_each_way([sys.executable, self.python])

    def test_a_blackboard_that_is_read_in_each_cycle_comes_along(self):
        self.assert_one_each_way([BIN / "visum-test-cycles"], BOARD)
        self.assert_one_each_way([sys.executable, self.python], BOARD)

    def test_where_a_condition_decides_visum_run_has_a_message_for_each_step(self):
        never = "timeline:\n  - {when: {port: {part: arm, name: Part State}, above: 99}, say: never}\n"
        counts = self.counts_of([BIN / "visum-test-cycles"], never, code=1)
        self.assertAlmostEqual(counts["scenario"][0], COUNTED, delta=SLACK)
        self.assertGreaterEqual(counts["scenario"][1], COUNTED - SLACK)


if __name__ == "__main__":
    unittest.main()
