"""Records the sessions of this release. Run it when the protocol is released under a new version; never record the sessions of
an earlier release anew.

    PYTHONPATH=build/dev/python tests/conformance/record.py v1 [--bin FOLDER]
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from pathlib import Path

from google.protobuf import text_format
from sessions import Wire, parsed
from visum import visum_pb2 as pb

HERE = Path(__file__).resolve().parent
SCENES = HERE.parents[1] / "models/scenes"
SCENE = "two_link.yaml"

HELLO = "hello {min_version: 1 max_version: 1 client_name: '%s' role: ROLE_%s}"
LEASE = "acquire_lease {part: 'robot'}"

# The number of the client, and its request in Protobuf's text form.
SESSIONS = {
    "control": [
        (1, HELLO % ("script", "CONTROLLER")), (1, "list_parts {}"), (1, "describe_part {part: 'robot'}"), (1, LEASE),
        (1, "join {}"), (1, "write {part: 'robot' first_port: 0 values: [0.5, 0.75]}"), (1, "advance {ticks: 10}"),
        (1, "read {part: 'robot'}"), (1, "write {part: 'robot' first_port: 1 values: [0.25] sequence: 7}"), (1, "advance {ticks: 5}"),
        (1, "read {part: 'robot'}"), (1, "leave {}"), (1, "release_lease {part: 'robot'}"), (1, "status {}"),
    ],
    "refusals": [
        (1, HELLO % ("script", "CONTROLLER")), (1, "write {part: 'robot' values: [0]}"), (1, "acquire_lease {part: 'robbot'}"), (1, LEASE),
        (1, "write {part: 'robot' values: [1e9]}"), (1, "write {part: 'robot' first_port: 99 values: [0]}"),
        (1, "write {part: 'robot' values: [nan]}"), (1, "write {part: 'robot' values: [0] sequence: 2}"),
        (1, "write {part: 'robot' values: [0] sequence: 2}"), (1, "advance {ticks: 1}"), (1, "pause {}"), (1, "reset {}"),
        (1, "set_parameter {part: 'robot' name: 'no such' value {number: 1}}"), (1, "read_blackboard {part: 'robot' name: 'Nothing'}"),
    ],
    "owners": [
        (1, HELLO % ("first", "CONTROLLER")), (2, HELLO % ("second", "CONTROLLER")), (3, HELLO % ("boss", "ADMIN")), (1, LEASE),
        (2, LEASE), (2, "acquire_lease {part: 'robot' take: true}"), (2, "write {part: 'robot' values: [0]}"),
        (1, "release_lease {part: 'robot'}"), (2, LEASE), (2, "list_parts {}"), (2, "release_lease {part: 'robot'}"),
    ],
    "time": [
        (1, HELLO % ("boss", "ADMIN")), (1, "take_snapshot {}"), (1, "join {}"), (1, "advance {ticks: 20}"),
        (1, "restore_snapshot {snapshot: 1}"), (1, "restore_snapshot {snapshot: 9}"), (1, "reset {}"), (1, "advance {ticks: 0}"),
        (1, "read_world {}"), (1, "describe_world {}"), (1, "push_body {body: 'nobody' force_n: [0, 0, 1] duration_ns: 1}"),
    ],
    "bystander": [
        (1, HELLO % ("looker", "OBSERVER")), (1, LEASE), (1, "read {part: 'robot'}"), (1, "get_parameters {part: 'robot'}"),
        (1, "read_blackboard {part: 'robot' name: 'Identity' length: 16}"), (1, "join {}"), (1, "list_faults {part: 'robot'}"),
    ],
}


def record(visumd: Path, requests: list[tuple[int, str]]) -> list[str]:
    words = [visumd, SCENES / SCENE, "--clock", "lockstep", "--port", "0", "--http", "off", "--json", "-v", "0"]
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as daemon:
        port = json.loads(daemon.stdout.readline())["port"]
        wires: dict[int, Wire] = {}
        lines = [f"scene {SCENE}"]
        for number, (client, text) in enumerate(requests, 1):
            wire = wires.get(client) or wires.setdefault(client, Wire(port))
            message = text_format.Parse(f"id: {number} {text}", pb.ClientMessage())
            lines += [f"# {text}", f"{client}> {message.SerializeToString().hex()}"]
            wire.send(message.SerializeToString())
            reply_to = None
            while reply_to != number:
                payload = wire.receive()
                reply_to = parsed(payload).reply_to
                lines.append(f"{client}< {payload.hex()}")
        for wire in wires.values():
            wire.close()
        daemon.terminate()
    return lines


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("version", help="the folder to make, which must not be there")
    parser.add_argument("--bin", type=Path, default=HERE.parents[1] / "build/dev/bin")
    options = parser.parse_args()
    folder = HERE / options.version
    folder.mkdir()
    for name, requests in SESSIONS.items():
        (folder / f"{name}.session").write_text("\n".join(record(options.bin / "visumd", requests)) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
