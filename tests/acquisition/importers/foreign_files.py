"""Foreign files made by hand, byte by byte as their specifications say, around waveforms that are known."""

import struct
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

RATE = 25_600.0
NAMES = ("keyphasor", "1x", "1y", "2x", "2y")

Waves = Mapping[str, NDArray[np.float64]]


def waves(samples: int = 200) -> dict[str, NDArray[np.float64]]:
    """Return volts (sample,) of the RK4's channels, each of its own size and about its own mean."""
    t = np.arange(samples) / RATE
    volts = {name: -9.0 - k + 0.1 * (k + 1) * np.sin(2 * np.pi * 300 * t + k) for k, name in enumerate(NAMES)}
    volts["keyphasor"] = np.where(np.arange(samples) % 50 < 5, -10.0, -2.0)
    return volts


def uff58(
    name: str,
    values: NDArray[np.float64],
    *,
    unit: str = "V",
    function: int = 1,
    form: str = "4E20.12",
    step: float = 1 / RATE,
    start: float = 0.0,
    ordinate: int = 1,
    points: int | None = None,
    x: NDArray[np.float64] | None = None,
    time_unit: str = "s",
) -> bytes:
    """Return a data set 58 or 58b ("<d", ">f" ...), columns as in https://www.ceas3.uc.edu/sdrluff, data set 58."""
    binary = form[0] in "<>"
    single = form in ("6E13.5", "<f", ">f")
    lines = [
        "    -1",
        f"    58{'b' if binary else ' '}",
        f"{'Waveform':80s}",
        f"{'NONE':80s}",
        f"{'21-Nov-26 12:00:00':80s}",
        f"{'NONE':80s}",
        f"{'NONE':80s}",
        f"{function:5d}{1:10d}{1:5d}{0:10d} {name:10s}{7:10d}{2:4d} {'NONE':10s}{0:10d}{0:4d}",
        f"{2 if single else 4:10d}{len(values) if points is None else points:10d}{int(x is None):10d}"
        f"{start if x is None else 0:13.5E}{step if x is None else 0:13.5E}{0:13.5E}",
        f"{17:10d}{0:5d}{0:5d}{0:5d} {'Time':20s} {time_unit:20s}",
        f"{ordinate:10d}{0:5d}{0:5d}{0:5d} {'Signal':20s} {unit:20s}",
        *[f"{0:10d}{0:5d}{0:5d}{0:5d} {'NONE':20s} {'NONE':20s}"] * 2,
    ]
    if binary:
        data = values.astype(form[0] + {"f": "f4", "d": "f8"}[form[1]]).tobytes()
        order = 1 if form[0] == "<" else 2
        lines[1] += f"{order:6d}{2:6d}{11:12d}{len(data):12d}{0:6d}{0:6d}{0:12d}{0:12d}"
        return ("\n".join(lines) + "\n").encode() + data + b"    -1\n"
    numbers = values if x is None else np.column_stack([x, values]).ravel()
    forms = {"6E13.5": ["%13.5E"] * 6, "4E20.12": ["%20.12E"] * 4, "2(E13.5,E20.12)": ["%13.5E", "%20.12E"] * 2}[form]
    rows = [numbers[at : at + len(forms)] for at in range(0, len(numbers), len(forms))]
    lines += ["".join(f % v for f, v in zip(forms, row, strict=False)) for row in rows]
    return ("\n".join([*lines, "    -1"]) + "\n").encode()


def uff164(length_factor: float) -> bytes:
    """Return a data set 164: file units / factor = SI. FORMAT(I10,20A1,I10), then FORMAT(3D25.17)."""
    numbers = "".join(f"{v:25.17E}".replace("E", "D") for v in (length_factor, 1.0, 1.0))
    lines = ["    -1", "   164", f"{5:10d}{'mm (milli newton)':20s}{2:10d}", numbers, f"{273.15:25.17E}", "    -1"]
    return ("\n".join(lines) + "\n").encode()


