"""Live tracking against closed forms: vectors, mean positions, curves over speed, whatever the blocks."""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from rotorrig.app.viewer.live.data.curves import SpeedCurves
from rotorrig.app.viewer.live.data.tracker import LiveTracker, Turns
from rotorrig.app.viewer.live.process import join_blocks
from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.probes.base import Block, DaqInfo

RAD = np.pi / 30  # rad/s per rpm
Swept = tuple[NDArray[np.int32], DaqInfo]
ClosedForm = Callable[[NDArray[np.float64]], NDArray[np.complex128]]


def blocks_of(swept: Swept, *, size: int = 200) -> list[Block]:
    counts, info = swept
    return [
        Block(counts=counts[i : i + size], first_sample=i, t_ns=round(i * 1e9 / info.sample_rate))
        for i in range(0, len(counts), size)
    ]


def track(rig: RigConfig, info: DaqInfo, blocks: list[Block]) -> Turns:
    tracker = LiveTracker(rig, info)
    turns = [tracker.take(block) for block in blocks]
    return Turns(**{name: np.concatenate([getattr(t, name) for t in turns]) for name in ("t", "omega", "z", "gap")})


def turns_at(rpm: NDArray[np.float64]) -> Turns:
    """Turns at given speeds, 1 m of 1X at one probe."""
    ones = np.ones((len(rpm), 1))
    return Turns(t=np.cumsum(60 / rpm), omega=rpm * RAD, z=ones.astype(complex), gap=0 * ones)


def test_live_vectors_are_the_closed_form(rig: RigConfig, swept: Swept, closed_form: ClosedForm) -> None:
    turns = track(rig, swept[1], blocks_of(swept))
    angles = np.array([p.angle for p in rig.probes])
    expected = closed_form(turns.omega)[:, None] * np.exp(-1j * angles)
    assert len(turns.omega) > 400
    assert np.abs(turns.z - expected).max() < 0.02 * np.abs(expected).max()
    assert np.abs(turns.gap[:7]).max() < 1e-7  # the volts are about the gap voltage, while the speed is steady
    assert turns.omega[:7] == pytest.approx(480 * RAD, rel=1e-3)


def test_live_vectors_do_not_depend_on_the_blocks(rig: RigConfig, swept: Swept) -> None:
    once, again = (track(rig, swept[1], blocks_of(swept, size=size)) for size in (1777, 200))
    assert once.omega == pytest.approx(again.omega)
    assert once.z == pytest.approx(again.z)
    assert once.t == pytest.approx(again.t)


def test_a_gap_costs_the_turns_it_cuts_and_nothing_else(rig: RigConfig, swept: Swept, closed_form: ClosedForm) -> None:
    blocks = blocks_of(swept)
    cut = [*blocks[:300], *blocks[310:]]
    turns = track(rig, swept[1], cut)
    angles = np.array([p.angle for p in rig.probes])
    expected = closed_form(turns.omega)[:, None] * np.exp(-1j * angles)
    assert np.abs(turns.z - expected).max() < 0.02 * np.abs(expected).max()
    assert len(join_blocks(cut)) == 2
    assert {len(block.counts) for block in join_blocks(cut, most=1000)} == {1000}


def test_a_keyphasor_of_several_pulses_per_turn_gives_one_vector_per_turn(rig: RigConfig) -> None:
    """Three pulses per turn, the first after the widest interval; 100 µm of 1X at 90 degrees of lag, 20 turns/s."""
    assert rig.keyphasor
    rate, turns, radius = 10_000.0, 40, 100e-6
    three = rig.model_copy(update={"keyphasor": rig.keyphasor.model_copy(update={"pulses_per_revolution": 3})})
    theta = 2 * np.pi * 20 * np.arange(int(turns / 20 * rate)) / rate + 1.0
    past = np.mod(theta[:, None] - np.array([0.0, 1.8, 3.6]), 2 * np.pi)
    pulse = np.where((past < 0.3).any(axis=1), -8.0, -2.0)
    x = radius * np.cos(theta - np.pi / 2)
    scale = 20 / 2**23
    volts = np.column_stack([*[-10 + 7874 * x] * 4, pulse])
    info = DaqInfo(
        model="test", serial="1", sample_rate=rate, channels=5, volts_per_count=(scale,) * 5, full_scale_counts=2**23
    )
    found = track(three, info, blocks_of((np.round(volts / scale).astype(np.int32), info)))
    settled = slice(3, None)
    assert len(found.omega) == pytest.approx(turns, abs=3)
    assert found.omega[settled] == pytest.approx(2 * np.pi * 20, rel=2e-3)
    # the pulses' flanks lie between samples 0.0126 rad apart
    assert np.abs(found.z[settled] - radius * np.exp(-1j * np.pi / 2)).max() < 0.02 * radius


def test_a_standing_shaft_fills_no_memory_and_has_a_mean_position(rig: RigConfig, swept: Swept) -> None:
    info = swept[1]
    tracker = LiveTracker(rig, info)
    assert np.isnan(tracker.gap).all()
    volts = round(-9.0 / info.volts_per_count[0])  # 1 V nearer than the gap voltage
    still = np.full((10_000, 5), volts, dtype=np.int32)
    for second in range(30):
        tracker.take(Block(counts=still, first_sample=second * 10_000, t_ns=second * 10**9))
    assert tracker.speed == 0
    assert tracker.waveform() is None
    assert len(tracker._counts) <= 10_000
    assert tracker.gap == pytest.approx(1 / 7874)


def test_the_curves_tell_rising_from_falling(rig: RigConfig, swept: Swept) -> None:
    curves = SpeedCurves()
    curves.add(track(rig, swept[1], blocks_of(swept)))
    up, down = curves.points(1).rpm, curves.points(-1).rpm
    assert (np.diff(up) > 0).all()
    assert (np.diff(down) < 0).all()
    assert up[-1] == pytest.approx(3000, abs=30)
    assert down[-1] == pytest.approx(1500, abs=30)
    assert curves.points(1).z.shape == (len(up), 4) == curves.points(1).gap.shape


def test_a_dwell_does_not_make_the_curves_grow() -> None:
    curves = SpeedCurves()
    curves.add(turns_at(1000 + np.random.default_rng(0).normal(0, 1, 8000)))  # speed hunting of 0.1 %
    assert curves.count(1) < 5
    assert curves.count(-1) == 0
