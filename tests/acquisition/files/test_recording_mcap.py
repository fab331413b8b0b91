import dataclasses
import re
import resource
import struct
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from mcap.reader import make_reader

from rotorrig.acquisition.files.container import FileKind
from rotorrig.acquisition.files.file_writer import FileWriter
from rotorrig.acquisition.files.recording_mcap import RecordingWriter, read_recording, write_recording
from rotorrig.acquisition.recording import RawRecording
from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.errors import DataError
from rotorrig.rig.provenance import Provenance, file_hash
from tests.acquisition.files.file_parts import chunks, same_blocks

ROOT = Path(__file__).parents[3]
DOCS = ROOT / "docs/files.md"


def test_a_recording_comes_back_as_it_was(recording: RawRecording, whole: Path) -> None:
    read = read_recording(whole)
    assert same_blocks(read.blocks, recording.blocks)
    assert (read.rig, read.rig.text, read.rig.hash) == (recording.rig, recording.rig.text, recording.rig.hash)
    assert read.daq == recording.daq
    assert (read.events, read.motor, read.complete) == (recording.events, recording.motor, True)
    assert not whole.with_name("run.mcap.part").exists()


def test_what_a_daq_says_of_itself_comes_back(recording: RawRecording, tmp_path: Path) -> None:
    inverting = (6e-4, -6e-4, 6e-4, 6e-4, 1e-3)
    said = dataclasses.replace(
        recording.daq, simulated=True, remarks=("channel 1 is turned",), volts_per_count=inverting
    )
    write_recording(tmp_path / "said.mcap", dataclasses.replace(recording, daq=said))
    assert read_recording(tmp_path / "said.mcap").daq == said


def test_its_source_is_the_file_it_was_read_from(recording: RawRecording, whole: Path) -> None:
    source = read_recording(whole).source
    assert (source.source, source.source_hash) == (whole.name, file_hash(whole))
    assert (source.config_hash, source.code_version) == (recording.rig.hash, "0.1.0")


@pytest.mark.parametrize("version", ["v1", "v2"])
def test_a_recording_of_before_is_still_read(version: str) -> None:
    """See tests/data/recording-v1/README.md for what it holds."""
    read = read_recording(ROOT / f"tests/data/recording-{version}/run.mcap")
    assert [block.first_sample for block in read.blocks] == [0, 200, 400, 700, 900, 1100, 1300, 1500, 1700, 1900]
    assert [block.overrun for block in read.blocks] == [False] * 3 + [True] + [False] * 6
    for block in read.blocks:
        scans = np.arange(block.first_sample, block.first_sample + 200)[:, None]
        plain = 37 * np.arange(1, 6) * scans % 60001 - 30000
        assert np.array_equal(block.counts, plain * (100 if block.first_sample == 1100 else 1))
    assert (len(read.events), len(read.motor), read.complete, read.rig.name[:3]) == (2, 1, True, "RK4")


def test_a_stretch_without_gaps_is_put_together_without_a_copy(whole: Path) -> None:
    read = read_recording(whole)
    (_, before), (_, after) = read.segments()
    assert np.shares_memory(before, read.blocks[0].counts)
    assert np.shares_memory(after, read.blocks[-1].counts)
    assert np.array_equal(before, np.concatenate([block.counts for block in read.blocks[:10]]))


def test_a_gap_stays_a_gap(whole: Path) -> None:
    assert [(first, len(counts)) for first, counts in read_recording(whole).segments()] == [(0, 2000), (2100, 3000)]


def test_a_recording_without_a_sample_leaves_no_file(recording: RawRecording, tmp_path: Path) -> None:
    with pytest.raises(DataError, match="holds no samples"):
        write_recording(tmp_path / "run.mcap", dataclasses.replace(recording, blocks=()))
    with RecordingWriter(tmp_path / "run.mcap", recording.rig, recording.daq, recording.source) as writer:
        writer.write_event(recording.events[0])
    assert not any(tmp_path.iterdir())


def test_the_official_reader_agrees_and_finds_an_index(recording: RawRecording, whole: Path) -> None:
    with whole.open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        summary = reader.get_summary()
        assert summary is not None
        assert summary.statistics is not None
        topics = {channel.id: channel.topic for channel in summary.channels.values()}
        counted = {topics[i]: n for i, n in summary.statistics.channel_message_counts.items()}
        assert counted.items() >= {"/daq": 1, "/waveform": 25, "/events": 2, "/motor": 1}.items()
        names = {a.name: a.data for a in reader.iter_attachments()}
        assert names["config.toml"].decode() == recording.rig.text
        assert [m.log_time for _, _, m in reader.iter_messages(topics="/waveform")] == [
            block.t_ns for block in recording.blocks
        ]


def test_the_documents_snippet_prints_the_mean_volts_of_every_block(recording: RawRecording, whole: Path) -> None:
    snippet = re.search(r"```python\n(.*?)```", DOCS.read_text(), re.DOTALL)
    assert snippet
    done = subprocess.run([sys.executable, "-c", snippet[1]], cwd=whole.parent, capture_output=True, text=True)
    assert done.stderr == ""
    lines = done.stdout.replace("\n ", " ").splitlines()
    assert len(lines) == 25
    first = np.array(re.findall(r"-?\d+\.\d*(?:e-?\d+)?", lines[0]), dtype=float)
    expected = (recording.blocks[0].counts * np.array(recording.daq.volts_per_count)).mean(axis=0)
    assert first == pytest.approx([0.0, *expected], rel=1e-6)


