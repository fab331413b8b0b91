from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from rotorrig.acquisition.files.recording_mcap import RecordingWriter, read_recording, salvage
from rotorrig.acquisition.recording import RawRecording
from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.errors import DataError
from rotorrig.rig.probes.base import DaqInfo
from rotorrig.rig.provenance import Provenance
from tests.acquisition.files.file_parts import chunks, same_blocks

SLOW = settings(
    max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture], derandomize=True
)


@given(data=st.data())
@SLOW
def test_cut_anywhere_it_is_refused_and_salvage_saves_a_beginning(
    recording: RawRecording, whole: Path, data: st.DataObject
) -> None:
    content = whole.read_bytes()
    spots = [edge + shift for span in chunks(whole) for edge in span for shift in (-1, 0, 1, 9)]
    at = data.draw(st.one_of(st.integers(0, len(content) - 1), st.sampled_from(spots)))
    cut, out = whole.with_name("cut.mcap"), whole.with_name("saved.mcap")
    cut.write_bytes(content[:at])
    with pytest.raises(DataError, match=r"unfinished|no MCAP|before it says"):
        read_recording(cut)
    try:
        saved = salvage(cut, out, overwrite=True)
    except DataError:
        assert at < chunks(whole)[1][1]  # not even the first tenth of a second is whole
        return
    read = read_recording(out)
    assert same_blocks(read.blocks, recording.blocks[: saved.blocks])
    whole_chunks = sum(end <= at for _, end in chunks(whole)) - 1
    assert saved.blocks >= min(5 * whole_chunks, 25)  # a chunk closes with the block that reaches 0.1 s
    assert not read.complete
    assert read.events[-1].text.startswith("salvaged from cut.mcap")
    assert saved.samples == read.samples == 200 * saved.blocks


@given(data=st.data())
@SLOW
def test_one_wrong_byte_is_found_or_does_no_harm(recording: RawRecording, whole: Path, data: st.DataObject) -> None:
    content = bytearray(whole.read_bytes())
    at = data.draw(st.integers(0, len(content) - 1))
    content[at] ^= data.draw(st.integers(1, 255))
    bad = whole.with_name("bad.mcap")
    bad.write_bytes(content)
    try:
        read = read_recording(bad)
    except DataError:
        return
    assert at > max(end for _, end in chunks(whole))  # only in the index at the end, which is not needed to read all
    assert same_blocks(read.blocks, recording.blocks)
    assert (read.events, read.motor, read.daq, read.rig) == (
        recording.events,
        recording.motor,
        recording.daq,
        recording.rig,
    )


@given(data=st.data())
@SLOW
def test_salvage_of_any_damage_saves_only_what_was_recorded(
    recording: RawRecording, whole: Path, data: st.DataObject
) -> None:
    content = bytearray(whole.read_bytes())
    for _ in range(data.draw(st.integers(1, 3))):
        at = data.draw(st.integers(0, len(content) - 1))
        garbage = data.draw(st.binary(min_size=1, max_size=40))
        content[at : at + len(garbage)] = garbage
    bad, out = whole.with_name("bad.mcap"), whole.with_name("saved.mcap")
    bad.write_bytes(content)
    try:
        salvage(bad, out, overwrite=True)
    except DataError:
        return
    known = {block.first_sample: block for block in recording.blocks}
    for block in read_recording(out).blocks:
        assert np.array_equal(block.counts, known[block.first_sample].counts)


@pytest.mark.parametrize("spot", ["length", "body"])
def test_salvage_goes_on_behind_a_damaged_chunk(recording: RawRecording, whole: Path, spot: str) -> None:
    start, end = chunks(whole)[1]
    content = bytearray(whole.read_bytes())
    if spot == "length":
        content[start + 1 : start + 9] = b"\xff" * 8
    else:
        content[end - 20] ^= 0xFF
    whole.write_bytes(content)
    with pytest.raises(DataError, match=r"damaged at byte \d+.*rotor salvage"):
        read_recording(whole)
    out = whole.with_name("saved.mcap")
    saved = salvage(whole, out)
    read = read_recording(out)
    assert 0 < saved.blocks < 25
    assert same_blocks(read.blocks, recording.blocks[25 - saved.blocks :])
    assert not read.complete
    assert saved.lost_bytes >= end - start


def test_salvage_of_a_whole_file_is_a_whole_file(recording: RawRecording, whole: Path) -> None:
    out = whole.with_name("saved.mcap")
    saved = salvage(whole, out)
    assert saved.whole
    assert saved.lost_bytes == 0
    assert read_recording(out).complete
    assert read_recording(out).events == recording.events


def test_salvage_never_writes_on_its_source(whole: Path) -> None:
    before = whole.read_bytes()
    part = whole.rename(whole.with_name("run.mcap.part"))
    for out in (part, whole):  # the second would be written under the name of the first
        with pytest.raises(DataError, match="want another name"):
            salvage(part, out, overwrite=True)
    assert part.read_bytes() == before


def test_no_more_than_a_tenth_of_a_second_is_held_back(
    recording: RawRecording, rig: RigConfig, daq_info: DaqInfo, source: Provenance, tmp_path: Path
) -> None:
    with RecordingWriter(tmp_path / "run.mcap", rig, daq_info, source) as writer:
        for number, block in enumerate(recording.blocks):
            writer.write_block(block)
            if block.t_ns < 100_000_000:
                continue
            copy = tmp_path / "copy.part"
            copy.write_bytes((tmp_path / "run.mcap.part").read_bytes())
            saved = salvage(copy, tmp_path / "saved.mcap", overwrite=True)
            assert recording.blocks[number].t_ns - recording.blocks[saved.blocks - 1].t_ns < 100_000_000
