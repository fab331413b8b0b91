"""Recording files: write one while it is made, read it, salvage one that was cut. Topics and fields: docs/files.md.

Waveforms are raw counts with the channels' calibration beside them. While recording, a chunk is handed to the system
every tenth of a second, so that a crash costs less than a quarter of one, blocks on their way included; what was
written stays in `<name>.part` until the file is whole.

The MCAP container itself (`FileWriter`, `read_file`) serves other stages' files as well.
"""

import math
from collections.abc import Callable, Iterable
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from rotorrig.acquisition.files import block_message
from rotorrig.acquisition.files.container import Contents, FileKind, Stored, read_file
from rotorrig.acquisition.files.file_writer import DiskFull, FileWriter
from rotorrig.acquisition.files.mcap_records import Place
from rotorrig.acquisition.files.part_file import part_path, refuse_existing
from rotorrig.acquisition.files.preview import Preview
from rotorrig.acquisition.files.schemas import message_type
from rotorrig.acquisition.files.stored_recording import BlockIndex, StoredRecording
from rotorrig.acquisition.recording import Event, MotorSample, RawRecording
from rotorrig.rig import DataError, Provenance, file_hash
from rotorrig.rig.config import RigConfig
from rotorrig.rig.probes import Block, DaqInfo

__all__ = [
    "Contents",
    "DiskFull",
    "FileKind",
    "FileWriter",
    "RecordingWriter",
    "Salvaged",
    "Stored",
    "StoredRecording",
    "open_recording",
    "read_file",
    "read_recording",
    "salvage",
    "write_recording",
]

RUN = FileKind(name="run", version=2, remedy="`rotor salvage {path} --out saved.mcap` saves what it holds")
FLUSH_EVERY_NS = 100_000_000  # of the sample clock; chunks half as long take 2 % more room
END = "end"  # metadata record of a recording that was closed, not cut

DAQ = message_type(
    "Daq",
    {
        "model": "string",
        "serial": "string",
        "sample_rate": "double",  # Hz
        "channels": "int64",
        "full_scale_counts": "int64",
        "volts_per_count": "repeated double",  # per channel, as the rest
        "name": "repeated string",  # the probe's, "keyphasor", or "" for a channel not in the config
        "sensitivity": "repeated double",  # V/m, NaN where there is no probe
        "gap_voltage": "repeated double",  # V, likewise
        "simulated": "bool",
        "remarks": "repeated string",  # of the DAQ's driver, for a person
    },
)
EVENT = message_type("Event", {"t_ns": "int64", "kind": "string", "text": "string"})
MOTOR = message_type(
    "Motor",
    {"t_ns": "int64", "speed": "double", "setpoint": "double", "running": "bool", "fault": "string"},  # rad/s
)


class RecordingWriter:
    """Writer of a recording as it is made. However its `with` block is left, the file is closed and valid."""

    def __init__(
        self,
        path: Path,
        rig: RigConfig,
        daq_info: DaqInfo,
        source: Provenance,
        *,
        overwrite: bool = False,
        on_move: Callable[[Path], object] = lambda path: None,
    ) -> None:
        """Begin the file. Raises DataError if it cannot be written or, unless `overwrite`, is there already.

        Should its folder vanish, the recording goes on in another, and `on_move` is told where, by the thread that
        writes.
        """
        self._file = FileWriter(
            path, kind=RUN, rig=rig, source=source, overwrite=overwrite, flush_every_ns=FLUSH_EVERY_NS
        )
        self._samples, self._t_ns = 0, 0
        self._on_move, self._file.on_move = on_move, self._note_move
        self._preview = Preview.of(rig, daq_info)
        shown = self._preview.topics if self._preview else {}
        for topic, kind in (_TOPICS | shown).items():  # in the first chunk, so that none of the others needs another
            self._file.register_topic(topic, kind)
        self._file.write("/daq", DAQ, 0, **_calibration(rig, daq_info))
        self._file.flush()

    def write_block(self, block: Block) -> None:
        """Add a block. Raises DiskFull."""
        self._t_ns = block.t_ns
        self._file.write("/waveform", block_message.WAVEFORM, block.t_ns, **block_message.pack_block(block))
        self._samples += len(block.counts)
        for topic, kind, values in self._preview.take(block) if self._preview else ():
            self._file.write(topic, kind, block.t_ns, **values)

    def write_event(self, event: Event) -> None:
        """Add an event. Raises DiskFull."""
        self._file.write("/events", EVENT, event.t_ns, **asdict(event))

    def write_motor(self, sample: MotorSample) -> None:
        """Add a reading of the motor controller. Raises DiskFull."""
        self._file.write("/motor", MOTOR, sample.t_ns, **asdict(sample))

    def flush(self) -> None:
        """Hand what waits for the rest of its chunk to the system. Raises DiskFull."""
        self._file.flush()

    def close(self, *, complete: bool = True) -> None:
        """Write the index and give the file its name; may be called twice. Raises DiskFull.

        A recording without a sample is discarded. `complete` False says that the one this one copies was cut.
        """
        if not self._samples:
            self._file.discard()
        if not self._file.closed and complete:
            self._file.add_metadata(END, {"samples": str(self._samples)})
        self._file.close()

    @property
    def path(self) -> Path:
        """The recording, where it is or will be: in another folder than it began in if that has vanished."""
        return self._file.path

    def _note_move(self, path: Path) -> None:
        self._on_move(path)
        if not self._file.finished:
            text = f"the recording's file or folder vanished; it goes on as {path}"
            self.write_event(Event(t_ns=self._t_ns, kind="note", text=text))

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


