"""Ours beside rota-order (GPL-3, for tests alone): another's code, written from the literature, on the same samples.

Both get the same shaft angle, in closed form, so that the filters themselves are compared.
"""

import numpy as np
import pytest

from rotorrig.processing.pipeline import track
from rotorrig.processing.settings import Tracking
from tests.processing.synthetic import chirp

rota = pytest.importorskip(
    "rota", reason="rota-order is not installed: pip install 'rotorrig[dev]' for the comparison with another's tracking"
)

RATE = 8192.0
TURNS = 8
THETA_0 = -0.3
MICRON = 1e-6


def run(record, *, seconds: float, start: float, acceleration: float, amplitude):
    """Return the recording of Re(amplitude(theta) e^{j theta}) and a 2X, its waveform [m] and speed [rpm]."""
    t = np.arange(int(seconds * RATE)) / RATE
    theta = chirp(t, start=start, rate=acceleration, theta_0=THETA_0)
    x = (amplitude(theta) * np.exp(1j * theta)).real + 10 * MICRON * np.cos(2 * theta - 0.7)
    recording = record(theta, np.tile(x[:, None], 4), rate=RATE, marks=[(0.0, "up")])
    return recording, x, (start + acceleration * t) * 30 / np.pi


def told_as_ours(found, t: np.ndarray, order: int = 1) -> np.ndarray:
    """Return rota's envelope of an order at the rows' times; its angle is 0 at the first sample, ours THETA_0."""
    envelope = found.envelopes[:, order - 1]
    at = np.arange(len(envelope)) / RATE
    return np.interp(t, at, envelope) * np.exp(-1j * order * THETA_0)


def test_a_run_up_gives_the_same_first_and_second_order(record) -> None:
    recording, x, rpm = run(
        record, seconds=20.0, start=100.0, acceleration=10.0, amplitude=lambda theta: 50 * MICRON * np.exp(-0.5j)
    )
    ours = track(recording, Tracking(turns=TURNS, orders=(1.0, 2.0)))
    theirs = rota.extract.tracked_harmonics(x, RATE, rpm, (1.0, 2.0), window_revs=TURNS)
    inner = slice(2, -2)  # rota's own advice: its ends are indicative only
    for order, size in ((1, 50 * MICRON), (2, 10 * MICRON)):
        difference = ours.order(order)[inner, 0] - told_as_ours(theirs, ours.t, order)[inner]
        assert np.abs(difference).max() < 1e-4 * size


def test_the_vold_kalman_filters_follow_a_changing_amplitude_alike(record) -> None:
    """At steady speed a bandwidth in orders is one in Hz: -3 dB of 1 / (1 + (f / f0)^4) is at f0 (sqrt 2 - 1)^(1/4)."""
    speed = 2 * np.pi * 32.0
    middle = speed * 6.0

    def amplitude(theta: np.ndarray) -> np.ndarray:
        turns = (theta - middle) / (2 * np.pi)
        return MICRON * (30 + 40j * np.exp(-((turns / 3) ** 2)) + 10 * np.cos(2 * np.pi * turns / 20))

    recording, x, rpm = run(record, seconds=12.0, start=speed, acceleration=0.0, amplitude=amplitude)
    ours = track(recording, Tracking(turns=TURNS, orders=(1.0, 2.0), method="vold-kalman"))
    f0 = 2 * np.sqrt(2) / (np.pi * TURNS) * 32.0
    theirs = rota.extract.order_waveform(x, RATE, rpm, (1.0, 2.0), bandwidth=f0 * (np.sqrt(2) - 1) ** 0.25)
    good = ours.usable[:, 0]
    got, want = ours.order(1)[good, 0], told_as_ours(theirs, ours.t)[good]
    raw = amplitude(chirp(ours.t, start=speed, rate=0.0, theta_0=THETA_0))[good]
    assert np.abs(got - raw).max() > 2 * MICRON  # the filters do something
    assert np.abs(got - want).max() < 0.02 * MICRON
