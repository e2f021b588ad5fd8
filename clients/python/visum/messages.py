"""Says why the messages of the protocol cannot be imported. They need the package protobuf for the Python that runs."""

from __future__ import annotations

import sys

OLDEST_PROTOBUF = "3.20"


def why_no_messages(missing: ImportError) -> str:
    name = missing.name or ""
    if isinstance(missing, ModuleNotFoundError) and name.partition(".")[0] == "google":
        return (f"the package protobuf is missing for {sys.executable}: run '{sys.executable} -m pip install protobuf', or use "
                "Debian's /usr/bin/python3 with Debian's package python3-protobuf")
    if name.partition(".")[0] == "google":
        return f"the package protobuf is too old for {sys.executable}: Visum needs {OLDEST_PROTOBUF} or newer ({missing})"
    return f"visum_pb2 is missing: the build makes it. Set PYTHONPATH=build/<preset>/python, or install the wheel ({missing})"
