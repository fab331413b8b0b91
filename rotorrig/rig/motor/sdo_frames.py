"""The SDO protocol of CANopen, as a client sees it (CiA 301 V4.2, section 7.2.4.3): pure, 8 bytes a frame.

Reads of up to 4 bytes and all writes are one request and one answer; longer values, such as a device's name, come in
segments of 7 bytes.
"""

import struct
from dataclasses import dataclass

from rotorrig.rig.errors import BadFrame

_HEADER = struct.Struct("<BHB")  # command specifier, index, subindex
_SIZE = 8
_UPLOAD, _SEGMENT = 0x40, 0x60  # requests
_TOGGLE = 0x10
_ABORT = 0x80

ABORTS = {  # CiA 301, table 22; those a drive answers with
    0x0503_0000: "toggle bit not alternated",
    0x0504_0001: "command specifier not known",
    0x0601_0000: "unsupported access",
    0x0601_0001: "is write-only",
    0x0601_0002: "is read-only",
    0x0602_0000: "does not exist",
    0x0604_0043: "parameter incompatible",
    0x0606_0000: "hardware error",
    0x0607_0010: "wrong length",
    0x0609_0011: "subindex does not exist",
    0x0609_0030: "value out of range",
    0x0609_0031: "value too high",
    0x0609_0032: "value too low",
    0x0800_0000: "general error",
    0x0800_0020: "cannot be stored",
    0x0800_0021: "under local control",
    0x0800_0022: "not in this state of the device",
}


@dataclass(frozen=True, slots=True)
class Item:
    """An object of the device's dictionary; integers only."""

    index: int
    subindex: int
    size: int  # bytes
    name: str
    signed: bool = False

    def __str__(self) -> str:
        return f"{self.name} ({self.index:04X}h:{self.subindex:02X})"


@dataclass(frozen=True, slots=True)
class Value:
    """The answer to a read; `data` is None if it is longer than 4 bytes and comes in segments."""

    place: tuple[int, int]  # index and subindex
    data: bytes | None


@dataclass(frozen=True, slots=True)
class Segment:
    """A segment of a long value; `toggle` alternates, False first."""

    toggle: bool
    data: bytes
    last: bool


@dataclass(frozen=True, slots=True)
class Written:
    """The answer to a write."""

    place: tuple[int, int]


@dataclass(frozen=True, slots=True)
class Aborted:
    """The device refuses, `code` says why."""

    place: tuple[int, int]
    code: int

    def __str__(self) -> str:
        return f"{ABORTS.get(self.code, 'not said why')} (abort code {self.code:08X}h)"


Answer = Value | Segment | Written | Aborted


def encode_read(item: Item) -> bytes:
    """Return the request for an object's value.

    >>> encode_read(Item(0x6041, 0, 2, "statusword")).hex(" ")
    '40 41 60 00 00 00 00 00'
    """
    return _HEADER.pack(_UPLOAD, item.index, item.subindex) + bytes(4)


def encode_write(item: Item, value: int) -> bytes:
    """Return the request to set an object. Raises OverflowError if it does not hold `value`.

    >>> encode_write(Item(0x6040, 0, 2, "controlword"), 0x000F).hex(" ")
    '2b 40 60 00 0f 00 00 00'
    """
    data = value.to_bytes(item.size, "little", signed=item.signed)
    specifier = 0x23 | (4 - item.size) << 2  # initiate download, expedited, size indicated
    return _HEADER.pack(specifier, item.index, item.subindex) + data.ljust(4, b"\0")


def encode_next_segment(*, toggle: bool) -> bytes:
    """Return the request for the next segment of a long value."""
    return bytes([_SEGMENT | toggle * _TOGGLE]).ljust(_SIZE, b"\0")


def decode_answer(frame: bytes) -> Answer:
    """Return what a device's frame says. Raises BadFrame."""
    if len(frame) != _SIZE:
        raise BadFrame(f"SDO: got {frame.hex(' ') or 'nothing'}, want {_SIZE} bytes")
    specifier, index, subindex = _HEADER.unpack_from(frame)
    match specifier >> 5:
        case 0:
            unused = specifier >> 1 & 7
            return Segment(bool(specifier & _TOGGLE), frame[1 : _SIZE - unused], bool(specifier & 1))
        case 2 if specifier & 2:  # expedited
            unused = specifier >> 2 & 3 if specifier & 1 else 0
            return Value((index, subindex), frame[4 : _SIZE - unused])
        case 2:
            return Value((index, subindex), None)
        case 3:
            return Written((index, subindex))
        case 4:
            return Aborted((index, subindex), int.from_bytes(frame[4:], "little"))
    raise BadFrame(f"SDO: got {frame.hex(' ')}, no answer begins with {specifier:02x}")


def concerns(answer: Answer, item: Item) -> bool:
    """Return whether an answer is about an object; a segment does not say what it is about."""
    return isinstance(answer, Segment) or answer.place == (item.index, item.subindex)


def integer(item: Item, data: bytes) -> int:
    """Return an object's value from its bytes; a device may send more than it has. Raises BadFrame if less."""
    if len(data) < item.size:
        raise BadFrame(f"{item}: got {len(data)} bytes, want {item.size}")
    return int.from_bytes(data[: item.size], "little", signed=item.signed)