@pytest.mark.parametrize("topic", ["/daq", "/waveform", "/events", "/motor", "/speed", "/envelope/1x"])
def test_the_document_names_every_field(topic: str, whole: Path) -> None:
    from google.protobuf import descriptor_pb2

    written = topic.replace("/1x", "/<probe>")
    row = next(line for line in DOCS.read_text().splitlines() if line.startswith(f"| `{written}`"))
    with whole.open("rb") as file:
        schema, _, _ = next(make_reader(file).iter_messages(topics=topic))
        assert schema is not None
        assert f"`{schema.name}`" in row
        for field in descriptor_pb2.FileDescriptorSet.FromString(schema.data).file[0].message_type[0].field:
            assert f"`{field.name}`" in row


# --- names


def test_an_existing_recording_is_not_overwritten(recording: RawRecording, whole: Path) -> None:
    before = whole.read_bytes()
    with pytest.raises(DataError, match="is there already"):
        write_recording(whole, recording)
    assert whole.read_bytes() == before
    write_recording(whole, dataclasses.replace(recording, events=()), overwrite=True)
    assert read_recording(whole).events == ()


def test_what_a_crash_left_is_not_overwritten_either(recording: RawRecording, tmp_path: Path) -> None:
    part = tmp_path / "run.mcap.part"
    part.write_bytes(b"precious")
    with pytest.raises(DataError, match=r"rotor salvage .*run\.mcap\.part"):
        write_recording(tmp_path / "run.mcap", recording)
    assert part.read_bytes() == b"precious"


def test_asking_for_a_file_that_is_only_half_there_names_the_half(tmp_path: Path) -> None:
    (tmp_path / "run.mcap.part").write_bytes(b"")
    with pytest.raises(DataError, match=r"run\.mcap: is not there, but run\.mcap\.part is.*rotor salvage"):
        read_recording(tmp_path / "run.mcap")


def test_a_folder_that_is_not_there_is_said(recording: RawRecording, tmp_path: Path) -> None:
    with pytest.raises(DataError, match="cannot be written \\(No such file"):
        write_recording(tmp_path / "no" / "run.mcap", recording)


# --- files that are something else


@pytest.mark.parametrize("content", [b"", b"time [s], 1x [um]\n", b"\x89PNG\r\n\x1a\n" + bytes(100)])
def test_a_file_that_is_no_mcap_is_refused(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "x.mcap"
    path.write_bytes(content)
    with pytest.raises(DataError, match="is no MCAP file"):
        read_recording(path)


def test_a_folder_and_a_missing_file_are_refused(tmp_path: Path) -> None:
    with pytest.raises(DataError, match="is a folder"):
        read_recording(tmp_path)
    with pytest.raises(DataError, match="is not there"):
        read_recording(tmp_path / "nothing.mcap")


def test_another_programs_mcap_is_refused(tmp_path: Path) -> None:
    from mcap.writer import Writer

    path = tmp_path / "robot.mcap"
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        writer.finish()
    with pytest.raises(DataError, match="an MCAP file but none of this program's, want a run file"):
        read_recording(path)


@pytest.mark.parametrize(
    ("kind", "version", "said"),
    [
        ("response", 1, "is a response file, want a run file"),
        ("run", 3, "is version 3 of a run file, written by rotorrig 0.1.0; this program reads up to version 2"),
    ],
)
def test_other_kinds_and_newer_versions_are_refused(
    rig: RigConfig, source: Provenance, tmp_path: Path, kind: str, version: int, said: str
) -> None:
    path = tmp_path / "other.mcap"
    with FileWriter(path, kind=FileKind(name=kind, version=version, remedy=""), rig=rig, source=source):
        pass
    with pytest.raises(DataError, match=said):
        read_recording(path)


def test_a_chunk_that_would_unpack_to_gigabytes_is_refused_unopened(whole: Path) -> None:
    data, (start, _) = bytearray(whole.read_bytes()), chunks(whole)[1]
    data[start + 9 + 16 : start + 9 + 24] = struct.pack("<Q", 2**40)  # uncompressed_size
    whole.write_bytes(data)
    with pytest.raises(DataError, match="would unpack to more than 64 MiB"):
        read_recording(whole)


def test_a_zstd_frame_that_claims_gigabytes_is_refused_unopened(whole: Path) -> None:
    data, (start, end) = whole.read_bytes(), chunks(whole)[1]
    frame = data.index(bytes.fromhex("28b52ffd"), start)
    # a frame header with a content size of eight bytes, RFC 8878 section 3.1.1.1
    hostile = bytes.fromhex("28b52ffde0") + struct.pack("<Q", 2**40) + data[frame + 13 : end]
    whole.write_bytes(data[:frame] + hostile + data[end:])
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with pytest.raises(DataError, match="would unpack to more than 64 MiB"):
        read_recording(whole)
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 100_000  # kB


def test_an_attachment_with_a_wrong_byte_is_found(whole: Path) -> None:
    content = whole.read_bytes()
    at = content.index(b'"length": 0.56')
    whole.write_bytes(content[:at] + b'"length": 0.57' + content[at + 14 :])
    with pytest.raises(DataError, match="attachment record: wrong CRC"):
        read_recording(whole)
