"""Kind of a file written by this program: recording or response."""

from pathlib import Path

from mcap.records import Metadata

from rotorrig.acquisition.files.container import HEADER
from rotorrig.acquisition.files.mcap_records import read_records
from rotorrig.rig import DataError


def read_file_kind(path: Path) -> str:
    """Return "run" or "response". Raises DataError for a file that is not there or none of this program's."""
    if not path.is_file():
        raise DataError(f"{path}: is not there, want a run.mcap or a response.mcap")
    for record in read_records(path):
        if isinstance(record, Metadata) and record.name == HEADER:
            return record.metadata.get("kind", "")
    raise DataError(f"{path}: is an MCAP file but none of this program's, want a run.mcap or a response.mcap")
