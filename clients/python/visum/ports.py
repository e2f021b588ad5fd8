"""Ports of a part, by name or group."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, NamedTuple

from visum.errors import Error, ErrorCode, nearest_hint

if TYPE_CHECKING:
    from visum.part import Part


class Port(NamedTuple):
    """One number of a part. A value outside of [minimum, maximum] is refused."""

    index: int
    name: str
    unit: str
    group: str
    minimum: float
    maximum: float
    initial: float


def find_ports(ports: list[Port], name: str) -> list[Port]:
    """Those of that group, or the one of that name."""
    found = [port for port in ports if port.group == name] or [port for port in ports if port.name == name]
    if not found:
        known = sorted({port.group for port in ports} | {port.name for port in ports})
        raise Error(ErrorCode.UNKNOWN_NAME, f"no port '{name}' here{nearest_hint(name, known)}")
    return found


class Outputs:
    """Sensor outputs of one part, as of its newest sample."""

    def __init__(self, part: Part, ports: list[Port]) -> None:
        self._part = part
        self.ports = ports

    def __len__(self) -> int:
        return len(self.ports)

    def __getitem__(self, i: int) -> float:
        return self._part.output_values[self.ports[i].index]

    def __iter__(self) -> Iterator[float]:
        return (self[i] for i in range(len(self)))

    def values(self) -> list[float]:
        return list(self)


class Inputs:
    """Controller inputs of one part: as set under this lease, else as in force at the newest sample.
    Part.write() sends them."""

    def __init__(self, part: Part, ports: list[Port]) -> None:
        self._part = part
        self.ports = ports

    def __len__(self) -> int:
        return len(self.ports)

    def __getitem__(self, i: int) -> float:
        return self._part.input_values[self.ports[i].index]

    def __iter__(self) -> Iterator[float]:
        return (self[i] for i in range(len(self)))

    def __setitem__(self, i: int, value: float) -> None:
        """Stages a value; one that is not finite or out of range raises and stages nothing."""
        _check(self.ports[i], value)
        self._part.stage(self.ports[i].index, float(value))

    def set(self, values: Iterable[float]) -> None:
        """Stages them all; exactly as many as there are ports. All or nothing."""
        listed = list(values)
        if len(listed) != len(self):
            raise Error(ErrorCode.MISUSE, f"{len(listed)} values for {len(self)} ports")
        for port, value in zip(self.ports, listed):
            _check(port, value)
        for i, value in enumerate(listed):
            self[i] = value


def _check(port: Port, value: float) -> None:
    if not math.isfinite(value) or not port.minimum <= value <= port.maximum:
        raise Error(ErrorCode.BAD_VALUE,
                    f"'{port.name}' must be from {port.minimum:g} to {port.maximum:g} {port.unit}, is {value}")
