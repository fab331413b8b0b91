"""What is said of a slow roll, against a Jeffcott rotor whose response at any speed is known in closed form."""

import numpy as np
import pytest

from rotorrig.processing.slow_roll import vector as slow_roll
from rotorrig.processing.slow_roll.checks import FirstOrder, dynamic_part, validity_remarks

RPM = np.pi / 30
CRITICAL = 2200 * RPM
RUNOUT = np.array([3e-6, 2e-6j])
SIGMA = 0.02e-6


def jeffcott(omega: np.ndarray, *, eccentricity: float, damping: float = 0.03) -> np.ndarray:
    """Return the response [m] at speeds omega of a disk off its centre: e r^2 / (1 - r^2 + 2 j zeta r)."""
    r = omega / CRITICAL
    return eccentricity * r**2 / (1 - r**2 + 2j * damping * r)


def sweep(
    rng: np.random.Generator,
    *,
    eccentricity: float,
    slow: tuple[float, float] = (240, 240),
    end: float = 3600,
    runout: np.ndarray = RUNOUT,
) -> tuple[FirstOrder, slow_roll.SlowRoll]:
    """Return 20 rows between `slow` speeds [rpm], and a rise from 480 rpm to `end`; 1y sees half of what 1x does."""
    omega = np.concatenate([np.linspace(*slow, 20), np.linspace(480, end, 150)]) * RPM
    chosen = np.arange(170) < 20
    z = runout + jeffcott(omega, eccentricity=eccentricity)[:, None] * [1.0, 0.5]
    z = z + SIGMA * (rng.standard_normal(z.shape) + 1j * rng.standard_normal(z.shape))
    covariance = np.tile(SIGMA**2 * np.eye(4), (170, 1, 1, 1))
    usable = np.ones(z.shape, dtype=bool)
    estimated = slow_roll.estimate(
        z[chosen, :, None], covariance[chosen], omega[chosen], usable=usable[chosen], dwell=slow[0] == slow[1]
    )
    first = FirstOrder(
        index=0, probes=("1x", "1y"), omega=omega, z=z, sigma=np.full(z.shape, SIGMA), usable=usable, chosen=chosen
    )
    return first, estimated


def test_nothing_is_said_of_a_slow_roll_that_is_run_out_alone(rng: np.random.Generator) -> None:
    said = [validity_remarks(*sweep(rng, eccentricity=e)) for e in (0.0, 5e-6) for _ in range(200)]
    assert sum(bool(words) for words in said) <= 2  # 5 um leave 0.06 um of 3, too little to be told


def test_the_share_of_the_response_is_told_with_its_uncertainty(rng: np.random.Generator) -> None:
    (words,) = validity_remarks(*sweep(rng, eccentricity=40e-6))
    there = abs(jeffcott(np.array([240 * RPM]), eccentricity=40e-6)[0])
    assert f"{there * 1e6:.2f}" == "0.48"
    assert words.startswith("at 240 rpm about 0.48 um of 3.")
    assert "at 1x" in words and "is response to unbalance, not run-out" in words


def test_its_figure_is_right_as_often_as_its_sigma_says(rng: np.random.Generator) -> None:
    truth = abs(jeffcott(np.array([240 * RPM]), eccentricity=40e-6, damping=0.0)[0])
    inside = 0
    for _ in range(300):
        first, _ = sweep(rng, eccentricity=40e-6)
        part, sigma = dynamic_part(first, probe=0, omega=240 * RPM, peak=CRITICAL)
        inside += abs(part - truth) < 1.96 * sigma
    assert 0.90 < inside / 300 < 0.99


def test_a_slow_roll_too_near_the_critical_speed_is_told(rng: np.random.Generator) -> None:
    words = validity_remarks(*sweep(rng, eccentricity=40e-6, slow=(800, 800)))
    assert words[0].startswith("800 rpm are 0.36 of the ")
    assert words[0].endswith("at 1x), want less than 0.25")
    peak = float(words[0].split("of the ")[1].split(" rpm")[0])
    assert peak == pytest.approx(2200, rel=0.02)


def test_no_critical_speed_is_claimed_that_the_sweep_did_not_pass(rng: np.random.Generator) -> None:
    words = validity_remarks(*sweep(rng, eccentricity=40e-6, slow=(800, 800), end=2000))
    assert not any("largest" in word for word in words)


def test_a_vector_that_changes_within_the_window_is_told(rng: np.random.Generator) -> None:
    first, slow = sweep(rng, eccentricity=40e-6, slow=(200, 540))
    change = abs(np.diff(jeffcott(np.array([200, 540]) * RPM, eccentricity=40e-6, damping=0.0))[0])
    within = next(word for word in validity_remarks(first, slow) if "within" in word)
    assert within.startswith("1X at 1x changes by 2.")
    assert float(within.split("changes by ")[1].split(" um")[0]) == pytest.approx(change * 1e6, rel=0.05)
    assert "from 200 to 540 rpm within the slow roll" in within


def test_a_window_up_to_the_critical_speed_and_beyond_is_told_once(rng: np.random.Generator) -> None:
    (words,) = validity_remarks(*sweep(rng, eccentricity=40e-6, slow=(1900, 2600)))
    assert "at which 1X is largest" in words


def test_a_slow_roll_that_never_was_is_not_judged(rng: np.random.Generator) -> None:
    first, _ = sweep(rng, eccentricity=40e-6)
    assert validity_remarks(first, slow_roll.none(probes=2, orders=1)) == ()


def test_unusable_rows_and_probes_take_no_part(rng: np.random.Generator) -> None:
    first, slow = sweep(rng, eccentricity=0.0)
    first.z[40] = 1.0
    first.usable[40] = False
    first.z[:, 1], first.usable[:, 1] = np.nan, False
    assert validity_remarks(first, slow) == ()
