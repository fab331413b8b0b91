"""Resonances of closed forms: a disk on a spring, in the notation of tests/app/conftest.py; the exact ones by roots."""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import brentq, minimize_scalar

from rotorrig.processing.resonance import Resonance, find_resonances, required_margin

CRITICAL = 200.0  # rad/s, undamped
ECCENTRICITY = 1e-5  # m
SWEPT = (50.0, 500.0)  # rad/s
SHIFT = 0.5  # rad/s, of the speeds of a second curve


def disk(omega: NDArray[np.float64], damping: float, critical: float = CRITICAL) -> NDArray[np.complex128]:
    """The unbalance response of a single degree of freedom [m]."""
    r = omega / critical
    return ECCENTRICITY * np.exp(0.7j) * r**2 / (1 - r**2 + 2j * damping * r)


def exact(damping: float) -> dict[str, float]:
    """Peak and half-power speeds of `disk` by minimizing and root finding."""

    def size(omega: float) -> float:
        return float(abs(disk(np.array([omega]), damping)[0]))

    top = float(minimize_scalar(lambda w: -size(w), bounds=SWEPT, method="bounded", options={"xatol": 1e-9}).x)
    lower, upper = (
        brentq(lambda w: size(w) - size(top) / np.sqrt(2), *ends) for ends in ((1.0, top), (top, 100 * top))
    )
    factor = top / (upper - lower)
    return {
        "omega": top,
        "amplitude": size(top),
        "lower": lower,
        "upper": upper,
        "amplification": factor,
        "damping": 1 / (2 * factor),
    }


def values_of(resonance: Resonance) -> dict[str, tuple[float, float]]:
    names = ("omega", "amplitude", "lower", "upper", "amplification", "damping")
    pairs = {name: getattr(resonance, name) for name in names}
    return {name: (pair.value, pair.sigma) for name, pair in pairs.items()}


def with_noise(z: NDArray[np.complex128], sigma: float, seed: int) -> NDArray[np.complex128]:
    rng = np.random.default_rng(seed)
    return z + sigma * (rng.standard_normal(len(z)) + 1j * rng.standard_normal(len(z)))


def round_noise(rows: int, sigma: float) -> NDArray[np.float64]:
    return np.tile(sigma**2 * np.eye(2), (rows, 1, 1))


@pytest.mark.parametrize(("damping", "rows"), [(0.01, 400), (0.03, 150), (0.1, 60), (0.2, 30)])
def test_a_single_degree_of_freedom_is_read_exactly_between_its_rows(damping: float, rows: int) -> None:
    omega = np.linspace(*SWEPT, rows)
    (found,) = find_resonances(omega, disk(omega, damping))
    for name, value in exact(damping).items():
        assert getattr(found, name).value == pytest.approx(value, rel=1e-6), name
        assert np.isnan(getattr(found, name).sigma), "a model's curve has no noise"


def test_of_small_damping_the_amplification_factor_tells_the_damping_ratio() -> None:
    omega = np.linspace(*SWEPT, 2000)
    (found,) = find_resonances(omega, disk(omega, 0.01))
    assert found.damping is not None and found.amplification is not None
    assert found.damping.value == pytest.approx(0.01, rel=1e-3)
    assert found.amplification.value == pytest.approx(50.0, rel=1e-3)


def test_rows_that_run_down_or_have_no_value_change_nothing() -> None:
    omega = np.linspace(*SWEPT, 300)
    z = disk(omega, 0.05)
    gaps = z.copy()
    gaps[[5, 140, 290]] = np.nan
    (whole,), (holed,) = find_resonances(omega, z), find_resonances(omega[::-1], gaps[::-1])
    assert whole.damping is not None and holed.damping is not None
    assert holed.omega.value == pytest.approx(whole.omega.value, rel=1e-6)
    assert holed.damping.value == pytest.approx(whole.damping.value, rel=1e-6)


@pytest.mark.parametrize(("rows", "sigma"), [(400, 1e-6), (60, 0.5e-6)])  # of a peak of 100 um
def test_values_scatter_as_their_sigma_says(rows: int, sigma: float) -> None:
    omega = np.linspace(*SWEPT, rows)
    draws = []
    for seed in range(150):
        (found,) = find_resonances(omega, with_noise(disk(omega, 0.05), sigma, seed), round_noise(rows, sigma))
        draws.append(values_of(found))
    for name, true in exact(0.05).items():
        value, stated = np.array([draw[name] for draw in draws]).T
        rms = float(np.sqrt(np.mean(stated**2)))
        assert value.std() / rms == pytest.approx(1.0, abs=0.2), name  # 3 standard errors of 150 draws
        assert abs(value.mean() - true) < 0.35 * rms, name  # bias: chosen rows and curvature, well below one sigma


def test_a_doubtful_slow_roll_makes_the_amplitude_doubtful() -> None:
    omega = np.linspace(*SWEPT, 400)
    z, noise = with_noise(disk(omega, 0.05), 1e-7, 1), round_noise(400, 1e-7)
    (alone,) = find_resonances(omega, z, noise)
    (shared,) = find_resonances(omega, z, noise, common=1e-12 * np.eye(2))  # 1 um, which every row lacks or has
    assert alone.amplitude.sigma < 1e-7
    assert shared.amplitude.sigma == pytest.approx(1e-6, rel=0.05)


