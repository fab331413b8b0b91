"""Frames of the serial DAQ, protocol 1 (docs/daq-stream.md): decoded from bytes, without a port."""

import json
import struct
import sys
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rotorrig.rig.errors import BadFrame
from rotorrig.rig.probes.base import DaqInfo

ASK, START, STOP = b"ID?\n", b"START\n", b"STOP\n"
PROTOCOL = 1

_SYNC = b"\xa5\x5a"
_HEADER = struct.Struct("<2sBBH")  # sync, type, flags, length of the payload
_CRC = struct.Struct("<I")  # over type, flags, length and payload
_DATA = struct.Struct("<IQHB")  # sequence, first scan, scans, channels
_SCANS = struct.Struct("<Q")
_BYTES_PER_COUNT = 3
_OVERRUN = 1  # flag of a DATA frame
_SHOWN = 24  # bytes of a bad frame quoted in its error


class Kind(IntEnum):
    """The type byte of a frame."""

    INFO = 0x01
    DATA = 0x02
    STOPPED = 0x03
    ERROR = 0x7F


@dataclass(frozen=True, slots=True)
class Info:
    """The device's answer to ID?, as it came; `decode_info` checks it."""

    payload: bytes


@dataclass(frozen=True, slots=True)
class Data:
    """Consecutive scans; `overrun`: the device lost samples just before them."""

    sequence: int
    first_scan: int
    overrun: bool
    counts: NDArray[np.int32]  # (sample, channel)


@dataclass(frozen=True, slots=True)
class Stopped:
    """The stream has ended after so many scans."""

    scans: int


@dataclass(frozen=True, slots=True)
class Complaint:
    """The device's ERROR frame: text for a person."""

    text: str


Frame = Info | Data | Stopped | Complaint


class FrameDecoder:
    """Finds frames in a byte stream that may start anywhere and be damaged; holds at most one frame's bytes."""

    def __init__(self) -> None:
        self.bad_frames = 0  # frames with a wrong CRC or contents that contradict themselves
        self.skipped_bytes = 0  # bytes that were part of no frame
        self.last_fault: BadFrame | None = None
        self._buffer = bytearray()

    @property
    def pending(self) -> int:
        """Bytes held back: the beginning of a frame whose end has not come."""
        return len(self._buffer)

    def feed(self, data: bytes) -> list[Frame]:
        """Take more bytes; return the frames completed by them."""
        self._buffer += data
        frames: list[Frame] = []
        at = self._next_sync(0)
        while result := self._frame_at(at):
            frame, size = result
            if frame is None:
                self.skipped_bytes += size
            else:
                frames.append(frame)
            at = self._next_sync(at + size)
        del self._buffer[:at]
        return frames

    def look_behind(self) -> list[Frame]:
        """Return the frames hidden behind the beginning of one that pauses, which is then dropped as damaged.

        Without any, its rest is waited for: whoever sends it may be held up for long.
        """
        at = self._buffer.find(_SYNC, 1)
        while at >= 0 and not self._is_whole(at):
            at = self._buffer.find(_SYNC, at + 1)
        if at < 0:
            return []
        self.bad_frames += 1
        self.skipped_bytes += at
        del self._buffer[:at]
        return self.feed(b"")

    def _is_whole(self, at: int) -> bool:
        """Return whether a sound frame begins and ends there."""
        try:
            size = _frame_size(self._buffer, at)
            return bool(size and decode(bytes(self._buffer[at : at + size])))
        except BadFrame:
            return False

    def _frame_at(self, at: int) -> tuple[Frame | None, int] | None:
        """Return the frame that begins there and its length, or no frame and a byte to skip; None: more is needed."""
        try:
            size = _frame_size(self._buffer, at)
            if size:
                return decode(bytes(self._buffer[at : at + size])), size
            return None if size is None else (None, 1)
        except BadFrame as error:
            self.bad_frames += 1
            self.last_fault = error
            return None, 1

    def _next_sync(self, at: int) -> int:
        sync = self._buffer.find(_SYNC, at)
        if sync < 0:  # keep a first half of the sync at the end
            sync = len(self._buffer) - self._buffer.endswith(_SYNC[:1], at)
        self.skipped_bytes += sync - at
        return sync


def decode(frame: bytes) -> Frame:
    """Decode the bytes of one whole frame. Raises BadFrame, with their hex."""
    _, kind, flags, _ = _HEADER.unpack_from(frame)
    payload = frame[_HEADER.size : -_CRC.size]
    (crc,) = _CRC.unpack_from(frame, len(frame) - _CRC.size)
    if zlib.crc32(frame[len(_SYNC) : -_CRC.size]) != crc:
        raise BadFrame(f"frame {_hex(frame)}: got CRC {crc:08x}, want it to match the contents")
    match kind:
        case Kind.INFO:
            return Info(payload)
        case Kind.DATA:
            return _data(payload, overrun=bool(flags & _OVERRUN))
        case Kind.STOPPED:
            return Stopped(_SCANS.unpack(payload)[0])
        case _:
            return Complaint(payload.decode("utf-8", "replace"))