def riff(*chunks: tuple[bytes, bytes], form: bytes = b"RIFF") -> bytes:
    """Return a RIFF file of form WAVE: each chunk its name, its size and its bytes, padded to an even number."""
    body = b"".join(name + struct.pack("<I", len(data)) + data + b"\0" * (len(data) % 2) for name, data in chunks)
    return form + struct.pack("<I", len(body) + 4) + b"WAVE" + body


def fmt(coding: int, *, channels: int, rate: int, bits: int) -> bytes:
    """Return a `fmt ` chunk: format, channels, rate, bytes per second, bytes per scan, bits per sample."""
    scan = channels * bits // 8
    return struct.pack("<HHIIHH", coding, channels, rate, rate * scan, scan, bits)


def pcm(scans: NDArray[np.int64], *, bits: int) -> bytes:
    """Return (scan, channel) as little-endian integers; those of 8 bits have no sign."""
    if bits == 8:
        return (scans + 128).astype(np.uint8).tobytes()
    return b"".join(int(v).to_bytes(bits // 8, "little", signed=True) for v in scans.ravel())


def tdms_text(text: str) -> bytes:
    """Return a string as TDMS has it: its length in bytes, then UTF-8."""
    data = text.encode()
    return struct.pack("<I", len(data)) + data


def tdms_property(name: str, value: float | str) -> bytes:
    """Return a property: name, type (7 u32 for an int, 10 double, 0x20 string), value."""
    if isinstance(value, int):
        return tdms_text(name) + struct.pack("<II", 7, value)
    if isinstance(value, str):
        return tdms_text(name) + struct.pack("<I", 0x20) + tdms_text(value)
    return tdms_text(name) + struct.pack("<Id", 10, value)


def tdms_segment(channels: Sequence[tuple[str, NDArray[np.float64], Mapping[str, float | str]]]) -> bytes:
    """Return one segment of contiguous doubles in group "g".

    NI, TDMS File Format Internal Structure: lead-in of 28 bytes (tag, contents 2 meta + 4 new list + 8 raw, version
    4713, bytes to the next segment, bytes of metadata); per object path, raw data index (20, type, 1, values) or
    FFFFFFFF, properties.
    """
    meta = struct.pack("<I", len(channels))
    for path, values, properties in channels:
        index = struct.pack("<IIIQ", 20, 10, 1, len(values)) if len(values) else b"\xff" * 4
        written = b"".join(tdms_property(name, value) for name, value in properties.items())
        meta += tdms_text(path) + index + struct.pack("<I", len(properties)) + written
    raw = b"".join(values.astype("<f8").tobytes() for _, values, _ in channels)
    return b"TDSm" + struct.pack("<IIQQ", 2 | 4 | 8, 4713, len(meta) + len(raw), len(meta)) + meta + raw


def tdms_daqmx(counts: Mapping[str, NDArray[np.int16]], properties: Mapping[str, float | str]) -> bytes:
    """Return one segment as DAQmx logs it: int16 counts, scan by scan, with a format-changing scaler per channel.

    Contents 2 meta + 4 new list + 8 raw + 128 DAQmx. Raw data index: 0x1269, type FFFFFFFF, dimension 1, values; one
    scaler (type 3 = I16, buffer, byte in the scan, format, scale number); one buffer and its bytes per scan.
    """
    meta = struct.pack("<I", len(counts))
    for place, (name, values) in enumerate(counts.items()):
        index = struct.pack("<IIIQ", 0x1269, 0xFFFFFFFF, 1, len(values))
        index += struct.pack("<IIIIII", 1, 3, 0, 2 * place, 0, 0) + struct.pack("<II", 1, 2 * len(counts))
        written = b"".join(tdms_property(name, value) for name, value in properties.items())
        meta += tdms_text(f"/'Log'/'{name}'") + index + struct.pack("<I", len(properties)) + written
    raw = np.column_stack(list(counts.values())).astype("<i2").tobytes()
    return b"TDSm" + struct.pack("<IIQQ", 2 | 4 | 8 | 128, 4713, len(meta) + len(raw), len(meta)) + meta + raw