@dataclass(frozen=True, slots=True, kw_only=True)
class Salvaged:
    """Result of a salvage: what was saved of a cut or damaged recording."""

    blocks: int
    samples: int
    seconds: float  # of samples saved
    events: int
    motor: int
    lost_bytes: int  # of the file, that could not be read
    whole: bool  # True: nothing was missing


def read_recording(path: Path) -> RawRecording:
    """Read a recording; its `source` is the file it was read from.

    Raises DataError, in one sentence, for anything but a whole run file.
    """
    return _build_recording(path, _read_contents(path))


def open_recording(path: Path) -> StoredRecording:
    """Open a recording to read its samples as they are asked for; a context manager, which closes the file.

    The whole file is looked through once, and what `read_recording` refuses is refused here too, but no more than a
    few seconds of samples are ever in memory. Raises DataError.
    """
    blocks = BlockIndex()

    def divert(message: Stored, place: Place) -> bool:
        if message.topic == "/waveform":
            blocks.add(message.values, place)
        return message.topic == "/waveform"

    try:
        contents = _read_contents(path, divert=divert)
        head = _build_recording(path, contents)
        _check_order(zip(blocks.first, blocks.samples, blocks.channels, strict=True), head.daq)
    except ValueError as error:
        raise DataError(f"{path}: {error}") from error
    return StoredRecording(path, head, blocks)


def write_recording(path: Path, recording: RawRecording, *, overwrite: bool = False) -> None:
    """Write a recording held in memory. Raises DataError, also if it holds no samples."""
    if not recording.samples:
        raise DataError(f"{path}: is not written, the recording holds no samples")
    with RecordingWriter(path, recording.rig, recording.daq, recording.source, overwrite=overwrite) as writer:
        for block in recording.blocks:
            writer.write_block(block)
        for event in recording.events:
            writer.write_event(event)
        for sample in recording.motor:
            writer.write_motor(sample)
        writer.close(complete=recording.complete)


def salvage(path: Path, out: Path, *, overwrite: bool = False) -> Salvaged:
    """Write to `out` all that can be read of a cut or damaged recording; `path` stays as it is.

    Every whole chunk is saved, also behind a damaged one. The result says that it was cut. Raises DataError if
    nothing can be saved.
    """
    if path.resolve() in (out.resolve(), part_path(out).resolve()):
        raise DataError(f"{out}: would be written over {path.name}, which is to be salvaged; want another name")
    if not overwrite:
        refuse_existing(out)
    contents = _read_contents(path, salvage=True)
    recording = _build_recording(path, contents)
    if not recording.samples:
        raise DataError(f"{path}: holds no samples that can be read, there is nothing to salvage")
    lost = sum(fault.end - fault.start for fault in contents.faults)
    whole = recording.complete and not contents.faults
    if not whole:
        last = recording.blocks[-1] if recording.blocks else None
        end = last.t_ns + round(len(last.counts) * 1e9 / recording.daq.sample_rate) if last else 0
        note = Event(t_ns=end, kind="note", text=f"salvaged from {path.name}: {lost} bytes could not be read")
        recording = replace(recording, events=(*recording.events, note), complete=False)
    write_recording(out, recording, overwrite=overwrite)
    return Salvaged(
        blocks=len(recording.blocks),
        samples=recording.samples,
        seconds=recording.samples / recording.daq.sample_rate,
        events=len(recording.events),
        motor=len(recording.motor),
        lost_bytes=lost,
        whole=whole,
    )


