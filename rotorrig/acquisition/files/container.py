"""MCAP container common to all files of this program: writing, reading, salvage.

Each carries the rig's config (TOML as read, and checked SI values as JSON), its kind and version, and where it came
from. While it is being written it has a provisional name, `<name>.part` for a recording: see part_file.
"""

import json
from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from types import TracebackType
from typing import IO, Any, Self, cast

from mcap.data_stream import RecordBuilder
from mcap.records import Attachment, Channel, DataEnd, Footer, McapRecord, Message, Metadata, Schema
from mcap.writer import MCAP0_MAGIC, CompressionType, Writer

from rotorrig.acquisition.files.fallback_folder import fallback_folders
from rotorrig.acquisition.files.fsync import Syncer
from rotorrig.acquisition.files.mcap_records import Fault, Place, records_with_places
from rotorrig.acquisition.files.part_file import PartFile, part_path
from rotorrig.acquisition.files.schemas import ENCODING, MessageType, register_schema
from rotorrig.rig import DataError, Provenance, RigError
from rotorrig.rig.config import RigConfig, description

HEADER = "rotorrig"  # name of the metadata record that says what the file is
CONFIG_TEXT, CONFIG_SI = "config.toml", "config.json"  # names of the attachments


@dataclass(frozen=True, slots=True, kw_only=True)
class FileKind:
    """Kind of a file. Its version rises when an older program would misread it, not for new fields or topics."""

    name: str  # "run"
    version: int
    remedy: str  # what to do about one that is cut or damaged; "{path}" stands for it


@dataclass(frozen=True, slots=True)
class Stored:
    """One message as read."""

    topic: str
    t_ns: int
    values: Any  # an instance of its MessageType's class


@dataclass(frozen=True, slots=True, kw_only=True)
class Contents:
    """Contents of a file."""

    rig: RigConfig
    source: Provenance  # as stored: where the file came from
    metadata: dict[str, dict[str, str]]  # record name -> values; "rotorrig" is the header
    attachments: dict[str, bytes]
    messages: list[Stored]  # of the types asked for, in the file's order
    faults: tuple[Fault, ...]  # empty unless read with `salvage`


class DiskFull(DataError):
    """The file could not be written to its end; the message says what became of it."""


