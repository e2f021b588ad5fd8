#!/usr/bin/python3
"""Writes the schemas of a recording as C++, for recording::schema(): for each message a description of itself and of the
messages that it refers to, as MCAP wants them for Protobuf (a FileDescriptorSet).

    schemas.py DESCRIPTORS SCHEMA.CC visum.v1.PartSample ...

DESCRIPTORS: what protoc --descriptor_set_out --include_imports wrote.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

from google.protobuf.descriptor_pb2 import DescriptorProto, FileDescriptorSet


def types_of_fields(message: DescriptorProto) -> Iterator[str]:
    """The full names of the types of the message's fields, and of those of its nested messages."""
    for field in message.field:
        if field.type_name:
            yield field.type_name.removeprefix(".")
    for nested in message.nested_type:
        yield from types_of_fields(nested)


def trimmed(all_files: FileDescriptorSet, root: str) -> FileDescriptorSet:
    """The files with those messages and enums alone that `root` needs."""
    messages = {f"{file.package}.{message.name}": message for file in all_files.file for message in file.message_type}
    enums = {f"{file.package}.{enum.name}" for file in all_files.file for enum in file.enum_type}
    needed, waiting = set[str](), [root]
    while waiting:
        name = waiting.pop()
        while name not in messages and name not in enums:  # nested: the outer message is kept whole
            name = name.rpartition(".")[0]
            if not name:
                raise SystemExit(f"schemas.py: there is no message {root}, or it refers to one that is not there")
        if name in needed:
            continue
        needed.add(name)
        if name in messages:
            waiting.extend(types_of_fields(messages[name]))
    result = FileDescriptorSet()
    for file in all_files.file:
        kept_messages = [message for message in file.message_type if f"{file.package}.{message.name}" in needed]
        kept_enums = [enum for enum in file.enum_type if f"{file.package}.{enum.name}" in needed]
        if not kept_messages and not kept_enums:
            continue
        kept = result.file.add(name=file.name, package=file.package, syntax=file.syntax)
        kept.dependency.extend(name for name in file.dependency if any(name == other.name for other in result.file))
        kept.message_type.extend(kept_messages)
        kept.enum_type.extend(kept_enums)
    return result


def main(descriptors: str, to: str, *names: str) -> None:
    all_files = FileDescriptorSet.FromString(Path(descriptors).read_bytes())
    arrays, cases = "", ""
    for number, name in enumerate(names):
        data = trimmed(all_files, name).SerializeToString(deterministic=True)
        arrays += f"constexpr unsigned char kSchema{number}[] = {{{','.join(str(byte) for byte in data)}}};\n"
        cases += f'  if (name == "{name}") return std::as_bytes(std::span(kSchema{number}));\n'
    Path(to).write_text(f"""#include <stdexcept>
#include <string>

#include "protocol/recording/records.h"

namespace visum::recording {{
namespace {{
{arrays}}}  // namespace

Bytes schema(std::string_view name) {{
{cases}  throw std::invalid_argument("there is no schema of " + std::string(name));
}}

}}  // namespace visum::recording
""", encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
