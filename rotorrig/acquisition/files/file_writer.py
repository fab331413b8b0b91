"""Writer of an MCAP container: a provisional name until it is whole, and what is saved when the disk takes no more."""

import json
from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from types import TracebackType
from typing import IO, Any, Self, cast

from mcap.data_stream import RecordBuilder
from mcap.records import DataEnd, Footer
from mcap.writer import MCAP0_MAGIC, CompressionType, Writer

from rotorrig.acquisition.files.container import CONFIG_SI, CONFIG_TEXT, HEADER, FileKind
from rotorrig.acquisition.files.fallback_folder import fallback_folders
from rotorrig.acquisition.files.fsync import Syncer
from rotorrig.acquisition.files.part_file import PartFile, part_path
from rotorrig.acquisition.files.schemas import ENCODING, MessageType, register_schema
from rotorrig.rig import DataError, Provenance
from rotorrig.rig.config import RigConfig


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


def _bare_ending() -> bytes:
    """Return the shortest valid end of an MCAP file: no summary, 50 bytes."""
    end = RecordBuilder()
    DataEnd(0).write(end)
    Footer(0, 0, 0).write(end)
    return end.end() + MCAP0_MAGIC