def decode_info(payload: bytes) -> DaqInfo:
    """Return the checked contents of an INFO frame. Raises BadFrame naming the field, what was got and wanted."""
    try:
        info = json.loads(payload)
    except (ValueError, RecursionError) as error:  # no JSON, no UTF-8, nested beyond reason
        raise BadFrame(f"INFO: got {payload[:_SHOWN]!r}, want JSON") from error
    if not isinstance(info, dict):
        raise BadFrame(f"INFO: got {info!r:.60}, want a JSON object")
    _field(info, "protocol", lambda v: v == PROTOCOL, f"{PROTOCOL}, the only one this program speaks")
    channels = _field(info, "channels", lambda v: _is_count(v, 255), "1 to 255")
    return DaqInfo(
        model=_field(info, "model", lambda v: isinstance(v, str), "text"),
        serial=_field(info, "serial", lambda v: isinstance(v, str), "text"),
        sample_rate=float(_field(info, "sample_rate_hz", lambda v: _is_finite(v) and v > 0, "a positive number")),
        channels=channels,
        volts_per_count=tuple(
            map(float, _field(info, "volts_per_count", lambda v: _are_scales(v, channels), f"{channels} numbers"))
        ),
        full_scale_counts=_field(info, "full_scale_counts", lambda v: _is_count(v, 1 << 23), "1 to 8388608"),
        simulated=_flag(info, "simulated"),
    )


def _frame_size(buffer: bytearray, at: int) -> int | None:
    """Return the bytes of the frame at `at`; 0 if no frame begins like this, None if more bytes are needed.

    Judging the header at once keeps a false sync, or a damaged length, from holding up what follows for as much as
    64 KiB: half a second of 5 channels at 10 kHz. Raises BadFrame where a DATA frame's length is not its counts'.
    """
    there = len(buffer) - at
    if there < _HEADER.size:
        return None
    _, kind, flags, length = _HEADER.unpack_from(buffer, at)
    match kind:
        case Kind.DATA:
            counts_bytes = length - _DATA.size
            fits = flags in (0, _OVERRUN) and counts_bytes >= 0 and counts_bytes % _BYTES_PER_COUNT == 0
            if fits and there >= _HEADER.size + _DATA.size:
                _check_counts(bytes(buffer[at + _HEADER.size : at + _HEADER.size + _DATA.size]), counts_bytes)
        case Kind.STOPPED:
            fits = flags == 0 and length == _SCANS.size
        case _:
            fits = flags == 0 and kind in (Kind.INFO, Kind.ERROR)
    if not fits:
        return 0
    size = _HEADER.size + length + _CRC.size
    return size if there >= size else None


def _check_counts(head: bytes, counts_bytes: int) -> None:
    """Raise BadFrame unless so many bytes are the counts a DATA payload announces at its beginning."""
    _, _, scans, channels = _DATA.unpack_from(head)
    if counts_bytes != scans * channels * _BYTES_PER_COUNT:
        raise BadFrame(
            f"DATA {_hex(head)}: got {counts_bytes} bytes of counts, "
            f"want {scans * channels * _BYTES_PER_COUNT} for {scans} scans of {channels} channels"
        )


def _data(payload: bytes, *, overrun: bool) -> Data:
    sequence, first_scan, scans, channels = _DATA.unpack_from(payload)
    _check_counts(payload, len(payload) - _DATA.size)
    n = scans * channels
    # each count is read as 32 bits beginning one byte early (in the header, for the first) and shifted down: sign
    # extension of the whole frame in one pass, without a copy
    early = np.ndarray(n, "<i4", payload, offset=_DATA.size - 1, strides=(_BYTES_PER_COUNT,))
    counts = np.right_shift(early, 8, dtype=np.int32).reshape(scans, channels)
    return Data(sequence=sequence, first_scan=first_scan, overrun=overrun, counts=counts)


def _field(info: dict[str, Any], name: str, good: Callable[[Any], bool], want: str) -> Any:
    if name not in info:
        raise BadFrame(f"INFO.{name}: is missing, want {want}")
    if isinstance(info[name], bool) or not good(info[name]):
        raise BadFrame(f"INFO.{name}: got {info[name]!r:.60}, want {want}")
    return info[name]


def _flag(info: dict[str, Any], name: str) -> bool:
    """Return a field that may be missing."""
    if not isinstance(value := info.get(name, False), bool):
        raise BadFrame(f"INFO.{name}: got {value!r:.60}, want true or false")
    return value


def _is_count(value: object, most: int) -> bool:
    return isinstance(value, int) and 1 <= value <= most


def _is_finite(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) <= sys.float_info.max


def _are_scales(values: object, channels: int) -> bool:
    return isinstance(values, list) and len(values) == channels and all(_is_finite(v) and v != 0 for v in values)


def _hex(data: bytes) -> str:
    return data[:_SHOWN].hex(" ") + (f" ... ({len(data)} bytes)" if len(data) > _SHOWN else "")
