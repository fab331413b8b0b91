"""Protobuf message types, made at run time from a table of fields, and their schemas in an MCAP file.

No generated code and no protoc: a file carries its own descriptors, so Foxglove, Rerun and the official `mcap` reader
decode it without this program. Field numbers follow the table's order: add fields at its end, never in between.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from google.protobuf import descriptor_pb2, descriptor_pool, message_factory
from mcap.writer import Writer

_FIELD = descriptor_pb2.FieldDescriptorProto
_PACKAGE = "rotorrig"

ENCODING = "protobuf"  # of schemas and messages, https://mcap.dev/spec/registry

#: words of the table -> protobuf type; "repeated double" and the like are lists
TYPES = {
    "double": _FIELD.TYPE_DOUBLE,
    "int64": _FIELD.TYPE_INT64,
    "bool": _FIELD.TYPE_BOOL,
    "string": _FIELD.TYPE_STRING,
    "bytes": _FIELD.TYPE_BYTES,
}


@dataclass(frozen=True, slots=True)
class MessageType:
    """One kind of message: its full name, its class and the descriptors that go into a file."""

    name: str  # "rotorrig.Waveform"
    cls: Any  # the message class; fields are keyword arguments
    descriptors: bytes  # a serialized FileDescriptorSet


def message_type(name: str, fields: Mapping[str, str]) -> MessageType:
    """Return the message type `name` with `fields`: field name -> a key of `TYPES`, or "repeated " and a key.

    >>> speed = message_type("DocSpeed", {"t_ns": "int64", "speeds": "repeated double"})
    >>> speed.name, list(speed.cls(t_ns=5, speeds=[1.5]).speeds)
    ('rotorrig.DocSpeed', [1.5])
    """
    file = descriptor_pb2.FileDescriptorProto(name=f"{_PACKAGE}/{name}.proto", package=_PACKAGE, syntax="proto3")
    message = file.message_type.add(name=name)
    for number, (field, words) in enumerate(fields.items(), start=1):
        label = _FIELD.LABEL_REPEATED if words.startswith("repeated ") else _FIELD.LABEL_OPTIONAL
        message.field.add(name=field, number=number, type=TYPES[words.removeprefix("repeated ")], label=label)
    full_name = f"{_PACKAGE}.{name}"
    pool = descriptor_pool.DescriptorPool()  # one pool per type: two of one name do not collide
    pool.Add(file)
    return MessageType(
        full_name,
        message_factory.GetMessageClass(pool.FindMessageTypeByName(full_name)),
        descriptor_pb2.FileDescriptorSet(file=[file]).SerializeToString(),
    )


def register_schema(writer: Writer, kind: MessageType) -> int:
    """Register `kind` in an MCAP writer; return the id that `writer.register_channel(topic, ENCODING, id)` wants."""
    return writer.register_schema(kind.name, ENCODING, kind.descriptors)
