"""What an .rrd file holds."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from rerun.chunk import RrdReader


def chunks(path: Path) -> Iterator[tuple[str, Any]]:
    """Yield what an .rrd holds, piece by piece, with its place."""
    return ((str(chunk.entity_path), chunk.to_record_batch()) for chunk in RrdReader(str(path)).stream())


def labels(chunk: Any) -> list[str]:
    """Return the words that a piece writes into a picture."""
    if "Points2D:labels" not in chunk.schema.names:
        return []
    return [word for row in chunk["Points2D:labels"].to_pylist() if row for word in row]


def words_in(path: Path) -> list[str]:
    """Return the words in all pictures of an .rrd."""
    return [word for _, chunk in chunks(path) for word in labels(chunk)]
