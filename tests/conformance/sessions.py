"""Recorded sessions: what clients of a released version of the protocol sent, byte by byte, and what the server answered. A
file names its scene, then has one line for each frame: `1> HEX` client 1 sends, `1< HEX` client 1 receives."""

from __future__ import annotations

import socket
import struct
from collections.abc import Iterator
from pathlib import Path

from google.protobuf.descriptor import FieldDescriptor
from google.protobuf.message import Message
from visum import visum_pb2 as pb

LENGTH = struct.Struct("<I")

# These fields may differ in a later release: figures of the run, texts for people, and results of the
# physics.
MAY_CHANGE = {
    "Welcome": {"server"},
    "Error": {"text"},
    "Event": {"text"},
    "ParameterDescription": {"help"},
    "FaultKind": {"effect"},
    "ServerStatus": {"real_time_factor", "overruns", "lateness_p50_ns", "lateness_p999_ns", "lateness_max_ns", "state_hash", "phases",
                     "own_allocations", "solver_warnings", "exchanges", "bus_exchanges", "bus_drops", "limited_ticks",
                     "limited_bodies", "working", "working_ns", "silent_stops", "late_writes"},
    "PartSample": {"sensor_outputs"},
    "WorldSample": {"poses", "velocities", "joint_positions", "joint_velocities", "joint_efforts", "following_errors",
                    "peak_following_errors", "peak_contact_forces", "contacts", "state_hash"},
    "SnapshotTaken": {"state_hash"},
}


class Wire:
    """A client that knows frames only."""

    def __init__(self, port: int):
        self.socket = socket.create_connection(("127.0.0.1", port), timeout=60)

    def send(self, payload: bytes) -> None:
        self.socket.sendall(LENGTH.pack(len(payload)) + payload)

    def receive(self) -> bytes:
        (length,) = LENGTH.unpack(self._read(LENGTH.size))
        return self._read(length)

    def at_end(self) -> bool:
        return self.socket.recv(1) == b""

    def close(self) -> None:
        self.socket.close()

    def _read(self, count: int) -> bytes:
        read = b""
        while len(read) < count:
            piece = self.socket.recv(count - len(read))
            if not piece:
                raise EOFError("the server ended the session")
            read += piece
        return read


def read_session(file: Path) -> tuple[str, list[tuple[int, str, bytes]]]:
    """Returns the scene and the frames: client, `>` or `<`, payload."""
    scene, frames = "", []
    for number, line in enumerate(file.read_text().splitlines(), 1):
        words = line.split("#")[0].split()
        if not words:
            continue
        if words[0] == "scene":
            scene = words[1]
            continue
        if len(words) != 2 or words[0][-1] not in "<>":
            raise ValueError(f"{file}:{number}: no frame")
        frames.append((int(words[0][:-1]), words[0][-1], bytes.fromhex(words[1])))
    return scene, frames


def differences(then: Message, now: Message, place: str = "") -> Iterator[str]:
    """The fields of `then` that `now` does not repeat. Further fields of `now` are for newer clients and do not count."""
    kept = MAY_CHANGE.get(then.DESCRIPTOR.name, set())
    for field, value in then.ListFields():
        if field.name in kept:
            continue
        here, what = f"{place}.{field.name}", getattr(now, field.name)
        if field.label == FieldDescriptor.LABEL_REPEATED:
            if len(what) < len(value):
                yield f"{here}: {len(value)} then, {len(what)} now"
            for i, (one, other) in enumerate(zip(value, what)):
                yield from of_values(one, other, f"{here}[{i}]")
        elif field.containing_oneof and now.WhichOneof(field.containing_oneof.name) != field.name:
            yield f"{here} then, .{now.WhichOneof(field.containing_oneof.name)} now"
        else:
            yield from of_values(value, what, here)


def of_values(then: object, now: object, place: str) -> Iterator[str]:
    if isinstance(then, Message):
        yield from differences(then, now, place)
    elif isinstance(then, float) and isinstance(now, float) and place.startswith(".world_description."):
        # Computed from a model's file: the last digits are its reader's.
        if abs(then - now) > 1e-7:
            yield f"{place}: {then!r} then, {now!r} now"
    elif then != now:
        yield f"{place}: {then!r} then, {now!r} now"


def parsed(payload: bytes) -> pb.ServerMessage:
    return pb.ServerMessage.FromString(payload)
