"""Kind of a file, judged by its content: what this program writes, whatever it is called."""

import json
from pathlib import Path
from typing import Any

from mcap.records import Metadata
from mcap.writer import MCAP0_MAGIC

from rotorrig.acquisition.files.container import HEADER
from rotorrig.acquisition.files.mcap_records import read_records
from rotorrig.rig import ConfigError, DataError
from rotorrig.rig.config import read_toml

#: kind -> what it is called in a sentence; "empty" and those behind it are written by no verb
KINDS = {
    "run": "a recording",
    "response": "a response",
    "fit": "a fit",
    "diagnosis": "a diagnosis",
    "balance": "a balance",
    "prediction": "a prediction",
    "investigation": "an investigation",
    "proof": "a certificate of a proof test",
    "report": "a report",
    "rrd": "a Rerun file",
    "config": "a rig config",
    "csv": "a CSV table of this program",
    "parquet": "a Parquet table of this program",
    "uff": "a universal file",
    "layout": "a Foxglove layout",
    "ross": "a rotor of ROSS",
    "truth": "a sealed truth",
    "empty": "an empty file",
    "mcap": "an MCAP file of another program",
    "other": "a file of another kind",
}
_JSON_KINDS = {
    "rotorrig fit": "fit",
    "rotorrig diagnosis": "diagnosis",
    "rotorrig balance": "balance",
    "rotorrig prediction": "prediction",
    "rotorrig investigation": "investigation",
    "rotorrig proof test": "proof",
}
LAB_CSV = b"# of a lab's catalogue:"  # with which the CSV of a query begins
LAB_PARQUET = b"rotorrig.lab.query"  # key in the metadata of its Parquet
_CSV_HEADS = (b"time [s],", b"# order vectors, raw;", b"# predicted vectors;", LAB_CSV)
_TITLES = (b": rotor report</title>", b": predicted vibration</title>", b": balance sheet</title>")
_HEAD = 1 << 16  # bytes that are looked at for all but JSON and TOML
_LARGEST = 1 << 28  # bytes of a JSON file that is read


def read_file_kind(path: Path) -> str:
    """Return "run" or "response". Raises DataError for a file that is not there or none of this program's."""
    if not path.is_file():
        raise DataError(f"{path}: is not there, want a run.mcap or a response.mcap")
    kind = _header_kind(path)
    if kind is None:
        raise DataError(f"{path}: is an MCAP file but none of this program's, want a run.mcap or a response.mcap")
    return kind


def is_mcap(path: Path) -> bool:
    """Return whether a file begins as an MCAP file does; one that cannot be read does not."""
    try:
        with path.open("rb") as file:
            return file.read(len(MCAP0_MAGIC)) == MCAP0_MAGIC
    except OSError:
        return False


def content_kind(path: Path) -> str:
    """Return the kind of an existing file, a key of `KINDS`. Raises DataError if it cannot be read."""
    try:
        with path.open("rb") as file:
            head = file.read(_HEAD)
        if head.lstrip(b"\xef\xbb\xbf \t\r\n")[:1] in (b"{", b"["):
            return _json_kind(path)
    except OSError as error:
        raise DataError(f"{path}: cannot be read ({error.strerror})") from error
    if not head:
        return "empty"
    if head.startswith(MCAP0_MAGIC):
        kind = _header_kind(path) or "mcap"
        return kind if kind in KINDS else "mcap"
    if head.startswith(b"RRF"):
        return "rrd"
    if head.startswith((b"    -1\n", b"    -1\r")):
        return "uff"
    if head.startswith(_CSV_HEADS):
        return "csv"
    if head.startswith(b"PAR1"):
        return "parquet" if LAB_PARQUET in _tail(path) else "other"
    if any(title in head for title in _TITLES):
        return "report"
    return _toml_kind(path)


def read_source_hash(path: Path) -> str:
    """Return the hash of the file that a run or response was made from; empty for none, or a file of another program.

    Raises DataError if it cannot be read.
    """
    return _header(path).get("source_hash", "")


def _header_kind(path: Path) -> str | None:
    header = _header(path)
    return header.get("kind", "") if header else None


def _header(path: Path) -> dict[str, str]:
    """Return the metadata that say what a file is; empty for a file of another program."""
    for record in read_records(path):
        if isinstance(record, Metadata) and record.name == HEADER:
            return dict(record.metadata)
    return {}


def _tail(path: Path) -> bytes:
    """Return the end of a file, where Parquet has its metadata."""
    with path.open("rb") as file:
        file.seek(max(path.stat().st_size - _HEAD, 0))
        return file.read()


def _json_kind(path: Path) -> str:
    try:
        table = json.loads(path.read_bytes()) if path.stat().st_size <= _LARGEST else None
    except (ValueError, RecursionError):
        return _toml_kind(path)  # a TOML file may begin with "[" too
    if not isinstance(table, dict):
        return "other"
    if str(table.get("schema", "")).startswith("rotorrig.plant.truth/"):
        return "truth"
    if "configById" in table:
        return "layout"
    return _JSON_KINDS.get(str(table.get("kind")), _table_kind(table))


def _toml_kind(path: Path) -> str:
    try:
        return _table_kind(read_toml(path, want="a table")[0])
    except ConfigError:
        return "other"


def _table_kind(table: dict[str, Any]) -> str:
    if "ross_version" in table:
        return "ross"
    return "config" if {"shaft", "bearings"} <= table.keys() else "other"
