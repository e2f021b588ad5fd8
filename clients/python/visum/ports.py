"""Ports of a part, by name or group."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from typing import NamedTuple, Protocol

from visum.errors import Error, ErrorCode, nearest_hint


class Port(NamedTuple):
    """One number of a part. The server refuses a value outside of [minimum, maximum]."""

    index: int
    name: str
    unit: str
    group: str
    minimum: float
    maximum: float
    initial: float


class Values(Protocol):
    """The values behind Inputs and Outputs. A Part has them; ports.py names them here because it must not import part.py."""

    input_values: list[float]

    @property
    def output_values(self) -> list[float]: ...
    def stage(self, index: int, value: float) -> None: ...


def find_ports(part: str, vector: str, ports: list[Port], name: str) -> list[Port]:
    """The ports of the group `name`, or the one port of that name. `part` and `vector` are for the error's text."""
    found = [port for port in ports if port.group == name] or [port for port in ports if port.name == name]
    if not found:
        known = sorted({port.group for port in ports} | {port.name for port in ports})
        raise Error(ErrorCode.UNKNOWN_NAME, f"part '{part}' has no {vector} '{name}'{nearest_hint(name, known)}")
    return found


class Outputs:
    """Sensor outputs of one part, as of its newest sample."""

    def __init__(self, part: Values, ports: list[Port]) -> None:
        self._part = part
        self.ports = ports

    def __len__(self) -> int:
        return len(self.ports)

    def __getitem__(self, i: int) -> float:
        return self._part.output_values[self.ports[i].index]

    def __iter__(self) -> Iterator[float]:
        values = self._part.output_values
        return (values[port.index] for port in self.ports)

    def values(self) -> list[float]:
        return list(self)


class Inputs:
    """Controller inputs of one part. A value is the one set under this lease, else the one in force at the newest sample.
    Part.write() sends them."""

    def __init__(self, part: Values, ports: list[Port]) -> None:
        self._part = part
        self.ports = ports

    def __len__(self) -> int:
        return len(self.ports)

    def __getitem__(self, i: int) -> float:
        return self._part.input_values[self.ports[i].index]

    def __iter__(self) -> Iterator[float]:
        return (self[i] for i in range(len(self)))

    def __setitem__(self, i: int, value: float) -> None:
        """Stages a value. A value that is not finite, or out of range, raises and stages nothing."""
        _check(self.ports[i], value)
        self._part.stage(self.ports[i].index, float(value))

    def set(self, values: Iterable[float]) -> None:
        """Stages one value for each port. If one of them is wrong this raises, and stages nothing."""
        listed = list(values)
        if len(listed) != len(self):
            raise Error(ErrorCode.MISUSE, f"{len(listed)} values were given for {len(self)} ports")
        for port, value in zip(self.ports, listed):
            _check(port, value)
        for i, value in enumerate(listed):
            self[i] = value


def _check(port: Port, value: float) -> None:
    if not math.isfinite(value) or not port.minimum <= value <= port.maximum:
        raise Error(ErrorCode.BAD_VALUE,
                    f"'{port.name}' must be from {port.minimum:g} to {port.maximum:g} {port.unit}; {value} was given")
