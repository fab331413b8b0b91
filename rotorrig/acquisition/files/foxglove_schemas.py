"""Foxglove's message types PointCloud and Log, which Foxglove and Rerun draw by themselves.

Field numbers, full names and enumerations as published: https://docs.foxglove.dev/docs/visualization/message-schemas
(PointCloud, PackedElementField, Log), Protobuf. The optional pose of a cloud is left out: its frame is the rig's.
"""

import numpy as np
from google.protobuf import descriptor_pb2, descriptor_pool, message_factory, timestamp_pb2
from numpy.typing import NDArray

from rotorrig.acquisition.files.schemas import MessageType

_FIELD = descriptor_pb2.FieldDescriptorProto
_PACKAGE = "foxglove"
_TIMESTAMP = ".google.protobuf.Timestamp"
_FLOAT32, _UINT8 = 7, 1  # of PackedElementField.NumericType
_POINT = np.dtype([(name, "<f4") for name in "xyz"] + [(name, "u1") for name in ("red", "green", "blue", "alpha")])
_NUMERIC = ("UNKNOWN", "UINT8", "INT8", "UINT16", "INT16", "UINT32", "INT32", "FLOAT32", "FLOAT64")
_LEVELS = ("UNKNOWN", "DEBUG", "INFO", "WARNING", "ERROR", "FATAL")
INFO, WARNING = 2, 3  # of Log.Level


def cloud_values(t_ns: int, xyz: NDArray[np.float64], colours: NDArray[np.uint8], *, frame: str) -> dict[str, object]:
    """Return the fields of a POINT_CLOUD with points (point, 3) [m] and their colours (point, 3)."""
    points = np.empty(len(xyz), dtype=_POINT)
    for axis, values in zip("xyz", xyz.T, strict=True):
        points[axis] = values
    for name, values in zip(("red", "green", "blue"), colours.T, strict=True):
        points[name] = values
    points["alpha"] = 255
    return {
        "timestamp": _stamp(t_ns),
        "frame_id": frame,
        "point_stride": _POINT.itemsize,
        "fields": [_element(name) for name in _POINT.names or ()],
        "data": points.tobytes(),
    }


def log_values(t_ns: int, words: str, *, level: int = INFO) -> dict[str, object]:
    """Return the fields of a LOG line."""
    return {"timestamp": _stamp(t_ns), "level": level, "message": words, "name": "rotorrig"}


def _stamp(t_ns: int) -> dict[str, int]:
    return {"seconds": t_ns // 10**9, "nanos": t_ns % 10**9}


def _element(name: str) -> dict[str, object]:
    assert _POINT.fields is not None
    kind, offset = _POINT.fields[name][:2]
    return {"name": name, "offset": offset, "type": _FLOAT32 if kind.kind == "f" else _UINT8}


def _file(name: str) -> descriptor_pb2.FileDescriptorProto:
    stamps = timestamp_pb2.DESCRIPTOR.name
    return descriptor_pb2.FileDescriptorProto(
        name=f"{_PACKAGE}/{name}.proto", package=_PACKAGE, syntax="proto3", dependency=[stamps]
    )


def _add(
    message: descriptor_pb2.DescriptorProto, name: str, number: int, kind: int, of: str = "", *, many: bool = False
) -> None:
    label = _FIELD.LABEL_REPEATED if many else _FIELD.LABEL_OPTIONAL
    message.field.add(name=name, number=number, type=kind, type_name=of or None, label=label)


def _enumeration(message: descriptor_pb2.DescriptorProto, name: str, values: tuple[str, ...]) -> None:
    enumeration = message.enum_type.add(name=name)
    for number, value in enumerate(values):
        enumeration.value.add(name=value, number=number)


def _type(file: descriptor_pb2.FileDescriptorProto, name: str) -> MessageType:
    stamps = descriptor_pb2.FileDescriptorProto()
    timestamp_pb2.DESCRIPTOR.CopyToProto(stamps)
    pool = descriptor_pool.DescriptorPool()
    pool.Add(stamps)
    pool.Add(file)
    full_name = f"{_PACKAGE}.{name}"
    return MessageType(
        full_name,
        message_factory.GetMessageClass(pool.FindMessageTypeByName(full_name)),
        descriptor_pb2.FileDescriptorSet(file=[stamps, file]).SerializeToString(),
    )


def _point_cloud() -> MessageType:
    file = _file("PointCloud")
    element = file.message_type.add(name="PackedElementField")
    _enumeration(element, "NumericType", _NUMERIC)
    _add(element, "name", 1, _FIELD.TYPE_STRING)
    _add(element, "offset", 2, _FIELD.TYPE_FIXED32)
    _add(element, "type", 3, _FIELD.TYPE_ENUM, ".foxglove.PackedElementField.NumericType")
    cloud = file.message_type.add(name="PointCloud")
    _add(cloud, "timestamp", 1, _FIELD.TYPE_MESSAGE, _TIMESTAMP)
    _add(cloud, "frame_id", 2, _FIELD.TYPE_STRING)
    _add(cloud, "point_stride", 4, _FIELD.TYPE_FIXED32)
    _add(cloud, "fields", 5, _FIELD.TYPE_MESSAGE, ".foxglove.PackedElementField", many=True)
    _add(cloud, "data", 6, _FIELD.TYPE_BYTES)
    return _type(file, "PointCloud")


def _log() -> MessageType:
    file = _file("Log")
    line = file.message_type.add(name="Log")
    _enumeration(line, "Level", _LEVELS)
    _add(line, "timestamp", 1, _FIELD.TYPE_MESSAGE, _TIMESTAMP)
    _add(line, "level", 2, _FIELD.TYPE_ENUM, ".foxglove.Log.Level")
    _add(line, "message", 3, _FIELD.TYPE_STRING)
    _add(line, "name", 4, _FIELD.TYPE_STRING)
    _add(line, "file", 5, _FIELD.TYPE_STRING)
    _add(line, "line", 6, _FIELD.TYPE_FIXED32)
    return _type(file, "Log")


POINT_CLOUD = _point_cloud()
LOG = _log()
