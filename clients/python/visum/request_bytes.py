"""Requests as they stand in a frame.

Debian's protobuf walks through all sixty kinds of requests to encode a ClientMessage, which takes longer than to encode the one
that is there. So only that one is encoded by protobuf, and its surroundings are put together here: fields of one message may be
encoded one by one (https://protobuf.dev/programming-guides/encoding/).
"""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING

from visum import visum_pb2 as pb

if TYPE_CHECKING:
    from google.protobuf.message import Message

LENGTH = struct.Struct("<I")  # of a frame
_HAS_LENGTH = 2  # wire type of fields that are messages


def _varint(number: int) -> bytes:
    encoded = bytearray()
    while number > 0x7F:
        encoded.append(number & 0x7F | 0x80)
        number >>= 7
    encoded.append(number)
    return bytes(encoded)


_FIELDS = pb.ClientMessage.DESCRIPTOR.fields_by_name
_KINDS = {name: (field.message_type, _varint(field.number << 3 | _HAS_LENGTH)) for name, field in _FIELDS.items()
          if field.message_type}
_ID_KEY = _varint(_FIELDS["id"].number << 3)


def request_bytes(**request: Message) -> bytes:
    """Encodes one request, named as in ClientMessage, but for its number. The bytes may be sent any number of times."""
    if len(request) != 1 or not request.keys() <= _KINDS.keys():
        raise TypeError(f"give one request of ClientMessage, not {', '.join(request) or 'none'}")
    ((name, message),) = request.items()
    kind, key = _KINDS[name]
    if getattr(message, "DESCRIPTOR", None) is not kind:
        raise TypeError(f"'{name}' must be a {kind.name}, not a {type(message).__name__}")
    encoded = message.SerializeToString()
    return key + _varint(len(encoded)) + encoded


def frame(number: int, request: bytes) -> bytes:
    """The frame of a request with its number, as the server expects it."""
    head = _ID_KEY + _varint(number)
    return LENGTH.pack(len(head) + len(request)) + head + request
