import pytest
from google.protobuf import descriptor_pb2, descriptor_pool, message_factory

from rotorrig.acquisition.files.schemas import message_type

POINT = message_type(
    "TestPoint",
    {"t_ns": "int64", "speed": "double", "on": "bool", "name": "string", "raw": "bytes", "z": "repeated double"},
)


def test_descriptors_alone_suffice_to_decode_a_message() -> None:
    data = POINT.cls(t_ns=-3, speed=1.25, on=True, name="1x", raw=b"\0\1", z=[0.5, -0.5]).SerializeToString()
    pool = descriptor_pool.DescriptorPool()
    for file in descriptor_pb2.FileDescriptorSet.FromString(POINT.descriptors).file:
        pool.Add(file)
    read = message_factory.GetMessageClass(pool.FindMessageTypeByName("rotorrig.TestPoint")).FromString(data)
    assert (read.t_ns, read.speed, read.on, read.name, read.raw) == (-3, 1.25, True, "1x", b"\0\1")
    assert list(read.z) == [0.5, -0.5]


def test_bytes_on_the_wire_are_protobufs_own() -> None:
    # field 1 as varint 150: 08 96 01, from the protobuf encoding guide
    assert message_type("Wire", {"a": "int64"}).cls(a=150).SerializeToString() == bytes.fromhex("089601")


def test_a_field_added_at_the_end_leaves_old_files_readable() -> None:
    newer = message_type("TestPoint", {"t_ns": "int64", "speed": "double", "on": "bool"})
    older = message_type("TestPoint", {"t_ns": "int64", "speed": "double"})
    assert newer.cls.FromString(older.cls(t_ns=1, speed=2.0).SerializeToString()).speed == 2.0
    assert older.cls.FromString(newer.cls(t_ns=1, speed=2.0, on=True).SerializeToString()).t_ns == 1


def test_an_unknown_type_word_is_refused() -> None:
    with pytest.raises(KeyError):
        message_type("Odd", {"a": "float128"})
