"""Spectra over speed of recordings whose lines are known: a circular whirl in closed form, circles added to it."""

import dataclasses

import numpy as np
import pytest
from numpy.typing import NDArray

from rotorrig.acquisition.recording import RawRecording
from rotorrig.app.plot_data.speed_spectra import SpeedSpectra, highest_in_bins, spectrum, speed_spectra, stretch_seconds
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.processing.waveform import Waveforms
from rotorrig.rig.probes.base import Block
from tests.app.conftest import CRITICAL, jeffcott

RAD = np.pi / 30
PER_METRE = 7874 / (20 / 2**23)  # counts: 7.874 mV/um into 24 bits over 20 V


@pytest.fixture(scope="module")
def spectra(tracked: OrderTrackedResponse, recording: RawRecording) -> tuple[SpeedSpectra, ...]:
    return speed_spectra(tracked, Waveforms(recording))


def test_each_plane_has_a_map_of_each_run(spectra: tuple[SpeedSpectra, ...]) -> None:
    assert [(one.place[:6], one.direction) for one in spectra] == [
        ("1x, 1y", 1),
        ("2x, 2y", 1),
        ("1x, 1y", -1),
        ("2x, 2y", -1),
    ]
    assert all(one.full and one.frequency[0] == pytest.approx(-one.frequency[-1]) for one in spectra)
    assert spectra[0].frequency[-1] == pytest.approx(5 * 50.0, rel=0.02)  # five times 3000 rpm, a bin's middle


def test_a_forward_whirl_is_brightest_at_its_critical_speed_on_the_line_of_1x(
    spectra: tuple[SpeedSpectra, ...],
) -> None:
    for one in spectra:
        size, hertz, rpm = one.largest
        assert rpm * RAD == pytest.approx(CRITICAL, rel=0.02)
        assert hertz == pytest.approx(rpm / 60, abs=one.resolution)
        assert size == pytest.approx(np.abs(jeffcott(np.array([rpm * RAD])))[0] * 1e6, rel=0.05)
        assert one.amplitude[:, one.frequency < -one.resolution].max() < 0.02 * size, "nothing whirls backward"


def test_the_line_of_1x_is_read_at_every_speed(spectra: tuple[SpeedSpectra, ...]) -> None:
    wanted = np.abs(jeffcott(spectra[0].rpm * RAD)) * 1e6
    away = np.abs(spectra[0].rpm - 2230) > 200  # nearer, 0.3 s of this fast ramp are several speeds
    assert spectra[0].amplitude.max(axis=1)[away] == pytest.approx(wanted[away], rel=0.05)


def with_circle(recording: RawRecording, hertz: float) -> RawRecording:
    """The recording with a backward circle of 2 um at a frequency of its own."""
    (block,) = recording.blocks
    turn = 2 * np.pi * hertz * np.arange(len(block.counts)) / recording.daq.sample_rate
    angles = np.array([probe.angle for probe in recording.rig.probes])
    counts = block.counts.copy()
    counts[:, :4] += np.round(2e-6 * np.cos(-turn[:, None] - angles) * PER_METRE).astype(np.int32)
    return dataclasses.replace(recording, blocks=(dataclasses.replace(block, counts=counts),))


@pytest.mark.parametrize(("rotation", "side"), [("x-to-y", -1), ("y-to-x", +1)])
def test_a_line_that_follows_no_order_stands_upright_on_its_side(
    tracked: OrderTrackedResponse, recording: RawRecording, rotation: str, side: int
) -> None:
    rig = tracked.rig.model_copy(update={"rotation": rotation})
    first = speed_spectra(dataclasses.replace(tracked, rig=rig), Waveforms(with_circle(recording, 170.0)))[0]
    near = np.abs(first.frequency - side * 170.0) < 1.5 * first.step
    assert first.amplitude[:, near].max(axis=1) == pytest.approx(2.0, rel=0.05)  # noise of 0.4 um a sample beside it