def test_a_models_resonance_is_as_uncertain_as_its_parameters() -> None:
    """A disk on a spring, its natural frequency known to 0.01 % and its damping to 0.1 %: small, so all linear."""
    omega, damping = np.linspace(*SWEPT, 400), 0.02
    stiffer, better_damped = disk(omega, damping, CRITICAL * 1.0001), disk(omega, damping * 1.001)
    steps = np.stack([stiffer, better_damped], axis=1) - disk(omega, damping)[:, None]
    (found,) = find_resonances(omega, disk(omega, damping), steps=steps)
    assert found.amplification is not None
    assert found.omega.sigma == pytest.approx(1e-4 * CRITICAL, rel=0.02)
    assert found.amplification.sigma == pytest.approx(1e-3 * found.amplification.value, rel=0.05)


def test_rows_of_two_curves_at_once_give_no_parabola_and_no_crash() -> None:
    omega = np.linspace(150.0, 260.0, 12)
    rows = np.concatenate([omega, omega + SHIFT])
    for other in np.linspace(201.0, 230.0, 30):
        for found in find_resonances(rows, np.concatenate([disk(omega, 0.03), 0.8 * disk(omega, 0.03, other)])):
            assert np.isfinite(found.omega.value)


def test_a_sweep_that_ends_before_half_power_has_a_critical_speed_and_no_damping() -> None:
    end = exact(0.05)["upper"] - 3.0
    omega = np.linspace(SWEPT[0], end, 200)
    (found,) = find_resonances(omega, disk(omega, 0.05))
    assert found.omega.value == pytest.approx(exact(0.05)["omega"], rel=1e-6)
    assert found.lower is not None
    assert (found.upper, found.amplification, found.damping) == (None, None, None)


def test_a_sweep_that_ends_below_the_peak_has_no_critical_speed() -> None:
    omega = np.linspace(SWEPT[0], 195.0, 200)
    assert find_resonances(omega, with_noise(disk(omega, 0.05), 1e-7, 0), round_noise(200, 1e-7)) == ()


def test_a_peak_between_two_rows_tells_no_damping() -> None:
    omega = np.linspace(*SWEPT, 30)  # 15 rad/s apart, the half-power speeds of 1 % damping 4
    (found,) = find_resonances(omega, disk(omega, 0.01))
    assert found.damping is None


def test_two_peaks_are_each_their_own() -> None:
    omega = np.linspace(50.0, 900.0, 1500)
    z = with_noise(disk(omega, 0.02) + disk(omega, 0.01, critical=600.0), 1e-7, 3)
    first, second = find_resonances(omega, z, round_noise(1500, 1e-7))
    assert first.omega.value == pytest.approx(200.0, rel=2e-3)
    assert second.omega.value == pytest.approx(600.0, rel=2e-3)
    assert first.damping is not None and second.damping is not None
    assert first.damping.value == pytest.approx(0.02, rel=0.03)  # the other's tail lies under it
    assert second.damping.value == pytest.approx(0.01, rel=0.03)


def test_a_peak_within_the_beat_of_one_just_passed_is_left_out() -> None:
    omega = np.linspace(50.0, 900.0, 1500)
    z = disk(omega, 0.02) + disk(omega, 0.01, critical=300.0)
    # 100 rad/s after 200 rad/s: the free vibration decays by 0.02 * 200 = 4 /s, and by 3 in 0.75 s, at 133 rad/s^2
    assert len(find_resonances(omega, z, rate=100.0)) == 2
    assert [round(each.omega.value) for each in find_resonances(omega, z, rate=200.0)] == [200]
    # the other way round, 0.01 * 300 = 3 /s: 100 rad/s^2
    assert len(find_resonances(omega, z, rate=-80.0)) == 2
    assert [round(each.omega.value) for each in find_resonances(omega, z, rate=-150.0)] == [300]
    assert len(find_resonances(omega, z)) == 2  # each speed for itself


@pytest.mark.parametrize("seed", range(20))
def test_noise_has_no_peaks(seed: int) -> None:
    omega = np.linspace(*SWEPT, 500)
    flat = with_noise(np.full(500, 5e-6 + 0j), 1e-7, seed)
    assert find_resonances(omega, flat, round_noise(500, 1e-7)) == ()


def test_too_few_rows_have_no_peaks() -> None:
    assert find_resonances(np.empty(0), np.empty(0, dtype=complex)) == ()
    assert find_resonances(np.array([100.0, 200.0]), np.array([1e-6, 2e-6 + 0j])) == ()


def test_the_margin_wanted_grows_with_the_amplification_factor_up_to_its_limit() -> None:
    assert required_margin(2.49, above=False) == required_margin(2.49, above=True) == 0.0
    assert required_margin(2.5, above=False) == pytest.approx(0.0)  # 17 (1 - 1)
    assert required_margin(2.5, above=True) == pytest.approx(0.10)
    assert required_margin(5.5, above=False) == pytest.approx(0.1275)  # 17 (1 - 1/4)
    assert required_margin(5.5, above=True) == pytest.approx(0.2275)
    assert required_margin(1e9, above=False) == 0.16
    assert required_margin(1e9, above=True) == 0.26
