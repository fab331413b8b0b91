"""What an input is given to: every reader of the program, through the function its command calls."""

import re
import struct
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from rotorrig.acquisition.files.recording_mcap import open_recording, read_recording, salvage
from rotorrig.acquisition.importers.channel_mapping import load_channels
from rotorrig.app.commands.other_programs.export_files import write_out
from rotorrig.app.commands.other_programs.import_files import bring_in
from rotorrig.processing.files.bode_table import read_table
from rotorrig.rig.config.description import load
from rotorrig.rig.errors import BadFrame, RigError
from rotorrig.rig.motor import line_frames
from rotorrig.rig.probes.stream.frames import FrameDecoder, Info, decode_info
from tests.fuzz.corpus import BODE_CSV, BODE_MAPPING, CHANNELS, RK4

Read = Callable[[bytes, Path], None]
T = TypeVar("T")
R = TypeVar("R")


def _run(data: bytes, folder: Path) -> None:
    """Read a recording, whole and piece by piece, and export it, and salvage it whatever came of that."""
    path = _placed(data, folder / "in.mcap")
    try:
        with open_recording(path) as recording:
            for _, counts in recording.segments():
                counts[:]
        for suffix in (".csv", ".uff"):
            write_out(path, folder / f"out{suffix}")
    finally:
        try:
            salvage(path, folder / "out.mcap")
        except RigError:
            _must_be_absent(folder / "out.mcap")
        else:
            read_recording(folder / "out.mcap")


def _response(data: bytes, folder: Path) -> None:
    path = _placed(data, folder / "in.mcap")
    for suffix in (".csv", ".uff"):
        write_out(path, folder / f"out{suffix}")


def _imported(suffix: str) -> Read:
    def read(data: bytes, folder: Path) -> None:
        mapping = _placed(CHANNELS, folder / "mapping.toml") if suffix == "wav" else None
        _import(_placed(data, folder / f"in.{suffix}"), mapping, folder / "out.mcap")

    return read


def _import(file: Path, mapping: Path | None, out: Path) -> None:
    """Import as the command does: afterwards the result is there and can be read, or there is none."""
    try:
        bring_in(file, rig=RK4, mapping=mapping, out=out)
    except RigError:
        _must_be_absent(out)
        raise
    read_recording(out)


def _channels(data: bytes, folder: Path) -> None:
    load_channels(_placed(data, folder / "mapping.toml"), RK4)


def _bode(data: bytes, folder: Path) -> None:
    read_table(_placed(data, folder / "in.csv"), _placed(BODE_MAPPING, folder / "mapping.toml"), RK4)


def _bode_mapping(data: bytes, folder: Path) -> None:
    read_table(_placed(BODE_CSV, folder / "in.csv"), _placed(data, folder / "mapping.toml"), RK4)


def _config(data: bytes, folder: Path) -> None:
    load(_placed(data, folder / "rig.toml"))


def _daq(data: bytes, folder: Path) -> None:
    """Feed the bytes as they are and with their CRCs put right, in pieces as a port gives them."""
    for stream in (data, _mended_frames(data)):
        decoder = FrameDecoder()
        for at in range(0, len(stream), 100):
            for frame in decoder.feed(stream[at : at + 100]):
                if isinstance(frame, Info):
                    _ignoring_bad(decode_info, frame.payload)
        decoder.look_behind()


def _daq_info(data: bytes, folder: Path) -> None:
    decode_info(data)


def _line(data: bytes, folder: Path) -> None:
    for line in (data, _mended_line(data)):
        reply = _ignoring_bad(line_frames.decode_reply, line)
        if reply is not None:
            _ignoring_bad(line_frames.decode_state, reply.text)
            _ignoring_bad(line_frames.decode_identity, reply.text)


def _ignoring_bad(decode: Callable[[T], R], data: T) -> R | None:
    try:
        return decode(data)
    except BadFrame:
        return None


def _mended_frames(data: bytes) -> bytes:
    """Return the stream with the CRC of every frame as its contents want it."""
    out, at = bytearray(data), data.find(b"\xa5\x5a")
    while 0 <= at <= len(out) - 10:
        end = at + 6 + struct.unpack_from("<H", out, at + 4)[0]
        if end + 4 <= len(out):
            struct.pack_into("<I", out, end, zlib.crc32(out[at + 2 : end]))
        at = data.find(b"\xa5\x5a", at + 2)
    return bytes(out)


def _mended_line(data: bytes) -> bytes:
    found = re.match(rb"[^*]*", data)
    body = found[0] if found else b""
    return body + b"*%04X\n" % line_frames.crc16(body)


def _placed(data: bytes, path: Path) -> Path:
    path.write_bytes(data)
    return path


def _must_be_absent(path: Path) -> None:
    if path.exists():
        raise AssertionError(f"{path.name} was written although the input was refused")


#: kind of input, as in the corpus -> its reader
TARGETS: dict[str, Read] = {
    "run": _run,
    "response": _response,
    "csv": _imported("csv"),
    "uff": _imported("uff"),
    "tdms": _imported("tdms"),
    "wav": _imported("wav"),
    "channels": _channels,
    "bode": _bode,
    "bode mapping": _bode_mapping,
    "config": _config,
    "daq": _daq,
    "daq info": _daq_info,
    "line": _line,
}
#: how often each is drawn: those with most to go wrong most often
WEIGHTS = {name: 3 if name in ("run", "uff", "tdms", "wav", "csv", "config") else 2 for name in TARGETS}
