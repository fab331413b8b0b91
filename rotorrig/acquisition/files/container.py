"""MCAP container common to all files of this program: reading and salvage; file_writer writes it.

Each carries the rig's config (TOML as read, and checked SI values as JSON), its kind and version, and where it came
from. While it is being written it has a provisional name, `<name>.part` for a recording: see part_file.
"""

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

from mcap.records import Attachment, Channel, McapRecord, Message, Metadata, Schema

from rotorrig.acquisition.files.mcap_records import Fault, Place, records_with_places
from rotorrig.acquisition.files.part_file import part_path
from rotorrig.acquisition.files.schemas import MessageType
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


def read_file(
    path: Path,
    *,
    kind: FileKind,
    types: tuple[MessageType, ...],
    salvage: bool = False,
    divert: Callable[[Stored, Place], bool] | None = None,
) -> Contents:
    """Read a file of this `kind`; messages of other types than `types` are left out.

    With `salvage`, damaged stretches are skipped and listed in `Contents.faults`. Every message is shown to `divert`,
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
        self._path, self._kind, self._types, self._divert = path, kind, types, divert
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
        if self._divert is None or not self._divert(stored, place):
            self.messages.append(stored)


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