def test_a_probe_without_a_partner_has_frequencies_from_zero_and_its_own_amplitude(
    tracked: OrderTrackedResponse, recording: RawRecording
) -> None:
    alone = dataclasses.replace(tracked, probes=tracked.probes[:1], z=tracked.z[:, :1], usable=tracked.usable[:, :1])
    first = speed_spectra(alone, Waveforms(recording))[0]
    assert (first.place, first.full) == ("1x", False)
    assert first.frequency[0] > 0
    assert first.largest[0] == pytest.approx(187.5, rel=0.1)  # e / (2 zeta), less the ramp


def test_where_samples_are_missing_there_is_no_spectrum(tracked: OrderTrackedResponse, recording: RawRecording) -> None:
    (block,) = recording.blocks
    parts = tuple(
        Block(counts=block.counts[a:b], first_sample=a, t_ns=0) for a, b in ((0, 50_000), (55_000, len(block.counts)))
    )
    first = speed_spectra(tracked, Waveforms(dataclasses.replace(recording, blocks=parts)))[0]
    empty = np.isnan(first.amplitude).all(axis=1)
    missing = np.interp([5.0, 5.5], [1.0, 0.65 * 16], [480, 3000])  # rpm
    assert empty.any()
    assert (np.abs(first.rpm[empty] - missing.mean()) < 300).all()
    assert np.isfinite(first.amplitude[~empty]).all()


def test_of_a_long_recording_only_the_stretches_shown_are_read(
    tracked: OrderTrackedResponse, recording: RawRecording, monkeypatch: pytest.MonkeyPatch
) -> None:
    read: list[float] = []
    between = Waveforms.between

    def count(self: Waveforms, begin: float, end: float) -> object:
        read.append(end - begin)
        return between(self, begin, end)

    monkeypatch.setattr(Waveforms, "between", count)
    spectra = speed_spectra(tracked, Waveforms(recording))
    assert len(read) == sum(len(one.rpm) for one in spectra[::2])  # once for all places
    assert max(read) <= 2.0  # s, however long the run


@pytest.mark.parametrize(
    ("rpm_per_s", "seconds"), [(0.0, 2.0), (60.0, 1.0), (240.0, 0.5), (6000.0, 0.2), (np.nan, 1.0)]
)
def test_a_stretch_is_shorter_where_the_speed_changes_faster(
    response: OrderTrackedResponse, rpm_per_s: float, seconds: float
) -> None:
    steady = dataclasses.replace(response, alpha=np.full(len(response.omega), rpm_per_s * RAD))
    assert stretch_seconds(steady, 1) == pytest.approx(seconds)  # 60 rpm/s are 1 Hz/s


def test_a_run_of_a_single_row_has_no_map(tracked: OrderTrackedResponse, recording: RawRecording) -> None:
    falls = np.flatnonzero(tracked.run == 1)
    run = tracked.run.copy()
    run[falls[1:]] = 2  # of no run
    assert {one.run for one in speed_spectra(dataclasses.replace(tracked, run=run), Waveforms(recording))} == {"up"}


@pytest.mark.parametrize("offset", [0.0, 0.37])
def test_a_steady_line_is_right_wherever_it_stands(offset: float) -> None:
    t = np.arange(5000) / 5000.0
    frequency, amplitude = spectrum(3.0 * np.exp(-2j * np.pi * (60 + offset) * t), rate=5000.0)
    bins = highest_in_bins(frequency, amplitude, np.linspace(-100.0, 100.0, 101))
    assert bins.max() == pytest.approx(3.0, rel=0.003)
    assert np.argmax(bins) == (20 if not offset else 19)  # -60 is the lower edge of bin 20


def test_bins_finer_than_the_lines_take_the_next_one() -> None:
    lines: NDArray[np.float64] = np.array([1.0, 5.0, 2.0])
    assert highest_in_bins(np.array([0.0, 1.0, 2.0]), lines, np.array([0.0, 0.5, 1.0, 1.5])).tolist() == [1.0, 5.0, 5.0]