_TOPICS = {"/daq": DAQ, "/waveform": block_message.WAVEFORM, "/events": EVENT, "/motor": MOTOR}


def _calibration(rig: RigConfig, info: DaqInfo) -> dict[str, Any]:
    """Return the calibration from counts to metres, as field values of DAQ."""
    probes = {probe.channel: probe for probe in rig.probes}
    names = {channel: probe.name for channel, probe in probes.items()}
    if rig.keyphasor:
        names[rig.keyphasor.channel] = "keyphasor"
    channels = range(info.channels)
    return asdict(info) | {
        "name": [names.get(c, "") for c in channels],
        "sensitivity": [probes[c].sensitivity if c in probes else math.nan for c in channels],
        "gap_voltage": [probes[c].gap_voltage if c in probes else math.nan for c in channels],
    }


def _read_contents(
    path: Path, *, salvage: bool = False, divert: Callable[[Stored, Place], bool] | None = None
) -> Contents:
    return read_file(path, kind=RUN, types=tuple(_TOPICS.values()), salvage=salvage, divert=divert)


def _build_recording(path: Path, contents: Contents) -> RawRecording:
    of: dict[str, list[Any]] = {topic: [] for topic in _TOPICS}
    for message in contents.messages:
        if message.topic in of:
            of[message.topic].append(message.values)
    if not of["/daq"]:
        raise DataError(f"{path}: does not say what the counts mean (no message on /daq), it cannot be used")
    try:
        daq = _daq_info(of["/daq"][0])
        contents.messages.clear()  # the list just made holds them alone, and lets them go one by one
        blocks = block_message.unpack_blocks(of["/waveform"])
        _check_order(((b.first_sample, *b.counts.shape) for b in blocks), daq)
    except ValueError as error:
        raise DataError(f"{path}: {error}") from error
    return RawRecording(
        rig=contents.rig,
        daq=daq,
        blocks=blocks,
        events=tuple(Event(t_ns=m.t_ns, kind=m.kind, text=m.text) for m in of["/events"]),
        motor=tuple(
            MotorSample(t_ns=m.t_ns, speed=m.speed, setpoint=m.setpoint, running=m.running, fault=m.fault)
            for m in of["/motor"]
        ),
        source=replace(contents.source, source=path.name, source_hash=file_hash(path)),
        complete=END in contents.metadata and not contents.faults,
    )


def _daq_info(message: Any) -> DaqInfo:
    """Return the message as DaqInfo; raises ValueError for an impossible number."""
    info = DaqInfo(
        model=message.model,
        serial=message.serial,
        sample_rate=message.sample_rate,
        channels=message.channels,
        volts_per_count=tuple(message.volts_per_count),
        full_scale_counts=message.full_scale_counts,
        simulated=message.simulated,
        remarks=tuple(message.remarks),
    )
    if len(info.volts_per_count) != info.channels or not all(0 < abs(v) < math.inf for v in info.volts_per_count):
        raise ValueError(f"volts_per_count is {info.volts_per_count}, want one not 0 for each of {info.channels}")
    if not 0 < info.sample_rate < math.inf:
        raise ValueError(f"sample_rate is {info.sample_rate} Hz, want a number above 0")
    return info


def _check_order(blocks: Iterable[tuple[int, int, int]], daq: DaqInfo) -> None:
    """Raise ValueError unless each block has the DAQ's channels and begins where the last one ends or later.

    Of a block: its first sample, how many samples, how many channels.
    """
    expected = 0
    for number, (first, samples, channels) in enumerate(blocks):
        if channels != daq.channels:
            raise ValueError(f"block {number} has {channels} channels, want {daq.channels}")
        if first < expected:
            raise ValueError(f"block {number} begins at sample {first}, want {expected} or later")
        expected = first + samples
