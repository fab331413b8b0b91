"""A recording read from its file as it is asked for: the same counts, and the same sentences, as one in memory."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from rotorrig.acquisition.files import stored_recording
from rotorrig.acquisition.files.recording_mcap import open_recording, read_recording, write_recording
from rotorrig.acquisition.recording import Event, RawRecording
from rotorrig.rig.config.description import load
from rotorrig.rig.errors import DataError
from rotorrig.rig.probes.base import Block, DaqInfo
from rotorrig.rig.provenance import Provenance

RATE = 10_000.0


def recording(lengths: list[int], *, gap_before: int | None = None) -> RawRecording:
    """Return noise in blocks of these lengths, 300 samples missing before the block of that number."""
    rng = np.random.default_rng(8)
    rig = load(Path(__file__).parents[3] / "configs" / "rk4.toml")
    blocks, first = [], 0
    for number, length in enumerate(lengths):
        first += 300 * (number == gap_before)
        counts = rng.integers(-30_000, 30_000, (length, 5)).astype(np.int32)
        blocks.append(Block(counts=counts, first_sample=first, t_ns=round(first * 1e9 / RATE)))
        first += length
    info = DaqInfo(
        model="m", serial="1", sample_rate=RATE, channels=5, volts_per_count=(1e-3,) * 5, full_scale_counts=32_768
    )
    return RawRecording(
        rig=rig,
        daq=info,
        blocks=tuple(blocks),
        events=(Event(t_ns=0, kind="mark", text="up"),),
        motor=(),
        source=Provenance(config_hash=rig.hash, code_version="test", source="test"),
        complete=True,
    )


@pytest.fixture
def path(tmp_path: Path) -> Path:
    lengths = [*np.random.default_rng(2).integers(1, 900, 60)]
    write_recording(tmp_path / "run.mcap", recording([int(n) for n in lengths], gap_before=25))
    return tmp_path / "run.mcap"


def test_every_slice_is_that_of_the_recording_in_memory(path: Path, rng: np.random.Generator) -> None:
    whole = read_recording(path)
    with open_recording(path) as stored:
        assert (stored.rig, stored.daq, stored.events) == (whole.rig, whole.daq, whole.events)
        assert (stored.source, stored.complete, stored.samples) == (whole.source, whole.complete, whole.samples)
        assert len(stored.segments()) == 2
        for (first, counts), (first_there, there) in zip(stored.segments(), whole.segments(), strict=True):
            assert first == first_there
            assert counts.shape == there.shape
            assert len(counts) == len(there)
            for a, b in np.sort(rng.integers(0, len(there) + 1, (200, 2)), axis=1):
                np.testing.assert_array_equal(counts[a:b], there[a:b])
            np.testing.assert_array_equal(counts[-7:], there[-7:])


def test_no_more_than_the_latest_chunks_stay_in_memory(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stored_recording, "CACHE", 50_000)
    whole = read_recording(path)
    with open_recording(path) as stored:
        (_, counts), _ = stored.segments()
        np.testing.assert_array_equal(counts[:], whole.segments()[0][1])
        np.testing.assert_array_equal(counts[:900], whole.segments()[0][1][:900])
        kept = stored._file._chunks.values()
        assert sum(block.nbytes for chunk in kept for block in chunk.values()) <= 50_000


def test_only_consecutive_samples_may_be_asked_for(path: Path) -> None:
    with open_recording(path) as stored, pytest.raises(ValueError, match="step is 2, want consecutive samples"):
        stored.segments()[0][1][::2]


def test_what_is_no_whole_recording_is_refused_in_the_words_of_the_reader(path: Path, tmp_path: Path) -> None:
    data = path.read_bytes()
    (tmp_path / "cut.mcap").write_bytes(data[: len(data) // 2])
    flipped = bytearray(data)
    flipped[len(data) // 2] ^= 0xFF
    (tmp_path / "damaged.mcap").write_bytes(flipped)
    (tmp_path / "none.mcap").write_bytes(b"nothing")
    backwards = recording([100, 100])
    late = replace(backwards.blocks[1], first_sample=50)
    write_recording(tmp_path / "backwards.mcap", replace(backwards, blocks=(backwards.blocks[0], late)))
    for name in ("cut", "damaged", "none", "backwards", "missing"):
        words = []
        for read in (read_recording, open_recording):
            with pytest.raises(DataError) as refused:
                read(tmp_path / f"{name}.mcap")
            words.append(str(refused.value))
        assert words[0] == words[1]


def test_a_file_that_changes_under_the_reader_is_said(path: Path) -> None:
    with open_recording(path) as stored:
        (_, counts), _ = stored.segments()
        size = path.stat().st_size
        with path.open("r+b") as file:
            file.truncate(size // 3)
        with pytest.raises(DataError, match="has changed since it was opened"):
            counts[:]
