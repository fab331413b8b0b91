"""Bounds whose values are known by hand: one number seen many times, with noise of its own and noise in common."""

import numpy as np
import pytest

from benchmarks.parts.identification.cramer_rao import amplitude_root, bounds, relative_root
from rotorrig.identify.measurement import Measurement

SIGMA, ROWS = 0.01, 25


def measurement(rows: int, *, slow_roll: float | None = None) -> Measurement:
    """One probe, SIGMA in re and im of every row; `slow_roll`: that of the slow roll, None: there is none."""
    whiten = np.tile(np.eye(2) / SIGMA, (rows + 1, 1, 1))
    whiten[-1] = np.eye(2) / (slow_roll or 1.0)
    usable = np.ones((rows + 1, 1), dtype=bool)
    usable[-1] = slow_roll is not None
    return Measurement(
        rows=np.arange(rows),
        z=np.zeros((rows + 1, 1), dtype=complex),
        sigma=np.full((rows + 1, 1), SIGMA),
        whiten=whiten,
        usable=usable,
    )


def vectors(measured: Measurement, *, phase: float) -> tuple[np.ndarray, np.ndarray]:
    """Return z = u e^{j phase} of every row, u = 2, no slow roll; and the root for (ln u, phase)."""
    z = np.full((len(measured.whiten), 1), 2 * np.exp(1j * phase))
    z[-1] = 0
    root = measured.sigmas(np.stack([z, 1j * z], axis=-1)).reshape(-1, 2)
    return z, root


def test_vectors_tell_amount_and_phase_equally_well() -> None:
    _, root = vectors(measurement(ROWS), phase=0.7)
    assert bounds(root) == pytest.approx([SIGMA / 2 / np.sqrt(ROWS)] * 2)


@pytest.mark.parametrize("phase", [0.3, 0.7, 2.5])
def test_amplitudes_tell_the_amount_as_well_as_vectors_do_and_nothing_of_the_phase(phase: float) -> None:
    measured = measurement(ROWS)
    z, root = vectors(measured, phase=phase)
    amplitudes = amplitude_root(root, measured, z, used=np.ones((ROWS, 1), dtype=bool))
    assert amplitudes.shape == (ROWS, 2)
    assert np.linalg.norm(amplitudes, axis=0) == pytest.approx([2 * np.sqrt(ROWS) / SIGMA, 0.0], abs=1e-9)
    assert bounds(amplitudes)[1] > 1e6


def test_the_noise_of_the_slow_roll_does_not_average_out() -> None:
    measured = measurement(ROWS, slow_roll=0.05)
    z, root = vectors(measured, phase=0.7)
    amplitudes = amplitude_root(root, measured, z, used=np.ones((ROWS, 1), dtype=bool))
    assert bounds(amplitudes[:, :1]) == pytest.approx(np.hypot(SIGMA / np.sqrt(ROWS), 0.05) / 2)


def test_amplitudes_left_out_tell_nothing_and_priors_stay() -> None:
    measured = measurement(ROWS)
    z, root = vectors(measured, phase=0.7)
    used = np.arange(ROWS)[:, None] < 4
    prior = np.array([[0.0, 1 / 0.1]])
    amplitudes = amplitude_root(np.concatenate([root, prior]), measured, z, used=used)
    assert bounds(amplitudes) == pytest.approx([SIGMA / 2 / np.sqrt(4), 0.1])


def test_the_most_likely_value_from_amplitudes_with_relative_noise_attains_the_bound_and_the_mean_does_not() -> None:
    rng, share, figures = np.random.default_rng(8), 0.3, 100
    y = 1 + share * rng.standard_normal((20_000, figures))
    # The most likely scale m of y = m (1 + share N): m^2 share^2 + m mean(y) - mean(y^2) = 0.
    mean, square = y.mean(axis=1), (y**2).mean(axis=1)
    likely = (-mean + np.sqrt(mean**2 + 4 * share**2 * square)) / (2 * share**2)
    (bound,) = bounds(relative_root(np.ones((figures, 1)), share=share))
    assert bound == pytest.approx(share / np.sqrt(figures * (1 + 2 * share**2)))
    assert likely.std() == pytest.approx(bound, rel=0.02)
    assert mean.std() > 1.05 * bound
