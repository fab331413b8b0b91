"""Time bases of a circular whirl in closed form, and of one with a second harmonic added."""

import dataclasses

import numpy as np
import pytest

from rotorrig.acquisition.recording import RawRecording
from rotorrig.app.plot_data.time_bases import TURNS, TimeBase, rows_to_show, time_bases
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.processing.waveform import Waveforms
from tests.app.conftest import jeffcott

RAD = np.pi / 30
NOISE = 0.003 / 7874 * 1e6  # um a sample: 3 mV


@pytest.fixture(scope="module")
def bases(tracked: OrderTrackedResponse, recording: RawRecording) -> tuple[TimeBase, ...]:
    return time_bases(tracked, Waveforms(recording))


def test_each_plane_is_shown_slow_at_its_largest_and_at_the_top(bases: tuple[TimeBase, ...]) -> None:
    assert [base.speed for base in bases] == 2 * ["slowest", "largest 1X", "top speed"]
    assert [base.plane.probes[0] for base in bases] == 3 * ["1x"] + 3 * ["2x"]
    assert [base.rpm for base in bases[:3]] == pytest.approx([480, 2240, 3000], rel=0.03)


def test_the_edges_are_a_turn_apart_and_the_samples_lie_between_the_outer_ones(bases: tuple[TimeBase, ...]) -> None:
    for base in bases:
        assert len(base.edges) == TURNS + 1
        assert np.diff(base.edges) == pytest.approx(60e3 / base.rpm, rel=0.03)
        assert base.edges[0] == 0.0
        assert 0.0 <= base.t[0] < base.t[-1] < base.edges[-1]


def test_a_circular_whirl_is_its_own_1x_and_starts_at_its_vector(bases: tuple[TimeBase, ...]) -> None:
    base = bases[2]  # at the top speed, which the ramp dwells at
    radius = np.abs(jeffcott(np.array([base.rpm * RAD])))[0] * 1e6
    assert np.hypot(*base.filtered_orbit.T) == pytest.approx(radius, rel=0.03)
    assert base.beside == pytest.approx(NOISE, rel=0.3)
    phase = np.angle(jeffcott(np.array([base.rpm * RAD])))[0]
    assert base.filtered[0] == pytest.approx(radius * np.cos(phase - np.array([0.0, np.pi / 2])), abs=0.05 * radius)


def test_what_is_not_1x_stays_in_the_raw_waveform(tracked: OrderTrackedResponse, recording: RawRecording) -> None:
    (block,) = recording.blocks
    counts = block.counts.copy()
    turn = 2 * np.pi * 100.0 * np.arange(len(counts)) / recording.daq.sample_rate  # 2X of 3000 rpm
    counts[:, 0] += np.round(4e-6 * np.cos(turn) * 7874 / recording.daq.volts_per_count[0]).astype(np.int32)
    changed = dataclasses.replace(recording, blocks=(dataclasses.replace(block, counts=counts),))
    base = time_bases(tracked, Waveforms(changed))[2]
    assert base.beside == pytest.approx(4 / 2, rel=0.05)  # rms 4 / sqrt 2 of one probe of two
    assert base.raw.mean(axis=0) == pytest.approx([0.0, 0.0], abs=1e-9)


def test_without_edges_or_samples_there_is_no_time_base(tracked: OrderTrackedResponse, recording: RawRecording) -> None:
    assert time_bases(dataclasses.replace(tracked, keyphasor_t=np.empty(0)), Waveforms(recording)) == ()
    (block,) = recording.blocks
    late = dataclasses.replace(block, counts=block.counts[-1000:], first_sample=len(block.counts) - 1000)
    assert time_bases(tracked, Waveforms(dataclasses.replace(recording, blocks=(late,)))) == ()


def test_the_slow_roll_is_where_its_vector_was_taken(response: OrderTrackedResponse) -> None:
    rows = rows_to_show(response)
    assert list(rows.values()) == ["slow roll", "largest 1X", "top speed"]
    assert response.omega[list(rows)] / RAD == pytest.approx([240, 2230, 3600], abs=10)
