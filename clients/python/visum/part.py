"""A hardware part: its ports, its lease, its parameters and blackboards."""

from __future__ import annotations

import struct
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import Protocol

from visum.connection import Connection, pb, refusal_of
from visum.errors import Error, ErrorCode, unknown_name
from visum.ports import Inputs, Outputs, Port, find_ports
from visum.request_bytes import request_bytes

ParameterValue = float | int | bool | str


def parameter_value(name: str, value: ParameterValue) -> pb.ParameterValue:
    # `bool` comes first: a bool is an int, too.
    fields = {bool: "flag", int: "integer", float: "number", str: "text"}
    field = next((field for kind, field in fields.items() if isinstance(value, kind)), None)
    if field is None:
        raise Error(ErrorCode.MISUSE, f"'{name}' cannot be a {type(value).__name__}; give a bool, int, float or str")
    return pb.ParameterValue(**{field: value})


class Owner(Protocol):
    """The client that made a part. Client is one; part.py names what it needs of it here, because client.py imports part.py."""

    connection: Connection

    def post_write(self, write: pb.Write) -> None: ...
    def settle(self) -> Error | None: ...
    def close(self) -> None: ...


def _ports(descriptions: list[pb.PortDescription]) -> list[Port]:
    return [Port(i, d.name, d.unit, d.group, d.minimum, d.maximum, d.initial) for i, d in enumerate(descriptions)]


