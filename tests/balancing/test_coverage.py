"""95 % intervals hold 95 %: corrections, and the next run, of rigs drawn by numpy alone."""

import numpy as np
import pytest

from rotorrig.balancing.correction import least_squares_correction, t_quantile
from rotorrig.balancing.influence import estimate_influence
from rotorrig.balancing.prediction import compare, predict_vibration
from tests.balancing.made import PRIOR, conditions_of

DRAWS = 300
ALLOWED = (0.91, 0.985)  # three standard deviations of 300 draws, and what two planes of one draw have in common
TRIAL = np.array([[0, 0], [0, 0], [1, 0], [1j, 0], [0, 1], [0, -1], [1, 1]], complex)
PROBES = 3


def scatter(rng: np.random.Generator, *, growing: bool) -> np.ndarray:
    """Return errors (condition, probe), half of them common to all probes of a condition."""
    draw = rng.standard_normal((2, len(TRIAL) + 1, PROBES + 1))
    z = 0.05 * (draw[0] + 1j * draw[1])
    errors = z[:, :1] + z[:, 1:]
    if growing:
        size = np.append(np.linalg.norm(TRIAL, axis=1), 0.0)
        errors = errors * np.sqrt(0.3 + 0.7 * size**2)[:, None]
    return errors


@pytest.mark.parametrize("growing", [False, True])
def test_intervals_hold_what_they_say(growing: bool) -> None:
    rng = np.random.default_rng(21)
    b = np.array([1.0, 0.5j, -0.3 + 0.4j])
    H = np.array([[1.0, 0.2j], [0.3, 1.0], [0.5j, 0.6]], complex)
    truth = np.linalg.lstsq(H, -b, rcond=None)[0]
    parts, vectors = [], []
    for _ in range(DRAWS):
        errors = scatter(rng, growing=growing)
        made = conditions_of(b, H, TRIAL, errors=errors[:-1])
        found = estimate_influence(made, planes=made.planes, prior=PRIOR)
        correction = least_squares_correction(found)
        off = correction.W - truth
        sigma = np.sqrt(np.diag(correction.covariance))
        pairs = np.stack([off.real, off.imag], axis=1).ravel()
        parts.append(np.abs(pairs) <= t_quantile(correction.dof) * sigma)
        mounted = np.array([0.5, -0.5j])
        growth = 1.0 if not growing else np.sqrt(0.3 + 0.7 * 0.5) / np.sqrt(0.3)
        next_run = b + H @ mounted + errors[-1] * growth
        vectors.append(compare(predict_vibration(found, mounted), next_run).inside)
    assert ALLOWED[0] < np.mean(parts) < ALLOWED[1]
    assert ALLOWED[0] < np.mean(vectors) < ALLOWED[1]
