"""Waveforms out and in again: the same counts within their quantum, the same order vectors, nothing filled in."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import pyuff

from rotorrig.acquisition.exporters.csv import write_csv
from rotorrig.acquisition.exporters.uff import direction, write_uff
from rotorrig.acquisition.importers.csv import read_csv
from rotorrig.acquisition.importers.uff import read_uff
from rotorrig.acquisition.recording import RawRecording
from rotorrig.processing.pipeline import track
from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.errors import DataError
from tests.processing.synthetic import chirp, recording_of

RPM = np.pi / 30
RATE = 5_120.0


@pytest.fixture(scope="module")
def run_up(rig: RigConfig) -> RawRecording:
    """Half a minute from 600 rpm, 20 um on every probe."""
    t = np.arange(int(30 * RATE)) / RATE
    theta = chirp(t, start=600 * RPM, rate=40 * RPM, theta_0=-0.3)
    x = np.tile(20e-6 * np.cos(theta)[:, None], 4) + 1e-8 * np.random.default_rng(1).standard_normal((len(t), 4))
    return recording_of(rig, theta, x, rate=RATE)


WAYS: dict[str, tuple[Callable[..., int], Callable[..., RawRecording]]] = {
    ".csv": (write_csv, read_csv),
    ".uff": (write_uff, read_uff),
}


@pytest.mark.parametrize("suffix", WAYS)
def test_counts_come_back_within_their_quantum(
    suffix: str, run_up: RawRecording, rig: RigConfig, tmp_path: Path
) -> None:
    write, read = WAYS[suffix]
    write(tmp_path / f"run{suffix}", run_up)
    back = read(tmp_path / f"run{suffix}", rig)
    assert back.daq.sample_rate == run_up.daq.sample_rate
    ((_, counts),), ((_, want),) = back.segments(), run_up.segments()
    volts, wanted = counts * np.array(back.daq.volts_per_count), want * np.array(run_up.daq.volts_per_count)
    np.testing.assert_allclose(volts, wanted, atol=0.51 * max(run_up.daq.volts_per_count))


@pytest.mark.parametrize("suffix", WAYS)
def test_the_order_vectors_come_back(suffix: str, run_up: RawRecording, rig: RigConfig, tmp_path: Path) -> None:
    write, read = WAYS[suffix]
    write(tmp_path / f"run{suffix}", run_up)
    ours, theirs = track(run_up), track(read(tmp_path / f"run{suffix}", rig))
    np.testing.assert_allclose(theirs.omega, ours.omega, rtol=1e-9)
    np.testing.assert_allclose(theirs.z, ours.z, atol=1e-10)


def test_a_gap_is_a_jump_of_the_times_and_parts_the_data_sets(
    run_up: RawRecording, rig: RigConfig, tmp_path: Path
) -> None:
    block = run_up.blocks[0]
    parts = tuple(replace(block, counts=block.counts[at : at + 50], first_sample=at) for at in (0, 100))
    gappy = replace(run_up, blocks=parts)
    assert write_csv(tmp_path / "gap.csv", gappy) == 100
    times = np.loadtxt(tmp_path / "gap.csv", delimiter=",", skiprows=1, usecols=0)
    np.testing.assert_allclose(times, np.r_[0:50, 100:150] / RATE, atol=1e-9)
    with pytest.raises(DataError, match=r"row 52, column 'time': is 9.96\d* ms after the row before"):
        read_csv(tmp_path / "gap.csv", rig)
    assert write_uff(tmp_path / "gap.uff", gappy) == 10
    starts = [s["abscissa_min"] for s in pyuff.UFF(str(tmp_path / "gap.uff")).read_sets()]
    np.testing.assert_allclose(starts, [0.0] * 5 + [100 / RATE] * 5, rtol=1e-5)


def test_pyuff_reads_what_is_written(run_up: RawRecording, tmp_path: Path) -> None:
    write_uff(tmp_path / "run.uff", run_up)
    sets = pyuff.UFF(str(tmp_path / "run.uff")).read_sets()
    assert [s["rsp_ent_name"] for s in sets] == ["keyphasor", "1x", "1y", "2x", "2y"]
    assert [(s["rsp_node"], s["rsp_dir"]) for s in sets[1:]] == [(1, 1), (1, 2), (2, 1), (2, 2)]
    probe = sets[1]
    assert (probe["binary"], probe["func_type"], probe["num_pts"]) == (1, 1, run_up.samples)
    assert (probe["abscissa_spec_data_type"], probe["abscissa_axis_units_lab"]) == (17, "s")
    assert probe["ordinate_axis_units_lab"] == "V"
    assert probe["id2"] == "towards the probe [m] = (V - -10) / 7874"
    assert probe["n_bytes"] == 8 * run_up.samples
    counts = run_up.blocks[0].counts[:, 0]
    np.testing.assert_allclose(probe["data"], counts * run_up.daq.volts_per_count[0], rtol=1e-15)


def test_a_probe_between_the_axes_has_no_direction(rig: RigConfig) -> None:
    turned = rig.model_copy(
        update={"probes": tuple(p.model_copy(update={"angle": a}) for p, a in zip(rig.probes, ANGLES, strict=True))}
    )
    assert [direction(turned, p.name) for p in turned.probes] == [-2, -1, 0, 1]


ANGLES = (-np.pi / 2, np.pi, np.pi / 4, 2 * np.pi)


def test_a_file_that_cannot_be_written_is_said_and_not_left_half(run_up: RawRecording, tmp_path: Path) -> None:
    with pytest.raises(DataError, match="cannot be written"):
        write_csv(tmp_path / "nowhere" / "run.csv", run_up)
    assert list(tmp_path.iterdir()) == []
