"""Wheels with several teeth at known places, on a shaft at constant acceleration."""

import numpy as np
import pytest
from numpy.typing import NDArray

from rotorrig.processing.shaft_angle.shaft_angle import UNMARKED, ShaftAngle, fit_shaft_angle
from rotorrig.processing.shaft_angle.smooth_angle import TURN
from rotorrig.rig.errors import DataError

RPM = np.pi / 30
START, RATE = 480 * RPM, 30 * RPM
EVEN = np.arange(8) / 8
DISPLACED = EVEN - 0.03 * (np.arange(8) == 7)
MISSING = np.arange(35) / 36
PAIR = np.array([0.0, 0.4])


def uneven(teeth: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the places [turn] of teeth that are cut 1 % of their spacing off, but for the first."""
    off = 0.01 / len(teeth) * np.random.default_rng(4).standard_normal(len(teeth))
    off[0] = 0.0
    return teeth + off


def pulses_of(teeth: NDArray[np.float64], *, begin: int = 3) -> NDArray[np.float64]:
    """Return when the teeth pass in 200 turns, from the `begin`th on: the root of a quadratic."""
    turned = TURN * (np.arange(200)[:, None] + teeth).ravel()[begin:]
    return (np.sqrt(START**2 + 2 * RATE * turned) - START) / RATE


def wrong(shaft: ShaftAngle) -> NDArray[np.float64]:
    """Return the angle less the true one [rad], over most of the recording, with whole turns taken out."""
    t = np.linspace(2.0, float(shaft.t[-1]) - 1.0, 2001)
    off = shaft.theta(t) - START * t - RATE * t**2 / 2
    return off - TURN * np.round(off[0] / TURN)


@pytest.mark.parametrize("teeth", [DISPLACED, MISSING, PAIR], ids=["displaced", "missing", "pair"])
def test_angle_zero_is_the_tooth_after_the_widest_spacing(teeth: NDArray[np.float64]) -> None:
    shaft = fit_shaft_angle(pulses_of(uneven(teeth)), per_turn=len(teeth))
    np.testing.assert_allclose(wrong(shaft), 0.0, atol=1e-7)
    assert shaft.remarks == ()
    np.testing.assert_allclose(shaft.theta(shaft.t), TURN * shaft.turn, atol=1e-7)


@pytest.mark.parametrize("begin", [0, 3, 7])
def test_a_wheel_without_a_mark_counts_from_the_first_pulse_and_says_so(begin: int) -> None:
    teeth = uneven(EVEN)
    shaft = fit_shaft_angle(pulses_of(teeth, begin=begin), per_turn=8)
    off = wrong(shaft)
    np.testing.assert_allclose(off, off[0], atol=1e-7)  # the teeth's places are found
    assert np.exp(1j * (off[0] + TURN * teeth[begin])) == pytest.approx(1.0, abs=1e-6)
    assert shaft.remarks == (UNMARKED,)


@pytest.mark.parametrize("teeth", [EVEN, DISPLACED, MISSING], ids=["even", "displaced", "missing"])
def test_missed_and_extra_pulses_are_repaired(teeth: NDArray[np.float64], rng: np.random.Generator) -> None:
    pulses = pulses_of(uneven(teeth), begin=0)
    kept = rng.random(len(pulses)) > 0.01
    kept[: len(teeth)] = True
    extra = rng.uniform(pulses[0], pulses[-1], len(pulses) // 100)
    shaft = fit_shaft_angle(np.sort(np.append(pulses[kept], extra)), per_turn=len(teeth))
    np.testing.assert_allclose(wrong(shaft), 0.0, atol=1e-5)
    assert shaft.flaws == ()
    words = [repair.reason for repair in shaft.repairs]
    assert words.count("extra pulse dropped") == len(extra)
    missed = np.flatnonzero(~kept)
    assert words.count("missed pulse bridged") == np.sum(np.diff(missed, prepend=-2) > 1)


def test_more_teeth_average_more_jitter(rng: np.random.Generator) -> None:
    def sigma(teeth: NDArray[np.float64]) -> float:
        pulses = pulses_of(teeth)
        shaft = fit_shaft_angle(pulses + 20e-6 * rng.standard_normal(len(pulses)), per_turn=len(teeth))
        return float(np.sqrt(shaft.smooth.variance(np.array([10.0]))[0, 0]))

    assert sigma(MISSING) == pytest.approx(sigma(np.zeros(1)) / np.sqrt(35), rel=0.3)


def test_a_marked_wheel_is_found_again_after_a_gap() -> None:
    pulses = pulses_of(uneven(DISPLACED))
    gap = (5.03, 5.43)  # some four turns
    shaft = fit_shaft_angle(pulses[(pulses < gap[0]) | (pulses > gap[1])], gaps=[gap], per_turn=8)
    off = wrong(shaft)
    t = np.linspace(2.0, float(shaft.t[-1]) - 1.0, 2001)
    outside = (t < 4.9) | (t > 5.6)
    np.testing.assert_allclose(np.exp(1j * off[outside]), 1.0, atol=1e-6)
    assert {flaw.reason for flaw in shaft.flaws} == {"gap in the samples"}


def test_after_a_gap_an_unmarked_wheel_is_not_used() -> None:
    pulses = pulses_of(uneven(EVEN))
    gap = (5.03, 5.43)
    shaft = fit_shaft_angle(pulses[(pulses < gap[0]) | (pulses > gap[1])], gaps=[gap], per_turn=8)
    assert shaft.t[-1] < gap[0]


def test_a_wheel_with_another_number_of_teeth_is_none_of_the_config() -> None:
    with pytest.raises(DataError, match="no pattern of 7 pulses repeats every turn"):
        fit_shaft_angle(pulses_of(PAIR), per_turn=7)


def test_too_few_turns_are_said_so() -> None:
    with pytest.raises(DataError, match="got 20 keyphasor pulses, want 5 turns of 8 without a gap"):
        fit_shaft_angle(pulses_of(EVEN)[:20], per_turn=8)
