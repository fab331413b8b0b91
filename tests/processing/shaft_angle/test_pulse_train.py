"""Pulses at known turns, with some missing and some that are none."""

import numpy as np
import pytest

from rotorrig.processing.shaft_angle.pulse_train import count_pulses
from rotorrig.processing.shaft_angle.smooth_angle import TURN
from rotorrig.rig.errors import DataError

RPM = np.pi / 30
START, RATE = 480 * RPM, 30 * RPM
PULSES = (np.sqrt(START**2 + 2 * RATE * TURN * np.arange(400)) - START) / RATE


def period(k: int) -> float:
    return float(PULSES[k + 1] - PULSES[k])


@pytest.mark.parametrize("missing", [[1], [2], [200], [200, 201, 202], [50, 60, 70], [397], [398], [1, 398]])
def test_missed_pulses_are_counted_wherever_they_are(missing: list[int]) -> None:
    train = count_pulses(np.delete(PULSES, missing))
    np.testing.assert_array_equal(train.number, np.delete(np.arange(400), missing))
    assert train.missed.sum() == len([k for k in missing if k - 1 not in missing])
    assert not train.uncounted.any()


@pytest.mark.parametrize("k", [0, 1, 100, 397, 398])
@pytest.mark.parametrize("where", [0.03, 0.3, 0.5, 0.7, 0.97])
def test_an_extra_pulse_is_found_wherever_it_comes(k: int, where: float) -> None:
    extra = PULSES[k] + where * period(k)
    train = count_pulses(np.sort(np.append(PULSES, extra)))
    np.testing.assert_array_equal(train.t, PULSES)
    assert train.extra == (extra,)


@pytest.mark.parametrize("early", [0.1, 0.3])
def test_an_extra_pulse_before_the_first_or_after_the_last_is_found(early: float) -> None:
    for extra in (PULSES[0] - early * period(0), PULSES[-1] + early * period(398)):
        train = count_pulses(np.sort(np.append(PULSES, extra)))
        np.testing.assert_array_equal(train.t, PULSES)


def test_a_pulse_missed_and_an_extra_one_in_every_ten_turns_are_told_apart(rng: np.random.Generator) -> None:
    missing = np.arange(10, 390, 20)
    extra = np.array([PULSES[k] + rng.uniform(0.05, 0.95) * period(k) for k in range(20, 390, 20)])
    train = count_pulses(np.sort(np.append(np.delete(PULSES, missing), extra)))
    np.testing.assert_array_equal(train.t, np.delete(PULSES, missing))
    np.testing.assert_array_equal(train.number, np.delete(np.arange(400), missing))


def test_a_start_from_rest_and_a_stop_miss_nothing() -> None:
    start = np.sqrt(2 * TURN * np.arange(1, 200) / 10.0)  # 10 rad/s^2 from standstill
    for t in (start, start[-1] - start[::-1]):
        train = count_pulses(t)
        assert not train.missed.any()
        assert train.extra == ()


def test_a_rotor_that_stood_still_is_not_counted_across() -> None:
    stop = 20.0 - np.sqrt(2 * TURN * np.arange(100, 0, -1) / 10.0)
    start = 60.0 + np.sqrt(2 * TURN * np.arange(1, 101) / 10.0)
    train = count_pulses(np.concatenate([stop, start]))
    assert train.uncounted[99]
    assert not np.delete(train.missed, 99).any()


def test_a_pulse_that_is_missing_with_its_samples_is_no_missed_one() -> None:
    train = count_pulses(np.delete(PULSES, range(100, 120)), gaps=[(PULSES[99] + 0.01, PULSES[120] - 0.01)])
    assert train.number[-1] == 399
    assert np.flatnonzero(train.in_gap).tolist() == [99]
    assert not train.missed.any()


def test_pulses_at_random_are_no_keyphasor(rng: np.random.Generator) -> None:
    with pytest.raises(DataError, match="want clean pulses"):
        count_pulses(np.cumsum(rng.exponential(0.1, 500)))
