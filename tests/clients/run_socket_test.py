"""The programs of one run meet on a Unix socket, and over TCP the run has the same bits."""
import json
import sys
import unittest

import yaml

from programs import BIN, SOURCE, visum
from run_test import Scenario

SCENARIOS = SOURCE / "models" / "scenarios"

# Joins the clock beside a controller, and after half a second of the world's time says by how many Unix and
# TCP connections the server is reached.
SPY = """import sys, visum
port = int(sys.argv[2])
with visum.Client(sys.argv[1], name='spy') as client:
    client.join()
    client.advance_ms(500)
    with open('/proc/net/unix') as sockets:  # a server's end has the name of its door, and the state 3
        local = sum(line.endswith(f'-{port}\\n') and line.split()[5] == '03' for line in sockets)
    with open('/proc/net/tcp') as sockets:  # a client's end has the port at the far side, and the state 1
        tcp = sum(line.split()[2].endswith(f':{port:04X}') and line.split()[3] == '01' for line in sockets)
    print(f'unix {local} tcp {tcp}')
"""


class Socket(Scenario):
    def spy(self):
        program = self.folder / "spy.py"
        program.write_text(SPY)
        return {"name": "spy", "exchanges": False, "command": [
            "env", f"PYTHONPATH={BIN.parent / 'python'}", sys.executable, str(program), "{connect}", "{port}"]}

    def run_first_seconds(self, name, *before):
        """The state's hash of a shipped scenario's first seconds, with `before` in front of its controller's command, and
        what the spy said."""
        text = (SCENARIOS / f"{name}.yaml").read_text().replace("{scenario_dir}", str(SCENARIOS))
        scenario = yaml.safe_load(text)
        (controller,) = scenario["controllers"]
        controller["command"] = [*before, *controller["command"]]
        scenario["controllers"].append(self.spy())
        scenario.update(scene=str(SCENARIOS / scenario["scene"]), until={"at_s": 3},
                        checks=[check for check in scenario["checks"] if check["name"] == "no drive is in fault"])
        file = self.folder / "first_seconds.yaml"
        file.write_text(yaml.safe_dump(scenario))
        done = visum("run", file, "--json", expect=0)
        said = [line.removeprefix("spy | ") for line in done.stderr.splitlines() if line.startswith("spy | ")]
        return json.loads(done.stdout.splitlines()[-1])["state_hash"], said

    def test_all_programs_of_a_run_meet_on_a_unix_socket(self):
        _, done = self.run_it(f"controllers: {json.dumps([self.spy()])}\n")
        self.assertIn("spy | unix 3 tcp 0\n", done.stderr, "the controller, and visum run twice")

    def test_over_tcp_a_controller_gives_the_same_bits(self):
        for name in ("pick_and_place", "crawler"):  # in C++, and in Python
            with self.subTest(name):
                local, over_unix = self.run_first_seconds(name)
                self.assertEqual(over_unix, ["unix 4 tcp 0"])
                distant, over_tcp = self.run_first_seconds(name, "env", "-u", "VISUM_LOCAL")
                self.assertEqual(over_tcp, ["unix 3 tcp 1"], "the controller alone does not know of the Unix socket")
                self.assertEqual(distant, local)


if __name__ == "__main__":
    unittest.main()