class FileWriter:
    """Writer of one file. Leaving the `with` block by an error discards it; see `close` and `discard`."""

    def __init__(
        self,
        path: Path,
        *,
        kind: FileKind,
        rig: RigConfig,
        source: Provenance,
        overwrite: bool = True,
        flush_every_ns: int | None = None,
    ) -> None:
        """Begin the file under a provisional name.

        With `flush_every_ns` it holds data that cannot be made again: it is called `<path>.part`, messages are handed
        to the system after that much log time at the latest and put on the medium about once a second, on a thread of
        its own; and a full disk leaves a valid file of what was flushed rather than none.
        Raises DataError if it cannot be created, if a `.part` with data was left or, unless `overwrite`, if `path` is
        there already.
        """
        self.on_move: Callable[[Path], object] = lambda path: None  # told where it goes on if its folder vanishes
        try:
            self._file = PartFile(path, overwrite=overwrite, salvageable=flush_every_ns is not None)
            self._syncer = Syncer(self._file.fileno()) if flush_every_ns is not None else None
            if self._syncer:
                self._file.keep_name()
        except OSError as error:
            raise DataError(f"{path}: cannot be written ({error.strerror})") from error
        self._mcap = Writer(cast(IO[bytes], self._file), compression=CompressionType.ZSTD, enable_data_crcs=True)
        self._schemas: dict[str, int] = {}
        self._channels: dict[str, int] = {}
        self._sequence: defaultdict[str, int] = defaultdict(int)
        self._flush_every, self._flushed_ns = flush_every_ns, 0
        self.finished = False  # True once nothing can be added
        self._stranded = False  # no folder would take it; it has no name until it is closed
        with self._handle_disk_errors():
            self._mcap.start(library=f"rotorrig {source.code_version}")
        self.add_metadata(HEADER, {"kind": kind.name, "version": str(kind.version), **asdict(source)})
        self.attach(CONFIG_SI, "application/json", json.dumps(rig.model_dump(mode="json"), indent=1).encode())
        if rig.text:
            self.attach(CONFIG_TEXT, "application/toml", rig.text.encode())
        self.flush()

    def add_metadata(self, name: str, values: Mapping[str, str]) -> None:
        """Add a metadata record. Raises DiskFull."""
        with self._handle_disk_errors():
            self._mcap.add_metadata(name, dict(values))

    def attach(self, name: str, media_type: str, data: bytes) -> None:
        """Add an attachment. Raises DiskFull."""
        with self._handle_disk_errors():
            self._mcap.add_attachment(0, 0, name, media_type, data)

    def register_topic(self, topic: str, kind: MessageType) -> int:
        """Register a topic unless that is done, and return its channel; `write` does so when needed."""
        if topic not in self._channels:
            if kind.name not in self._schemas:
                self._schemas[kind.name] = register_schema(self._mcap, kind)
            self._channels[topic] = self._mcap.register_channel(topic, ENCODING, self._schemas[kind.name])
        return self._channels[topic]

    def write(self, topic: str, kind: MessageType, t_ns: int, /, **values: Any) -> None:
        """Add one message with these field values. Raises DiskFull."""
        data = kind.cls(**values).SerializeToString()
        with self._handle_disk_errors():
            self._mcap.add_message(self.register_topic(topic, kind), t_ns, data, t_ns, self._sequence[topic])
        self._sequence[topic] += 1
        if self._flush_every is not None and t_ns - self._flushed_ns >= self._flush_every:
            self.flush()
            self._flushed_ns = t_ns

    @property
    def path(self) -> Path:
        """The file, where it is or will be."""
        return self._file.path

    @property
    def closed(self) -> bool:
        """True once it has its name, or is gone."""
        return self._file.closed

    def flush(self) -> None:
        """Hand the chunk under way to the system, so that it outlives this process. Raises DiskFull."""
        with self._handle_disk_errors():
            self._mcap.flush()
            self._file.mark()
        if self._syncer is not None and not self._stranded and self._file.astray:
            self._stranded = not self._move()

    def close(self) -> None:
        """Write the index and give the file its name; may be called twice. Raises DiskFull."""
        if self.closed:
            return
        self._stranded = False
        self.flush()
        self._end_sync()
        self.finished = True
        with self._handle_disk_errors():
            self._mcap.finish()
            self._file.sync()
        self._take_name()

    def discard(self) -> None:
        """Leave nothing behind; may be called twice, and does nothing after `close`."""
        if not self.closed:
            self._end_sync()
            self._file.discard()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if kind is None:
            self.close()
        else:
            self.discard()

    @contextmanager
    def _handle_disk_errors(self) -> Iterator[None]:
        """Turn an OSError, the syncing thread's too, into DiskFull, after saving what can be saved."""
        try:
            yield
            if self._syncer is not None and self._syncer.fault is not None:
                raise self._syncer.fault
        except OSError as error:
            self._end_sync()
            kept = self._file.end_early(_bare_ending()) if self._flush_every is not None else 0
            if kept:
                self._take_name()
                fate = f"it ends early and keeps the {kept / 1e6:.2f} MB before that"
            elif self._flush_every is not None and self._file.marked:
                self._file.close()
                part = part_path(self.path)
                fate = f"not even its end; `rotor salvage {part} --out saved.mcap` saves what {part.name} holds"
            else:
                self._file.discard()
                fate = "nothing of it is kept"
            raise DiskFull(f"{self.path}: cannot be written any further ({error.strerror}); {fate}") from error

    def _end_sync(self) -> None:
        if self._syncer is not None:
            self._syncer.close()

    def _take_name(self) -> None:
        try:
            if self._flush_every is not None and self._file.astray and self._move():
                self._end_sync()
                self._file.sync()
            self._file.take_name()
        except OSError as error:
            self._file.close()
            raise DataError(
                f"{self.path}: cannot be given its name ({error.strerror}); look for {part_path(self.path).name}"
            ) from error

    def _move(self) -> bool:
        """Go on in the first folder that takes the file, and say so; False if none does."""
        self._end_sync()
        for folder in fallback_folders(self.path):
            try:
                self._file.move_to(folder)
                self._syncer = Syncer(self._file.fileno())
                self._file.keep_name()
            except OSError:
                continue
            self.on_move(self.path)
            return True
        return False


def read_file(
    path: Path,
    *,
    kind: FileKind,
    types: tuple[MessageType, ...],
    salvage: bool = False,
    divert: Callable[[Stored, Place], bool] | None = None,
) -> Contents:
    """Read a file of this `kind`; messages of other types than `types` are left out.

    With `salvage`, damaged stretches are skipped and listed in `Contents.faults`. Every message is shown to `aside`,
    with its place in the file, and not kept where that returns True. Raises DataError, in one sentence, for a file
    that is missing, no MCAP, none of ours, of another kind, of a newer version, cut or damaged.
    """
    _refuse_missing(path)
    parts = _Parts(path, kind, {t.name: t for t in types}, divert)
    for record, place in records_with_places(path):
        if isinstance(record, Fault) and not salvage:
            raise DataError(_damage(path, record, kind, parts.metadata))
        parts.add(record, place)
    if HEADER not in parts.metadata:
        raise DataError(f"{path}: is an MCAP file but none of this program's, want a {kind.name} file")
    return Contents(
        rig=_config(path, parts.attachments),
        source=_provenance(parts.metadata[HEADER]),
        metadata=parts.metadata,
        attachments=parts.attachments,
        messages=parts.messages,
        faults=tuple(parts.faults),
    )