class Part:
    """A hardware part. Client.part() makes it, with a first sample. It belongs to the thread of its client."""

    def __init__(self, client: Owner, name: str) -> None:
        self._client = client
        description = client.connection.request(describe_part=pb.DescribePart(part=name)).part_description
        self.name = name
        self.kind: str = description.kind
        self.input_ports = _ports(description.controller_inputs)
        self.output_ports = _ports(description.sensor_outputs)
        self.read_request = request_bytes(read=pb.Read(part=name))  # sent in each period, so made once
        self.input_values: list[float] = []
        self._outputs: Sequence[float] = []
        self.sample_tick = 0
        self.sample_time_ns = 0
        self._era = 0
        self._brought_at = 0
        # Blackboards that were read since the last advance, and between the two before it; and what the
        # last advance has brought of them.
        self._boards_read: set[str] = set()
        self._boards_read_before: set[str] = set()
        self._boards: dict[str, bytes] = {}
        self._boards_at = 0
        self.leased = False
        self._forget_writes()
        self.read()

    # Ports -----------------------------------------------------------------------------------------------

    def inputs(self, group_or_name: str) -> Inputs:
        return Inputs(self, find_ports(self.name, "controller input", self.input_ports, group_or_name))

    def outputs(self, group_or_name: str) -> Outputs:
        return Outputs(self, find_ports(self.name, "sensor output", self.output_ports, group_or_name))

    @property
    def output_values(self) -> list[float]:
        if not isinstance(self._outputs, list):
            self._outputs = list(self._outputs)  # only now, because many cycles look at none
        return self._outputs

    def stage(self, index: int, value: float) -> None:
        """Remembers a controller input for the next write()."""
        self._set.add(index)
        self._staged.add(index)
        self.input_values[index] = value

    def write(self) -> None:
        """Sends what was set since the last write, and does not wait. A later call of this client raises a refusal: the next
        advance or read at the latest. If nothing was set, this repeats the last write, as a sign of life for a deadline."""
        self._last_write, self._staged = self._staged or self._last_write, set()
        for first, run in _runs({index: self.input_values[index] for index in self._last_write}):
            self._client.post_write(pb.Write(part=self.name, first_port=first, values=run))

    def read(self) -> None:
        """Brings the outputs up to date, in one round trip. Right after an advance in lockstep it is free: the advance has
        brought them, and the world stands since."""
        if self._client.connection.requests == self._brought_at and not self._staged:
            self._brought_at = 0  # a second read asks, since other clients may have changed something
            return
        number = self._client.connection.send(read=pb.Read(part=self.name))
        refusal = self._client.settle()
        reply = self._client.connection.take(number)
        if refusal := refusal or refusal_of(reply):
            raise refusal
        self.apply(reply.part_sample)

    def apply(self, sample: pb.PartSample) -> None:
        """Takes in a sample. What we have written under the lease stays: nobody else may write then, and the sample may be
        older than our last write. A new era begins with its own values."""
        if not self.leased or sample.era != self._era:
            self._forget_writes()
        ours = {index: self.input_values[index] for index in self._set}
        self.input_values = sample.controller_inputs[:]
        for index, value in ours.items():
            self.input_values[index] = value
        self._outputs = sample.sensor_outputs
        self.sample_tick, self.sample_time_ns, self._era = sample.tick, sample.sim_time_ns, sample.era

    def note_brought(self) -> None:
        """The newest sample, and the blackboards that came with it, are of now, as long as the client sends no further
        request."""
        self._brought_at = self._boards_at = self._client.connection.requests

    def next_blackboards(self) -> list[str]:
        """An advance begins. Returns the blackboards that it should bring along: those that were read in the last two
        periods."""
        steady = sorted(self._boards_read & self._boards_read_before)
        self._boards_read_before, self._boards_read = self._boards_read, set()
        self._boards.clear()
        return steady

    def take_blackboard(self, name: str, data: bytes) -> None:
        self._boards[name] = data

    def disown(self, indices: Iterable[int]) -> None:
        """Forgets writes that were refused: the next sample has the values in force."""
        self._set -= set(indices) - self._staged

    def _forget_writes(self) -> None:
        # Indices of the inputs that were set since acquire(), set since the last write(), and sent by it.
        self._set: set[int] = set()
        self._staged: set[int] = set()
        self._last_write: set[int] = set()

    # Lease -----------------------------------------------------------------------------------------------

    def acquire(self, deadline_s: float = 0.0, take: bool = False) -> None:
        """Takes the lease, the exclusive right to write. After `deadline_s` of simulated time without a write the server
        treats this controller as lost; 0 means no deadline. `take` takes the lease from its holder (role admin)."""
        self._client.connection.request(acquire_lease=pb.AcquireLease(
            part=self.name, deadline_ns=round(deadline_s * 1e9), take=take))
        self.leased = True
        self._set = set(self._staged)
        self.apply(self._client.connection.request(read=pb.Read(part=self.name)).part_sample)

    def release(self) -> None:
        """Gives the lease back in good order: the part keeps the last values. If the lease was lost before, this raises
        NO_LEASE, and the lease counts as released all the same."""
        refusal = self._client.settle()
        try:
            self._client.connection.request(release_lease=pb.ReleaseLease(part=self.name))
        except Error as error:
            if error.code != ErrorCode.NO_LEASE:
                raise
            refusal = refusal or error
        self.leased = False
        self._forget_writes()
        if refusal:
            raise refusal

    @contextmanager
    def lease(self, deadline_s: float = 0.0, take: bool = False) -> Iterator[Part]:
        """Holds the lease for a block. An exception that leaves the block drops the connection instead of releasing,
        so that the server knows that the controller is lost and stops the part."""
        self.acquire(deadline_s, take)
        try:
            yield self
        except BaseException:
            self._client.close()
            raise
        if self.leased:
            self.release()

    # Parameters and blackboards --------------------------------------------------------------------------

    def parameters(self) -> dict[str, ParameterValue]:
        reply = self._client.connection.request(get_parameters=pb.GetParameters(part=self.name))
        return {p.name: getattr(p.value, p.value.WhichOneof("value")) for p in reply.parameters.parameters}

    def parameter(self, name: str) -> ParameterValue:
        known = self.parameters()
        if name not in known:
            raise unknown_name("parameter", name, list(known))
        return known[name]

    def set_parameter(self, name: str, value: ParameterValue) -> None:
        self._client.connection.request(set_parameter=pb.SetParameter(
            part=self.name, name=name, value=parameter_value(name, value)))

    def read_blackboard(self, name: str) -> bytes:
        """In one round trip. In lockstep, a blackboard that is read in each period comes with the advance, as the outputs do:
        right after it the first read is free."""
        self._boards_read.add(name)
        brought = self._boards.pop(name, None)
        if brought is not None and self._client.connection.requests == self._boards_at:
            return brought
        return self._client.connection.request(
            read_blackboard=pb.ReadBlackboard(part=self.name, name=name)).blackboard.data

    def write_blackboard(self, name: str, data: bytes, offset: int = 0) -> None:
        """At offset 0 the data become the whole content."""
        self._client.connection.request(write_blackboard=pb.WriteBlackboard(
            part=self.name, name=name, offset=offset, data=data))

    @contextmanager
    def locked_blackboard(self, name: str, timeout_s: float) -> Iterator[None]:
        """All writes within the `with` take effect at its end, at once, or not at all if an exception ends it. After
        `timeout_s` of simulated time (at most 60) the lock is over, and what was written is dropped."""
        request = self._client.connection.request
        request(lock_blackboard=pb.LockBlackboard(part=self.name, name=name, timeout_ns=round(timeout_s * 1e9)))
        try:
            yield
        except BaseException:
            request(unlock_blackboard=pb.UnlockBlackboard(part=self.name, name=name, discard=True))
            raise
        request(unlock_blackboard=pb.UnlockBlackboard(part=self.name, name=name))

    def follow_trajectory(self, points: Iterable[tuple[float, Iterable[float]]]) -> None:
        """Sends the part along way-points from now on: each a time in s, counted from now, and a value for each desired
        position. An empty list ends the motion. Any other command to a drive ends it, too."""
        rows = [[time, *positions] for time, positions in points]
        self.write_blackboard("Trajectory", b"".join(struct.pack(f"<{len(row)}d", *row) for row in rows))

    def inject_fault(self, kind: str, seconds: float = 0.0, **numbers: float) -> None:
        """Injects a fault that `visum faults` lists, as in inject_fault("encoder_stuck", joint=3). It ends after `seconds` of
        simulated time; 0 means that it lasts until clear_fault(). Needs the role admin."""
        self._client.connection.request(inject_fault=pb.InjectFault(
            part=self.name, kind=kind, duration_ns=round(seconds * 1e9),
            numbers=[pb.FaultNumber(name=name, value=value) for name, value in numbers.items()]))

    def clear_fault(self, kind: str = "", joint: int = 0) -> None:
        """Ends all faults of this part, or those of one kind, or the one of a joint (0: of every joint)."""
        self._client.connection.request(clear_fault=pb.ClearFault(part=self.name, kind=kind, joint=joint))

    def faults(self) -> list[str]:
        """The kinds of the faults that are active."""
        return [f.kind for f in self._client.connection.request(list_faults=pb.ListFaults(part=self.name)).faults.active]


def _runs(values: dict[int, float]) -> Iterator[tuple[int, list[float]]]:
    """Groups values of neighbouring ports: one Write message carries one run."""
    run: list[float] = []
    first = 0
    for index in sorted(values):
        if run and index != first + len(run):
            yield first, run
            run = []
        if not run:
            first = index
        run.append(values[index])
    if run:
        yield first, run
