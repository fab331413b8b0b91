"""Waveforms at equal steps of shaft angle, against cosines of the shaft angle known in closed form."""

import numpy as np
import pytest

from rotorrig.processing.shaft_angle.shaft_angle import TURN, ShaftAngle, fit_shaft_angle
from rotorrig.processing.tracking.synchronous_waveform import margin, resample
from rotorrig.processing.waveform import Stretch
from tests.processing.synthetic import chirp

RPM = np.pi / 30
RATE = 25_600.0
START, RISE = 1200 * RPM, 180 * RPM
POINTS = 128


@pytest.fixture(scope="module")
def shaft() -> ShaftAngle:
    turns = np.arange(200)
    return fit_shaft_angle((np.sqrt(START**2 + 2 * RISE * TURN * turns) - START) / RISE)


def stretch(begin: float, end: float, *, order: float, phase: float = 0.3) -> Stretch:
    """Return 1 mm of gap and 10 um of an order from `begin` to `end` [s]."""
    t = np.arange(round(begin * RATE), round(end * RATE)) / RATE
    x = 1e-3 + 10e-6 * np.cos(order * chirp(t, start=START, rate=RISE) + phase)
    return Stretch(t=t, counts=np.zeros((len(t), 1), np.int32), x=x[:, None])


@pytest.mark.parametrize("order", [0.5, 1.0, 3.47, 20.0, 42.0])
def test_an_order_is_a_cosine_of_the_points_angle(shaft: ShaftAngle, order: float) -> None:
    found = resample(stretch(1.0, 3.0, order=order), shaft, first_turn=30.0, turns=24, points=POINTS)
    angle = TURN * (30 + np.arange(24 * POINTS) / POINTS)
    np.testing.assert_allclose(found[:, 0], 1e-3 + 10e-6 * np.cos(order * angle + 0.3), rtol=0, atol=1e-10)


def test_what_the_points_cannot_hold_is_kept_out_and_not_folded_down(shaft: ShaftAngle) -> None:
    found = resample(stretch(1.0, 3.0, order=100.0), shaft, first_turn=30.0, turns=24, points=POINTS)
    np.testing.assert_allclose(found[:, 0], 1e-3, rtol=0, atol=1e-10)


def test_every_sample_takes_part_in_averaging_noise(shaft: ShaftAngle, rng: np.random.Generator) -> None:
    flat = stretch(1.0, 3.0, order=0.0)
    noise = rng.standard_normal((len(flat.t), 3))
    found = resample(Stretch(t=flat.t, counts=flat.counts, x=noise), shaft, first_turn=30.0, turns=24, points=POINTS)
    samples_per_point = RATE * TURN / shaft.omega(shaft.time_at(np.array([42.0])))[0] / POINTS
    assert found.std() == pytest.approx(1 / np.sqrt(samples_per_point), rel=0.05)


def test_turns_begin_at_the_keyphasor_edge_wherever_the_stretch_does(shaft: ShaftAngle) -> None:
    whole = resample(stretch(1.0, 3.0, order=1.0), shaft, first_turn=35.0, turns=2, points=POINTS)
    later = resample(stretch(1.27, 2.0, order=1.0), shaft, first_turn=35.0, turns=2, points=POINTS)
    np.testing.assert_allclose(later, whole, rtol=0, atol=1e-12)


def test_a_stretch_without_a_margin_loses_little_at_its_ends(shaft: ShaftAngle) -> None:
    begin, end = shaft.time_at(np.array([30.0, 38.0]))
    found = resample(stretch(begin, end, order=1.0), shaft, first_turn=30.0, turns=8, points=POINTS)
    want = 1e-3 + 10e-6 * np.cos(TURN * np.arange(8 * POINTS) / POINTS + 0.3)
    reach = margin(START, points=POINTS, rate=RATE) * shaft.omega(begin) / TURN * POINTS  # points, at the most
    inner = slice(int(reach) + 1, -int(reach) - 1)
    np.testing.assert_allclose(found[inner, 0], want[inner], rtol=0, atol=1e-10)
    np.testing.assert_allclose(found[:, 0], want, rtol=0, atol=0.02e-6)