class _Parts:
    """Collector of a file's records by their type."""

    def __init__(
        self,
        path: Path,
        kind: FileKind,
        types: Mapping[str, MessageType],
        divert: Callable[[Stored, Place], bool] | None,
    ) -> None:
        self._path, self._kind, self._types, self._aside = path, kind, types, divert
        self._schemas: dict[int, str] = {}
        self._channels: dict[int, Channel] = {}
        self.attachments: dict[str, bytes] = {}
        self.metadata: dict[str, dict[str, str]] = {}
        self.messages: list[Stored] = []
        self.faults: list[Fault] = []

    def add(self, record: McapRecord | Fault, place: Place) -> None:
        match record:
            case Fault():
                self.faults.append(record)
            case Attachment():
                self.attachments[record.name] = record.data
            case Metadata():
                self.metadata[record.name] = record.metadata
                if record.name == HEADER:
                    _check_header(self._path, self._kind, record.metadata)
            case Schema():
                self._schemas[record.id] = record.name
            case Channel():
                self._channels[record.id] = record
            case Message():
                self._add_message(record, place)

    def _add_message(self, message: Message, place: Place) -> None:
        if (channel := self._channels.get(message.channel_id)) is None:
            raise DataError(
                f"{self._path}: channel {message.channel_id} is not described anywhere, its messages are lost"
            )
        kind = self._types.get(self._schemas.get(channel.schema_id, ""))
        if kind is None:
            return
        try:
            values = kind.cls.FromString(message.data)
        except Exception as error:  # protobuf's DecodeError, which it exports from no stable place
            raise DataError(f"{self._path}: a message of {channel.topic} is no {kind.name} ({error})") from error
        stored = Stored(channel.topic, message.log_time, values)
        if self._aside is None or not self._aside(stored, place):
            self.messages.append(stored)


def _bare_ending() -> bytes:
    """Return the shortest valid end of an MCAP file: no summary, 50 bytes."""
    end = RecordBuilder()
    DataEnd(0).write(end)
    Footer(0, 0, 0).write(end)
    return end.end() + MCAP0_MAGIC


def _refuse_missing(path: Path) -> None:
    if path.is_dir():
        raise DataError(f"{path}: is a folder, want a file")
    if not path.exists() and part_path(path).exists():
        raise DataError(
            f"{path}: is not there, but {part_path(path).name} is, cut short (or under way); "
            f"`rotor salvage {part_path(path)} --out saved.mcap` saves what it holds"
        )
    if not path.exists():
        raise DataError(f"{path}: is not there")


def _damage(path: Path, fault: Fault, kind: FileKind, metadata: dict[str, dict[str, str]]) -> str:
    if HEADER not in metadata:
        return f"{path}: is cut or damaged at byte {fault.start}, before it says what it is; want a {kind.name} file"
    damage = "is unfinished" if fault.cut else "is damaged"
    return f"{path}: {damage} at byte {fault.start} ({fault.what}); {kind.remedy.format(path=path)}"


def _check_header(path: Path, kind: FileKind, header: dict[str, str]) -> None:
    if header.get("kind") != kind.name:
        raise DataError(f"{path}: is a {header.get('kind', 'nameless')} file, want a {kind.name} file")
    version = header.get("version", "")
    if not version.isdecimal() or int(version) > kind.version:
        raise DataError(
            f"{path}: is version {version or 'unknown'} of a {kind.name} file, written by rotorrig "
            f"{header.get('code_version', '')}; this program reads up to version {kind.version}"
        )


def _config(path: Path, attachments: dict[str, bytes]) -> RigConfig:
    if CONFIG_SI not in attachments:
        raise DataError(f"{path}: holds no {CONFIG_SI}, the rig's config, and cannot be read without")
    try:
        text = attachments.get(CONFIG_TEXT, b"").decode()
        return description.from_si(json.loads(attachments[CONFIG_SI]), text=text, where=f"{path}, {CONFIG_SI}")
    except (ValueError, RecursionError) as error:
        raise DataError(f"{path}: its {CONFIG_SI} cannot be read ({error})") from error
    except RigError as error:
        raise DataError(str(error)) from error


def _provenance(header: dict[str, str]) -> Provenance:
    return Provenance(**{field.name: header.get(field.name, "") for field in fields(Provenance)})
