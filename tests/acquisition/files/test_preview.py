"""Numbers over time beside the samples: what a viewer without a plugin plots of a recording."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from google.protobuf import descriptor_pb2, descriptor_pool, message_factory
from mcap.reader import make_reader

from rotorrig.acquisition.files.recording_mcap import read_recording, salvage, write_recording
from rotorrig.acquisition.recording import RawRecording
from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.probes.base import Block, DaqInfo

RATE, TURNS = 10_000, 20.0  # Hz, per second: 1200 rpm
MICROMETRE = 7874e-6 / 6e-4  # counts, of a probe of the rk4 on a DAQ of 0.6 mV per count


def plotted(path: Path, topic: str) -> list[tuple[float, dict[str, float]]]:
    """Return time [s] and fields of a topic's messages, by the official reader and the file's own descriptors."""
    found = []
    with path.open("rb") as file:
        for schema, _, message in make_reader(file).iter_messages(topics=[topic]):
            assert schema is not None
            pool = descriptor_pool.DescriptorPool()
            for part in descriptor_pb2.FileDescriptorSet.FromString(schema.data).file:
                pool.Add(part)
            values = message_factory.GetMessageClass(pool.FindMessageTypeByName(schema.name)).FromString(message.data)
            fields = {field.name: getattr(values, field.name) for field in values.DESCRIPTOR.fields}
            assert all(field.type == field.TYPE_DOUBLE for field in values.DESCRIPTOR.fields)
            found.append((message.log_time / 1e9, fields))
    return found


@pytest.fixture
def turning(recording: RawRecording, rig: RigConfig) -> RawRecording:
    """Two seconds at 1200 rpm: 1x between 10 and 30 um, 1y between -5 and 5 um about its gap voltage."""
    assert rig.keyphasor is not None
    t = np.arange(2 * RATE) / RATE
    counts = np.zeros((len(t), 5))
    wave = np.cos(2 * np.pi * TURNS * t)
    for probe, um in (("1x", 20 + 10 * wave), ("1y", 5 * wave)):
        scale = rig.probe(probe)
        counts[:, scale.channel] = scale.gap_voltage / 6e-4 + um * MICROMETRE
    counts[:, rig.keyphasor.channel] = np.where(TURNS * t % 1 < 0.1, -8000, 0)  # 1 mV per count
    whole = np.round(counts).astype(np.int32)
    blocks = tuple(
        Block(counts=whole[i : i + 200], first_sample=i, t_ns=round(i * 1e9 / RATE)) for i in range(0, len(t), 200)
    )
    return replace(recording, blocks=blocks)


def test_speed_and_the_reach_of_every_probe_stand_in_the_file_as_numbers(turning: RawRecording, tmp_path: Path) -> None:
    write_recording(tmp_path / "run.mcap", turning)
    speed = plotted(tmp_path / "run.mcap", "/speed")
    assert 8 <= len(speed) <= 10
    assert np.diff([t for t, _ in speed]) == pytest.approx(0.22, abs=0.03)
    assert speed[-1][1]["rpm"] == pytest.approx(1200.0, rel=1e-3)
    for probe, low, high in (("1x", 10.0, 30.0), ("1y", -5.0, 5.0)):
        for _, reach in plotted(tmp_path / "run.mcap", f"/envelope/{probe}"):
            assert reach["low_um"] == pytest.approx(low, abs=0.1)
            assert reach["high_um"] == pytest.approx(high, abs=0.1)


def test_nothing_between_two_messages_is_missed(turning: RawRecording, tmp_path: Path, rig: RigConfig) -> None:
    spiked = [block.counts.copy() for block in turning.blocks]
    spiked[33][7, rig.probe("1x").channel] += round(50 * MICROMETRE)
    blocks = tuple(replace(block, counts=counts) for block, counts in zip(turning.blocks, spiked, strict=True))
    write_recording(tmp_path / "run.mcap", replace(turning, blocks=blocks))
    loud = [t for t, reach in plotted(tmp_path / "run.mcap", "/envelope/1x") if reach["high_um"] > 50]
    assert len(loud) == 1
    assert 0 <= loud[0] - 33 * 0.02 <= 0.22


def test_it_changes_nothing_of_the_samples_and_a_salvage_makes_it_anew(turning: RawRecording, tmp_path: Path) -> None:
    whole = tmp_path / "run.mcap"
    write_recording(whole, turning)
    read = read_recording(whole)
    assert all(np.array_equal(a.counts, b.counts) for a, b in zip(read.blocks, turning.blocks, strict=True))
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(whole.read_bytes()[: whole.stat().st_size // 2])
    salvage(cut, tmp_path / "saved.mcap")
    saved = plotted(tmp_path / "saved.mcap", "/envelope/1x")
    assert 0 < len(saved) < len(plotted(whole, "/envelope/1x"))
    assert saved == plotted(whole, "/envelope/1x")[: len(saved)]


def test_a_rig_whose_channels_the_daq_has_not_is_recorded_without(
    turning: RawRecording, tmp_path: Path, daq_info: DaqInfo
) -> None:
    few = replace(daq_info, channels=2, volts_per_count=(6e-4, 6e-4))
    blocks = tuple(replace(block, counts=block.counts[:, :2]) for block in turning.blocks)
    write_recording(tmp_path / "run.mcap", replace(turning, daq=few, blocks=blocks))
    assert plotted(tmp_path / "run.mcap", "/speed") == []
    assert read_recording(tmp_path / "run.mcap").samples == turning.samples
